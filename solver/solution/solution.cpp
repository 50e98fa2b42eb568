#include "solution/solution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "action/path.hpp"
#include "action/rule.hpp"
#include "machine/roundoff.hpp"
#include "solution/element_point.hpp"

namespace extremal {

namespace {

/// t within [0, T]; beyond it by rounding alone is taken to be the end.
double checked_time(double t, double duration) {
  const double slack = 4 * machine_epsilon * duration;
  if (!(t >= -slack && t <= duration + slack))
    throw std::invalid_argument(fmt::format("t = {}; the trajectory runs from 0 to {}", t, duration));
  return std::clamp(t, 0.0, duration);
}

/// The place of t in element k, on a node where t is that node's time as computed.
double local_time(const Trajectory& trajectory, int k, double t) {
  const double start = trajectory.times[k], h = trajectory.times[k + 1] - start;
  const double tau = std::min((t - start) / h, 1.0);
  if (tau == 1) return tau;  // nodes before the end may round to it
  const std::vector<double>& nodes = lobatto_barycentric(trajectory.degree).nodes;
  const auto above = std::lower_bound(nodes.begin(), nodes.end(), tau);
  for (auto node = above == nodes.begin() ? above : above - 1; node != nodes.end() && node <= above; ++node)
    if (start + h * *node == t) return *node;
  return tau;
}

}  // namespace

const char* name(Status status) {
  constexpr std::array names = {"converged",        "not-converged",  "collision",      "lost-convexity",
                                "no-solution-near", "conjugate-ends", "iteration-limit"};
  return names.at(static_cast<std::size_t>(status));
}

const char* name(Certificate certificate) {
  constexpr std::array names = {"none", "sampled", "global"};
  return names.at(static_cast<std::size_t>(certificate));
}

void Trajectory::at(double t, std::span<double> q, std::span<double> v) const {
  const double time = checked_time(t, duration());
  const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, time);
  const int k = static_cast<int>(after - times.begin()) - 1;
  in_element(k, local_time(*this, k, time), q, v);
}

void Trajectory::in_element(int element, double tau, std::span<double> q, std::span<double> v) const {
  std::array<double, max_degree + 1> value, derivative;
  lobatto_basis_at(degree, tau, value.data(), slopes.empty() ? derivative.data() : nullptr);
  element_point(*this, element, {value.data(), derivative.data()}, q.data(), v.data(), 1);
}

Trajectory trajectory_of(const Path& path) {
  Trajectory t;
  t.coordinates = path.coordinates();
  t.degree = path.degree();
  for (double tau : path.mesh()) t.times.push_back(tau * path.duration());
  for (double length : path.lengths()) t.lengths.push_back(length * path.duration());
  const std::size_t size = static_cast<std::size_t>(path.degree() + 1) * path.coordinates();
  t.nodes.resize(path.elements() * size);
  t.slopes.resize(path.elements() * size);
  const Basis& basis = lobatto_nodal_basis(path.degree());
  for (int k = 0; k < path.elements(); ++k) {
    path.element(k, t.nodes.data() + k * size);
    path.element_slopes(k, basis.derivative, t.slopes.data() + k * size);
  }
  return t;
}

}  // namespace extremal
