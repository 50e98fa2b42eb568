#include "family.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "solve/branch/continuation.hpp"

namespace bench {

namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

FamilyCost measure_family(const extremal::Study& study, double to, int repeat) {
  using Clock = std::chrono::steady_clock;
  const extremal::ProblemFamily family{.problem = study.problem,
                                       .varied = extremal::Varied::energy,
                                       .from = study.problem.duration.energy.value(),
                                       .to = to};
  FamilyCost cost;
  std::vector<double> plain, locating;
  for (int k = 0; k < repeat; ++k) {
    extremal::Continuation branch(family, {.solve = study.options});
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
    cost.worst_action_slope = branch.worst_action_slope();
    cost.worst_momentum = branch.worst_momentum();
    cost.end = branch.message();
  }
  cost.seconds = median(std::move(plain));
  cost.locating = median(std::move(locating));
  return cost;
}

}  // namespace bench
