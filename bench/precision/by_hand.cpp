#include "by_hand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "hand_problem.hpp"

namespace bench {
namespace {

constexpr int most_repeats_by_hand = 2001;
/// Coordinates above which the variations of several segments take too long.
constexpr int most_multiple_by_hand = 40;
/// Tried, so that the best can be chosen in hindsight: numbers of segments, and tolerances far from the
/// solution (0: the final one).
constexpr int segments_by_hand[] = {1, 2, 4, 8, 16, 32};
constexpr double loose_tolerances[] = {0, 1e-5, 1e-4, 1e-3};
/// Tolerances, one a decade.
constexpr int least_digits = 3, most_digits = 14;
/// Of the integration of the motion found: its error is that of the states.
constexpr double precise = 1e-14;

/// Median of one solve.
double time_solve(shooting::Shooter& shooter, const std::vector<double>& guess, double budget,
                  bool& converged) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> seconds;
  double spent = 0;
  do {
    const auto start = Clock::now();
    converged = shooter.solve(guess);
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    spent += seconds.back();
  } while (converged && spent < budget && seconds.size() < most_repeats_by_hand);
  const auto middle = seconds.begin() + seconds.size() / 2;
  std::nth_element(seconds.begin(), middle, seconds.end());
  return *middle;
}

/// Largest difference from the reference; beyond the duration found the motion goes on uniformly.
void measure_error(shooting::Shooter& shooter, const Reference& reference, Run& run) {
  const std::size_t n = reference.q.size() / reference.t.size();
  std::vector<double> times = reference.t;
  for (double& t : times) t = std::min(t, shooter.duration());
  const std::vector<double> states = shooter.states(times, precise);
  if (states.empty()) {
    run.failure = "the motion found cannot be followed";
    return;
  }
  std::vector<double> q(reference.q.size()), v(reference.v.size());
  for (std::size_t i = 0; i < times.size(); ++i)
    for (std::size_t a = 0; a < n; ++a) {
      v[i * n + a] = states[i * 2 * n + n + a];
      q[i * n + a] = states[i * 2 * n + a] + (reference.t[i] - times[i]) * v[i * n + a];
    }
  run.error = difference(q, v, reference).q;
}

/// One setting.
Run shoot(const HandProblem& hand, const shooting::Setting& setting, const std::vector<double>& guess,
          const Reference& reference, double budget) {
  const auto shooter = shooting::make_shooter(hand.system, hand.boundary, setting);
  Run run{.tolerance = setting.tolerance, .segments = setting.segments, .loose = setting.loose};
  bool converged = false;
  run.seconds = time_solve(*shooter, guess, budget, converged);
  run.failure = converged ? "" : "does not converge";
  if (converged) measure_error(*shooter, reference, run);
  return run;
}

}  // namespace

void measure_by_hand(const extremal::Study& study, const Reference& reference, double budget,
                     SceneRecord& record) try {
  const HandProblem hand = hand_problem(study);
  const int n = hand.system.coordinates;
  if (n > most_multiple_by_hand)
    record.multiple_by_hand.absence = fmt::format("not tried with {} coordinates", n);
  for (const int segments : segments_by_hand) {
    if (segments > 1 && n > most_multiple_by_hand) break;
    const std::vector<double> guess = hand_guess(hand, study.problem, segments);
    Rival& rival = segments == 1 ? record.single_by_hand : record.multiple_by_hand;
    for (const double loose : loose_tolerances)
      for (int digits = least_digits; digits <= most_digits; ++digits) {
        const double tolerance = std::pow(10.0, -digits);
        if (loose > 0 && loose < 2 * tolerance) continue;
        rival.runs.push_back(shoot(hand, {tolerance, loose, segments}, guess, reference, budget));
      }
  }
} catch (const std::invalid_argument& reason) {
  record.single_by_hand.absence = record.multiple_by_hand.absence = reason.what();
}

}  // namespace bench
