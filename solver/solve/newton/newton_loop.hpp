#pragma once

/// \file Newton's method: the loop that all runs of it share.

namespace extremal {

enum class Progress { more, arrived, failed };

/// Whether the equations are factored at the path, or solved with the factors of a path before.
enum class Factors { anew, before };

/// Newton's method. `solve(Factors)` linearises equations at the path and solves them with their border;
/// `policy` chooses the factors, judges the step and takes it or a part of it:
///
///   int most_steps
///   Factors factors(int k)                    of step k
///   Progress take(const Solved& step, int k)  step k, as solve() returned it
///   Progress exhausted()                      after most_steps
template <class Solve, class Policy>
Progress newton_loop(Solve&& solve, Policy& policy) {
  for (int k = 0; k < policy.most_steps; ++k) {
    const auto step = solve(policy.factors(k));
    if (const Progress progress = policy.take(step, k); progress != Progress::more) return progress;
  }
  return policy.exhausted();
}

/// The same with a policy of one function, and new factors in each step unless solve() has its own choice.
template <class Solve, class Take>
Progress newton_loop(Solve&& solve, int most_steps, Take&& take, Progress exhausted = Progress::failed) {
  for (int k = 0; k < most_steps; ++k)
    if (const Progress progress = take(solve(Factors::anew)); progress != Progress::more) return progress;
  return exhausted;
}

}  // namespace extremal
