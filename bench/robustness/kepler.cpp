#include "kepler.hpp"

#include <cmath>
#include <numbers>

#include "random.hpp"
#include "systems.hpp"

namespace bench {
namespace {

using std::numbers::pi;

constexpr int arc_steps = 100;

/// Mean anomaly where the true anomaly is f, continuous in f.
double mean_anomaly(double f, double e) {
  const double turns = std::round(f / (2 * pi)), within = f - 2 * pi * turns;
  const double eccentric = 2 * std::atan(std::sqrt((1 - e) / (1 + e)) * std::tan(within / 2));
  return eccentric - e * std::sin(eccentric) + 2 * pi * turns;
}

/// The angle that a trajectory runs through about the origin.
double angle_run(const extremal::Trajectory& trajectory) {
  const int steps = 40 * trajectory.elements();
  std::vector<double> q(2), v(2);
  double sum = 0, before = 0;
  for (int k = 0; k <= steps; ++k) {
    const int element = std::min(k / 40, trajectory.elements() - 1);
    const double from = trajectory.times[element], to = trajectory.times[element + 1];
    trajectory.at(std::min(from + (to - from) * (k - 40 * element) / 40.0, trajectory.duration()), q, v);
    const double angle = std::atan2(q[1], q[0]);
    if (k > 0) sum += std::remainder(angle - before, 2 * pi);
    before = angle;
  }
  return sum;
}

Case kepler_arc(const std::shared_ptr<const extremal::Lagrangian>& kepler, double e, double first,
                double angle, bool circular) {
  const auto radius = [e](double f) { return (1 - e * e) / (1 + e * std::cos(f)); };
  const double r0 = radius(first), r1 = radius(first + angle);
  Case result;
  result.problem = fixed_ends(kepler, {r0, 0}, {r1 * std::cos(angle), r1 * std::sin(angle)},
                              mean_anomaly(first + angle, e) - mean_anomaly(first, e));
  if (!circular) return result;
  for (int k = 0; k <= arc_steps; ++k) {
    const double tau = static_cast<double>(k) / arc_steps, r = r0 + tau * (r1 - r0);
    result.problem.guess.tau.push_back(tau);
    result.problem.guess.q.push_back(r * std::cos(tau * angle));
    result.problem.guess.q.push_back(r * std::sin(tau * angle));
  }
  result.problem = make_problem(std::move(result.problem));
  result.intended = [angle](const extremal::Trajectory& trajectory) {
    return std::abs(angle_run(trajectory) - angle) < 1e-3;
  };
  return result;
}

}  // namespace

std::vector<Case> kepler_arcs(double least_angle, double most_angle, int count, bool circular) {
  const auto kepler = system("kepler");
  Random random(static_cast<unsigned>(least_angle));
  std::vector<Case> cases;
  for (int k = 0; k < count; ++k) {
    const double e = random.between(0, 0.9), first = random.between(0, 2 * pi),
                 angle = random.between(least_angle, most_angle) * pi / 180;
    cases.push_back(kepler_arc(kepler, e, first, angle, circular));
  }
  return cases;
}

}  // namespace bench
