#include "family.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "solve/continuation.hpp"

namespace bench {

FamilyCost measure_family(const extremal::Study& study, double to, int repeat) {
  using Clock = std::chrono::steady_clock;
  const extremal::ProblemFamily family{.problem = study.problem,
                                       .varied = extremal::Varied::energy,
                                       .from = study.problem.duration.energy.value(),
                                       .to = to};
  FamilyCost cost;
  std::vector<double> seconds;
  for (int k = 0; k < repeat; ++k) {
    extremal::Continuation branch(family, {.solve = study.options});
    const bool begun = branch.advance();
    cost.points = 0;
    const Clock::time_point start = Clock::now();
    while (begun && branch.advance()) ++cost.points;
    const double passed = std::chrono::duration<double>(Clock::now() - start).count();
    seconds.push_back(passed / std::max(cost.points, 1));
    cost.worst_action_slope = branch.worst_action_slope();
    cost.worst_momentum = branch.worst_momentum();
    cost.end = branch.message();
  }
  std::nth_element(seconds.begin(), seconds.begin() + repeat / 2, seconds.end());
  cost.seconds = seconds[repeat / 2];
  return cost;
}

}  // namespace bench
