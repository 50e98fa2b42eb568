#include "rivals/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "machine/roundoff.hpp"
#include "rivals/conditions.hpp"
#include "rivals/correction.hpp"
#include "rivals/integration_check.hpp"

namespace extremal {

namespace {

/// Relations between the ends are imposed exactly; the duration likewise.
constexpr double roundings = 64 * machine_epsilon;

void check(const Problem& problem, const Trajectory& trajectory, const VerifyOptions& options) {
  const auto require = [](bool holds, const std::string& message) {
    if (!holds) throw std::invalid_argument(message);
  };
  const std::size_t n = problem.coordinates();
  require(trajectory.coordinates == problem.coordinates(),
          fmt::format("a trajectory of {} coordinates for a problem of {}", trajectory.coordinates, n));
  require(trajectory.elements() >= 1 && trajectory.degree >= 1,
          fmt::format("a trajectory of {} elements of degree {}", std::max(0, trajectory.elements()),
                      trajectory.degree));
  const std::size_t needed = trajectory.elements() * (trajectory.degree + 1) * n;
  require(trajectory.nodes.size() == needed,
          fmt::format("a trajectory of {} values; need {}", trajectory.nodes.size(), needed));
  require(options.tolerance > 0 && options.margin > 0 && options.growth > 1,
          fmt::format("tolerance = {}, margin = {}, growth = {}; need positive numbers, growth above 1",
                      options.tolerance, options.margin, options.growth));
  double before = 0;
  for (const double end : options.ends) {
    require(end > before && end <= trajectory.duration(),
            fmt::format("a piece from {} to {} of a trajectory that runs to {}", before, end,
                        trajectory.duration()));
    before = end;
  }
}

/// Why the numbers of a trajectory are none that can be verified; empty where they are.
std::string broken_numbers(const Problem& problem, const Trajectory& trajectory) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(trajectory.nodes.begin(), trajectory.nodes.end(), finite))
    return "a value of the trajectory is not finite";
  if (trajectory.times.front() != 0) return fmt::format("it starts at t = {}", trajectory.times.front());
  for (std::size_t k = 1; k < trajectory.times.size(); ++k)
    if (!(trajectory.times[k] > trajectory.times[k - 1] && finite(trajectory.times[k])))
      return fmt::format("element {} runs from t = {} to {}", k, trajectory.times[k - 1],
                         trajectory.times[k]);
  const double duration = problem.duration.value, found = trajectory.duration();
  if (!problem.duration.free && std::abs(found - duration) > roundings * duration)
    return fmt::format("it lasts {} instead of {}", found, duration);
  return {};
}

class Verifier {
 public:
  Verifier(const Problem& problem, const Trajectory& trajectory, const VerifyOptions& options)
      : problem_(problem), options_(options), check_(problem, trajectory, options) {}

  Verification run() {
    std::string failure = check_.sample();
    if (failure.empty()) failure = check_.run(result_);
    if (failure.empty()) failure = judge_defects();
    if (failure.empty()) failure = judge_ends();
    if (failure.empty()) failure = judge_distance();
    result_.verified = failure.empty();
    result_.message = result_.verified ? "verified" : failure;
    return result_;
  }

 private:
  std::string judge_defects() const {
    if (!(std::max(result_.defect, result_.velocity_defect) <= options_.margin))
      return fmt::format("at t = {:.9g} the motion has left it: by {:.3g} tolerances in q, {:.3g} in q'",
                         result_.worst_time, result_.defect, result_.velocity_defect);
    return {};
  }

  std::string judge_ends() {
    const EndConditions conditions(problem_);
    values_ = conditions.at(check_.ends(), check_.scales());
    if (!values_.finite) return "the conditions at the ends are not finite";
    for (int r = 0; r < conditions.rows(); ++r) {
      const double residual = std::abs(values_.residual[r]);
      if (r < conditions.relation_rows()) {
        if (residual > roundings * values_.magnitude[r])
          return fmt::format("condition {} on the ends is missed by {:.3g}", r + 1, residual);
        continue;
      }
      const double allowed =
          velocity_factor * options_.tolerance * values_.size[r] + roundings * values_.magnitude[r];
      if (residual > 0) result_.conditions = std::max(result_.conditions, residual / allowed);
    }
    if (!(result_.conditions <= options_.margin))
      return fmt::format("a natural or closing condition is missed by {:.3g} tolerances", result_.conditions);
    return {};
  }

  std::string judge_distance() {
    if (check_.pieces().empty()) return {};
    result_.orientation = orientation(check_.pieces());
    const Eigen::VectorXd change = correction(check_.pieces(), values_, check_.scales());
    if (change.size() == 0) return {};
    const double largest = largest_change(check_.pieces(), change);
    // Of a path that is zero nothing is allowed.
    result_.distance = largest > 0 ? largest * check_.scales().q / check_.allowed_q() : 0;
    if (!(*result_.distance <= options_.margin))
      return fmt::format("the extremal is {:.3g} tolerances away", *result_.distance);
    return {};
  }

  const Problem& problem_;
  const VerifyOptions& options_;
  IntegrationCheck check_;
  Verification result_;
  EndConditions::Values values_;
};

}  // namespace

Verification verify(const Problem& problem, const Trajectory& trajectory, const VerifyOptions& options) {
  check(problem, trajectory, options);
  Verification result;
  result.message = broken_numbers(problem, trajectory);
  if (!result.message.empty()) return result;
  return Verifier(problem, trajectory, options).run();
}

}  // namespace extremal
