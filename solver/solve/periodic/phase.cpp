#include "solve/periodic/phase.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "machine/simd.hpp"

namespace extremal {

void add_shift_of_time(const Path& path, const SchemeTables& scheme, double* direction) {
  const int n = path.coordinates(), inner = path.degree() - 1, lanes = path.lanes();
  for (int b = 0; b < path.batches(); ++b)
    for (int end = 0; end < 2; ++end) {
      const double* derivative = scheme.end_derivative.data() + end * (inner + 2) + 1;
      for (int a = 0; a < n; ++a) {
        const double* x = path.x(b) + static_cast<std::size_t>(a) * lanes;
        double slope[most_lanes];
        std::copy_n(x + static_cast<std::size_t>(inner + 1) * n * lanes, lanes, slope);
        for (int j = 0; j < inner; ++j)
          for (int lane = 0; lane < lanes; ++lane)
            slope[lane] += derivative[j] * x[static_cast<std::size_t>(j) * n * lanes + lane];
        for (int k = b * lanes; k < std::min(path.elements(), (b + 1) * lanes); ++k)
          direction[(k + end) * n + a] += 0.5 * slope[k - b * lanes];
      }
    }
}

std::vector<double> direction_of(std::vector<double> nodes, const Path& path) {
  const std::size_t n = path.coordinates(), elements = path.elements();
  const std::span<const double> mesh = path.mesh();
  for (std::size_t k = 0; k <= elements; ++k)
    for (std::size_t a = 0; a < n; ++a)
      nodes[k * n + a] *= 0.5 * (mesh[std::min(k + 1, elements)] - mesh[std::max<std::size_t>(k, 1) - 1]);
  return nodes;
}

namespace {

/// Whether the generator moves the path, by more than roundoff of what it is summed of: a rotation leaves a
/// centre of mass at the origin where it is.
bool add_motion(const Path& path, const Generator& generator, double* direction) {
  constexpr double roundoff = 1e-9;
  double most = 0, terms = 0;
  const int n = path.coordinates(), elements = path.elements();
  const std::span<const double> mesh = path.mesh();
  for (int k = 0; k <= elements; ++k) {
    const double weight = 0.5 * (mesh[std::min(k + 1, elements)] - mesh[std::max(k - 1, 0)]);
    for (int a = 0; a < n; ++a) {
      double value = generator.shift[a], sum = std::abs(value);
      for (int b = 0; b < n; ++b) {
        const double term = generator.matrix[a * n + b] * path.node(k)[b];
        value += term;
        sum += std::abs(term);
      }
      direction[k * n + a] = weight * value;
      most = std::max(most, std::abs(value));
      terms = std::max(terms, sum);
    }
  }
  return most > roundoff * terms;
}

/// Of two copies what moves both alike is a null direction of the linearised equations, and a force along it
/// closes them: a direction of one copy each. A free period takes the place of that force for the shift of
/// time. Along a circle a rotation is a shift of time, and no direction of its own. `given`: the shift of
/// time first, of both copies, then symmetries of one copy and of the other in turn.
PhaseConditions of_copies(const PhaseConditions& given, std::size_t n, bool shifts, bool free_duration) {
  constexpr double dependent = 1e-3;
  PhaseConditions result;
  std::vector<Eigen::VectorXd> known;  // of the first copy, orthonormal
  for (int j = 0; j < given.count; j += j == 0 && shifts ? 1 : 2) {
    const std::span<const double> both = given.direction(j);
    Eigen::VectorXd part = Eigen::Map<const Eigen::VectorXd>(both.data(), std::ssize(both));
    for (Eigen::Index row = 0; row < part.size(); row += static_cast<Eigen::Index>(n))
      part.segment(row + static_cast<Eigen::Index>(n / 2), static_cast<Eigen::Index>(n / 2)).setZero();
    const double before = part.norm();
    for (const Eigen::VectorXd& other : known) part -= other.dot(part) * other;
    if (!(part.norm() > dependent * before)) continue;
    known.push_back(part.normalized());
    Eigen::VectorXd other = Eigen::VectorXd::Zero(part.size());
    for (Eigen::Index row = 0; row < part.size(); row += static_cast<Eigen::Index>(n))
      other.segment(row + static_cast<Eigen::Index>(n / 2), static_cast<Eigen::Index>(n / 2)) =
          part.segment(row, static_cast<Eigen::Index>(n / 2));
    const auto add = [&](const Eigen::VectorXd& x) {
      result.add({x.data(), static_cast<std::size_t>(x.size())});
    };
    if (j == 0 && shifts && free_duration) {
      add(part + other);
    } else {
      add(part);
      add(other);
    }
  }
  return result;
}

}  // namespace

void measure_phases(const Problem& problem, const Path& path, const SchemeTables& scheme, bool with_time,
                    PhaseConditions& phases) {
  const bool shifts = with_time && problem.shifts_in_time();
  phases.count = shifts + static_cast<int>(problem.symmetries.size());
  const std::size_t size = path.nodes().size();
  phases.directions.assign(phases.count * size, 0);
  double* direction = phases.directions.data();
  if (shifts) add_shift_of_time(path, scheme, std::exchange(direction, direction + size));
  for (const Generator& generator : problem.symmetries)
    if (add_motion(path, generator, direction) || problem.paired)
      direction += size;
    else
      --phases.count;
  phases.directions.resize(phases.count * size);
  if (problem.paired) phases = of_copies(phases, path.coordinates(), shifts, problem.duration.free);
}

PhaseConditions independent(const PhaseConditions& phases) {
  constexpr double dependent = 1e-4;
  PhaseConditions result;
  for (int j = 0; j < phases.count; ++j) {
    const std::span<const double> given = phases.direction(j);
    Eigen::VectorXd rest = Eigen::Map<const Eigen::VectorXd>(given.data(), std::ssize(given));
    const double before = rest.norm();
    for (int pass = 0; pass < 2; ++pass)
      for (int i = 0; i < result.count; ++i) {
        const Eigen::Map<const Eigen::VectorXd> known(result.direction(i).data(), rest.size());
        rest -= known.dot(rest) * known;
      }
    if (rest.norm() > dependent * before) {
      rest.normalize();
      result.add({rest.data(), given.size()});
    }
  }
  return result;
}

}  // namespace extremal
