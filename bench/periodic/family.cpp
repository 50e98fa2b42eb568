#include "family.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "solve/branch/diagram.hpp"

namespace bench {

namespace {

constexpr int most_points = 200;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

extremal::ProblemFamily by_energy(const extremal::Problem& problem, double to) {
  return {.problem = problem,
          .varied = extremal::Varied::energy,
          .from = problem.duration.energy.value(),
          .to = to};
}

FamilyCost measure_family(const extremal::ProblemFamily& family, const extremal::SolveOptions& options,
                          int repeat) {
  using Clock = std::chrono::steady_clock;
  FamilyCost cost;
  std::vector<double> plain, locating;
  for (int k = 0; k < repeat; ++k) {
    extremal::Diagram branch(family, {.solve = options, .points = most_points});
    const bool begun = branch.advance();
    cost.points = cost.met = 0;
    double on_points = 0, on_met = 0;
    bool same_step = false;
    Clock::time_point start = Clock::now();
    while (begun && branch.advance()) {
      const Clock::time_point now = Clock::now();
      const bool met = branch.point().kind != extremal::PointKind::regular;
      (met || same_step ? on_met : on_points) += std::chrono::duration<double>(now - start).count();
      cost.met += met;
      cost.points += !met && !same_step;
      same_step = met;
      start = now;
    }
    plain.push_back(on_points / std::max(cost.points, 1));
    locating.push_back(on_met / std::max(cost.met, 1));
    const extremal::BranchRecord& record = branch.branches().back();
    cost.worst_action_slope = record.worst_action_slope;
    cost.worst_momentum = record.worst_momentum;
    cost.end = record.message;
  }
  cost.seconds = median(std::move(plain));
  cost.locating = median(std::move(locating));
  return cost;
}

}  // namespace bench
