#include "judge_several.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "motion.hpp"
#include "recurrence.hpp"
#include "refute.hpp"
#include "solve/search/distinct.hpp"

namespace bench {
namespace {

constexpr int velocities = 400, bisections = 50;
/// Actions that differ by less than this, relative, may be those of one extremal.
constexpr double same_action = 1e-4;

void add(std::vector<Fault>& faults, const std::vector<Fault>& more, const std::string& of) {
  for (const Fault& fault : more) faults.push_back({fault.kind, of + fault.detail});
}

double start_velocity(const extremal::Solution& solution) {
  double q, v;
  solution.trajectory.at(0, {&q, 1}, {&v, 1});
  return v;
}

/// A velocity between two at which the end is passed from one side to the other; none where a motion cannot
/// be followed.
std::optional<double> crossing(const extremal::Problem& problem, double start, double end, double duration,
                               double low, double high) {
  const auto miss = [&](double v) {
    const Motion motion = follow(problem, {{start}, {v}}, duration);
    return motion.duration == duration ? motion.end.q[0] - end : NAN;
  };
  double at_low = miss(low);
  for (int k = 0; k < bisections; ++k) {
    const double middle = (low + high) / 2, here = miss(middle);
    if (std::isnan(here)) return std::nullopt;
    (here * at_low > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Extremals of one coordinate are known by the velocities at their start.
std::vector<Fault> find_gap(const extremal::Study& study, const std::vector<extremal::Solution>& found) {
  const extremal::Problem& problem = study.problem;
  const bool suits = problem.coordinates() == 1 && problem.ends.free == 0 && !problem.duration.free &&
                     !problem.periodic && found.size() > 1;
  if (!suits) return {};
  std::vector<double> known;
  for (const extremal::Solution& s : found) known.push_back(start_velocity(s));
  const auto [low, high] = std::minmax_element(known.begin(), known.end());
  const double start = problem.ends.offset[0], end = problem.ends.offset[1], T = problem.duration.value;
  const double step = (*high - *low) / velocities;
  double before = NAN, last = NAN;
  for (int k = 0; k <= velocities; ++k) {
    const double v = *low + k * step;
    const Motion motion = follow(problem, {{start}, {v}}, T);
    const double miss = motion.duration == T ? motion.end.q[0] - end : NAN;
    if (before * miss < 0 && std::none_of(known.begin(), known.end(),
                                          [&](double x) { return x >= last - step && x <= v + step; })) {
      const auto velocity = crossing(problem, start, end, T, last, v);
      if (!velocity) continue;
      extremal::Study beside = study;
      beside.problem.guess = motion_guess(problem, {{start}, {*velocity}}, T);
      if (!beside.problem.guess.given()) continue;
      const extremal::Solution missed = run(beside);
      const double margin = same_action * (std::abs(found.front().action) + std::abs(found.back().action));
      if (missed.converged() && missed.action > found.front().action + margin &&
          missed.action < found.back().action - margin)
        return {{"gap", fmt::format(
                            "an extremal of action {:.9g} with the velocity {:.9g} is missing between {:.9g} "
                            "and {:.9g}",
                            missed.action, *velocity, found.front().action, found.back().action)}};
    }
    before = miss;
    last = v;
  }
  return {};
}

/// The scene at one point of its family.
std::optional<extremal::Study> study_at(const extremal::Study& study, const extremal::BranchPoint& point) {
  const extremal::ProblemFamily& family = study.continuation->family;
  extremal::Study at = study;
  at.continuation.reset();
  if (family.varied == extremal::Varied::parameter) {
    std::optional<extremal::Problem> problem = family.at(point.parameter);
    if (!problem) return std::nullopt;
    at.problem = *std::move(problem);
  } else if (family.varied == extremal::Varied::energy) {
    at.problem.duration.energy = point.parameter;
  } else {
    at.problem.duration.value = point.parameter;
  }
  at.problem.guess = {};
  at.problem.reduction = nullptr;
  if (at.problem.duration.free) at.problem.duration.value = point.solution.duration();
  return at;
}

}  // namespace

std::vector<Fault> deny_search(const extremal::Study& study, const std::vector<extremal::Solution>& found) {
  std::vector<Fault> faults;
  if (!found.front().converged()) return {};
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::string of = fmt::format("solution {}: ", k + 1);
    if (!found[k].converged()) {
      faults.push_back({"invalid", of + "it has not converged"});
      continue;
    }
    if (study.options.elements == 0) add(faults, refute(study, found[k], std::nullopt), of);
    if (study.options.elements == 0) add(faults, deny_recurrence(study, found[k]), of);
    if (k > 0 && found[k].action < found[k - 1].action)
      faults.push_back({"invalid", of + "not sorted by action"});
    for (std::size_t j = 0; j < k; ++j)
      if (study.options.elements > 0 ? same_discrete(found[j], found[k])
                                     : same_path(found[j], found[k], 1e-3 * study.options.tolerance, 1))
        faults.push_back({"invalid", of + fmt::format("the same as {}", j + 1)});
  }
  if (study.options.elements == 0) add(faults, find_gap(study, found), "");
  return faults;
}

std::vector<Fault> deny_family(const extremal::Study& study, const extremal::FollowedBranch& branch) {
  std::vector<Fault> faults;
  for (const extremal::BranchPoint& point : branch.points) {
    if (!faults.empty()) return faults;
    const std::string of = fmt::format("{} = {:.9g}: ", branch.parameter, point.parameter);
    const std::optional<extremal::Study> at = study_at(study, point);
    if (!at) {
      faults.push_back({"false", of + "there is no such problem"});
      continue;
    }
    add(faults, refute(*at, point.solution, std::nullopt), of);
    add(faults, deny_recurrence(*at, point.solution), of);
    // One degree of freedom: multipliers are (1, 1), and each energy has one orbit.
    const bool one = at->problem.coordinates() == 1 && at->problem.periodic &&
                     at->problem.lagrangian->structure().autonomous &&
                     study.continuation->family.varied == extremal::Varied::energy;
    if (one && point.kind != extremal::PointKind::regular)
      faults.push_back({"false", of + fmt::format("a {} of one degree of freedom", name(point.kind))});
  }
  return faults;
}

}  // namespace bench
