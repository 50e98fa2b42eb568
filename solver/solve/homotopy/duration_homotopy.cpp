#include "solve/homotopy/duration_homotopy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "action/energies.hpp"
#include "machine/largest.hpp"
#include "solve/homotopy/limits.hpp"
#include "solve/mesh/resolution.hpp"

namespace extremal {

using namespace limits::duration_homotopy;

std::vector<double> natural_durations(const Problem& problem, Path& path, Workspace& w,
                                      const ElementTables& tables) {
  const double wanted = problem.duration.value, short_one = instant * wanted;
  QuadraticModel& model = w.iteration.model();
  DiscreteAction& action = w.iteration.action();
  path.set_duration(short_one);
  if (!model.evaluate(action, path, nullptr) || !action.finite()) return {};
  const double range = scales(path, tables).q;
  struct Candidate {
    double distance, duration, ratio;
  };
  std::vector<Candidate> candidates;
  double least = INFINITY;
  for (int k = -4 * octaves; k <= 4 * octaves; ++k) {
    const double duration = wanted * std::pow(2.0, 0.25 * k);
    path.set_duration(duration);
    model.evaluate_gradient(action, path);
    Step step;
    model.solve(action, nullptr, step);
    const double distance = largest(step.nodes) * duration / (short_one * range);
    if (!action.finite() || !std::isfinite(distance)) continue;
    candidates.push_back({std::max(distance, slight), duration, std::abs(std::log(duration / wanted))});
    least = std::min(least, candidates.back().distance);
  }
  std::erase_if(candidates, [&](const Candidate& c) { return c.distance > nearly_least * least; });
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.ratio < b.ratio;
  });
  std::vector<double> durations;
  for (const Candidate& c : candidates)
    if (durations.size() < most_durations) durations.push_back(c.duration);
  return durations;
}

DurationHomotopy::DurationHomotopy(const Problem& problem, Path& path, Workspace& workspace,
                                   std::function<bool()> count)
    : Homotopy(path, workspace, std::move(count), problem.duration.value),
      problem_(problem),
      wanted_(problem.duration.value) {
  problem_.duration = {.value = wanted_, .free = true, .energy = 0, .where = {}};
}

bool DurationHomotopy::solve_linearised(Move& correction, Move& direction) {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  ClosingEquation closing;
  if (!model.evaluate(action, path_, &closing) || !action.finite()) return false;
  const double energy = -action.slope_duration();
  closing.value = energy;
  solve_with_duration(model, action, closing, correction);
  closing.value = energy_unit(action, path_.duration()) + energy;
  solve_with_duration(model, action, closing, direction);
  direction.add(correction, -1);
  return true;
}

bool DurationHomotopy::set_parameter(double value) {
  const double duration = value == 0 ? wanted_ : wanted_ + value;
  if (duration > 0) path_.set_duration(duration);
  return duration > 0;
}

double DurationHomotopy::onward(const Move& direction) const {
  return direction.parameter * (sense_ != 0 ? sense_ : -parameter());
}

bool DurationHomotopy::trace(const ElementTables& tables) {
  sense_ = 0;
  return begin(tables, most_steps_there) && approach() && find_tangent() && reach();
}

bool DurationHomotopy::leave(const ElementTables& tables, bool longer) {
  sense_ = longer ? 1 : -1;
  return begin(tables, most_steps_on) && find_tangent();
}

}  // namespace extremal
