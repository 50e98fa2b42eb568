#pragma once

/// \file Newton's method: the loop that all runs of it share.

namespace extremal {

enum class Progress { more, arrived, failed };

/// Whether the equations are factored at the path, or solved with the factors of a path before.
enum class Factors { anew, before };

/// Newton's method. `equations` are linearised at the path and closed by their border; `policy` chooses the
/// factors, judges the step and takes it or a part of it:
///
///   int most_steps
///   Factors factors(int k)                    of step k
///   Progress take(const Solved& step, int k)  step k, as equations.solve() returned it
///   Progress exhausted()                      after most_steps
template <class Equations, class Policy>
Progress newton_loop(Equations&& equations, Policy& policy) {
  for (int k = 0; k < policy.most_steps; ++k) {
    const auto step = equations.solve(policy.factors(k));
    if (const Progress progress = policy.take(step, k); progress != Progress::more) return progress;
  }
  return policy.exhausted();
}

/// A policy of two functions.
template <class Choose, class Take>
struct NewtonPolicy {
  int most_steps;
  Progress at_end;
  Choose factors;
  Take take;
  Progress exhausted() const { return at_end; }
};
template <class Choose, class Take>
NewtonPolicy(int, Progress, Choose, Take) -> NewtonPolicy<Choose, Take>;

}  // namespace extremal
