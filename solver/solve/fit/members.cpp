#include "solve/fit/members.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "solve/fit/limits.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/newton/least_eigenvalue.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

namespace extremal {

using namespace limits::fit;

namespace {

using Field = std::function<void(std::span<const double> q, std::span<const double> v, double* to)>;

/// The step that moves each point of a path by a field.
Step step_of(const Field& field, const Trajectory& trajectory, const Path& path,
             const ElementTables& tables) {
  const std::vector<double>& places = lobatto_barycentric(path.degree()).nodes;
  const std::size_t n = path.coordinates();
  Path moves;
  moves.reset(tables, path.mesh(), path.duration(), path.lengths());
  std::vector<double> q(n), v(n), element(n * places.size());
  for (int k = 0; k < path.elements(); ++k) {
    // An element begins with the slope in which the one before ends.
    std::copy_n(element.end() - static_cast<std::ptrdiff_t>(n), n, element.begin());
    for (std::size_t j = k == 0 ? 0 : 1; j < places.size(); ++j) {
      trajectory.in_element(k, places[j], q, v);
      field(q, v, element.data() + j * n);
    }
    moves.set_element(k, element.data());
  }
  return values_of(moves);
}

Eigen::Map<const Eigen::VectorXd> nodes_of(const Step& step) {
  return {step.nodes.data(), std::ssize(step.nodes)};
}

void scale(Step& step, double factor) {
  for (double& x : step.nodes) x *= factor;
  for (double& x : step.inner) x *= factor;
  step.duration *= factor;
}

/// As long as the path is wide.
void normalise(Step& step, double size) { scale(step, size / nodes_of(step).cwiseAbs().maxCoeff()); }

}  // namespace

std::vector<Step> moves_of_closed_path(const Problem& problem, const Path& path,
                                       const ElementTables& tables) {
  std::vector<Step> result;
  if (!problem.periodic) return result;
  const Trajectory trajectory = trajectory_of(path);
  const double size = scales(path, tables).q;
  std::vector<Eigen::VectorXd> known;  // orthonormal
  const auto add_field = [&](const Field& field) {
    Step step = step_of(field, trajectory, path, tables);
    Eigen::VectorXd rest = nodes_of(step);
    const double before = rest.norm();
    for (const Eigen::VectorXd& other : known) rest -= other.dot(rest) * other;
    if (!(rest.norm() > dependent_moves * before) || !(before > dependent_moves * size)) return;
    known.push_back(rest.normalized());
    normalise(step, size);
    result.push_back(std::move(step));
  };
  const std::size_t n = problem.coordinates();
  if (problem.shifts_in_time()) add_field([](auto, auto v, double* to) { std::ranges::copy(v, to); });
  // Symmetries of two copies are those of one and of the other in turn.
  const std::size_t together = problem.paired ? 2 : 1;
  for (std::size_t s = 0; s < problem.symmetries.size(); s += together)
    add_field([&](auto q, auto, double* to) {
      std::fill_n(to, n, 0.0);
      for (std::size_t copy = s; copy < s + together; ++copy) {
        const Generator& generator = problem.symmetries[copy];
        for (std::size_t a = 0; a < n; ++a) {
          to[a] += generator.shift[a];
          for (std::size_t b = 0; b < n; ++b) to[a] += generator.matrix[a * n + b] * q[b];
        }
      }
    });
  return result;
}

std::optional<SoftStep> softest_step(NewtonIteration& newton, const Path& path, const ElementTables& tables,
                                     const std::vector<Step>& known) {
  if (tables.unknowns() > most_dense_unknowns) return std::nullopt;
  PhaseConditions held;
  for (const Step& step : known) held.add(direction_of(step.nodes, path));
  newton.model().set_phases(held.count > 0 ? &held : nullptr);
  const auto softest = [&](const Path& at, Step& step) -> std::optional<double> {
    if (!newton.model().evaluate(newton.action(), at, newton.closing(at)) || !newton.action().finite())
      return std::nullopt;
    return least_eigenvalue(newton, at, step, 1 + static_cast<unsigned>(known.size()));
  };
  SoftStep result;
  std::optional<double> eigenvalue = softest(path, result.step);
  // Singular to the last digit, it answers no force along what is null: a little beside the path it does.
  if (eigenvalue && newton.model().left_out() > 0) {
    eigenvalue = softest(bumped(path, beside, scales(path, tables).q), result.step);
    if (eigenvalue && std::abs(*eigenvalue) < largest_beside) eigenvalue = 0;
  }
  newton.model().set_phases(nullptr);
  if (!eigenvalue) return std::nullopt;
  result.eigenvalue = *eigenvalue;
  normalise(result.step, scales(path, tables).q);
  return result;
}

}  // namespace extremal
