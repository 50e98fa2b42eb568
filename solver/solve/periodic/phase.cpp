#include "solve/periodic/phase.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Half of q'·h of every element to each of its ends.
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

/// Zero in the other of two copies.
void keep_copy(int copy, std::size_t n, std::span<double> direction) {
  for (std::size_t row = 0; row < direction.size(); row += n)
    std::fill_n(direction.begin() + static_cast<std::ptrdiff_t>(row + (copy == 0 ? n / 2 : 0)), n / 2, 0.0);
}

void add_motion(const Path& path, const Generator& generator, double* direction) {
  const int n = path.coordinates(), elements = path.elements();
  const std::span<const double> mesh = path.mesh();
  for (int k = 0; k <= elements; ++k) {
    const double weight = 0.5 * (mesh[std::min(k + 1, elements)] - mesh[std::max(k - 1, 0)]);
    for (int a = 0; a < n; ++a) {
      double value = generator.shift[a];
      for (int b = 0; b < n; ++b) value += generator.matrix[a * n + b] * path.node(k)[b];
      direction[k * n + a] = weight * value;
    }
  }
}

}  // namespace

void measure_phases(const Problem& problem, const Path& path, const SchemeTables& scheme, bool with_time,
                    PhaseConditions& phases) {
  const bool shifts = with_time && problem.periodic && problem.lagrangian->structure().autonomous;
  // A period that is given closes nothing: two copies are held one by one, as by other symmetries.
  const bool twice = shifts && problem.paired && !problem.duration.free;
  phases.count = shifts + twice + static_cast<int>(problem.symmetries.size());
  const std::size_t size = path.nodes().size();
  phases.directions.assign(phases.count * size, 0);
  double* direction = phases.directions.data();
  for (int copy = 0; copy < shifts + twice; ++copy) {
    add_shift_of_time(path, scheme, direction);
    if (twice) keep_copy(copy, path.coordinates(), {direction, size});
    direction += size;
  }
  for (const Generator& generator : problem.symmetries)
    add_motion(path, generator, std::exchange(direction, direction + size));
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
