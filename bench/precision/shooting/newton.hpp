#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "segments.hpp"
#include "shooting.hpp"

/// \file Newton's method on the equations of shooting.

namespace bench::shooting {

/// Far from the solution damped steps with new variations, at a loose tolerance; near it the motions alone
/// are integrated, at the final tolerance, and the factors are kept as long as they serve.
template <class System, bool free_duration>
class NewtonShooter : public Shooter {
 public:
  NewtonShooter(const System& system, const BoundaryProblem& problem, const Setting& setting)
      : system_(system),
        problem_(problem),
        setting_(setting),
        segments_(system, problem_, setting.segments),
        iterate_{std::vector<double>(2 * system.n * setting.segments)},
        trial_(iterate_),
        change_(iterate_),
        simplified_(iterate_) {}

  bool solve(std::span<const double> guess) override {
    std::copy(guess.begin(), guess.end(), iterate_.states.begin());
    iterate_.duration = problem_.duration;
    tolerance_ = std::max(setting_.tolerance, setting_.loose);
    segments_.forget_steps();
    iterations_ = 0;
    if (!renew()) return false;
    while (correction_ > near)
      if (!damped_step()) return false;
    segments_.change_tolerance(setting_.tolerance / tolerance_);
    tolerance_ = setting_.tolerance;
    return finish();
  }

  double duration() const override { return iterate_.duration; }

  std::vector<double> states(std::span<const double> times, double tolerance) override {
    const int size = 2 * system_.n;
    Integrator<System> integrator(system_, {problem_.q_scale, problem_.v_scale});
    std::vector<double> result, state(size);
    double t = 0, step = 0;
    int segment = -1;
    for (const double time : times) {
      const int now =
          std::min(static_cast<int>(time / iterate_.duration * setting_.segments), setting_.segments - 1);
      if (now != segment) {
        segment = now;
        t = iterate_.duration * segment / setting_.segments;
        std::copy_n(iterate_.states.begin() + segment * size, size, state.begin());
      }
      if (time > t && !integrator.advance(state.data(), time - t, tolerance, step)) return {};
      t = std::max(t, time);
      result.insert(result.end(), state.begin(), state.end());
    }
    return result;
  }

 private:
  /// Corrections up to this, in the scales, are near the solution.
  static constexpr double near = 1e-3;
  static constexpr double least_damping = 1.0 / 1024, most_growth = 2;
  /// Corrections that fall by less per iteration call for new factors.
  static constexpr double slow = 0.1;
  static constexpr int most_iterations = 50;

  /// New variations, factors and correction.
  bool renew() { return segments_.evaluate_with_variations(iterate_, tolerance_) && renew_factors(); }
  bool renew_factors() {
    if (!segments_.factor()) return false;
    correction_ = segments_.correct(iterate_, change_);
    return std::isfinite(correction_);
  }

  void move(double damping) {
    for (std::size_t i = 0; i < trial_.states.size(); ++i)
      trial_.states[i] = iterate_.states[i] + damping * change_.states[i];
    trial_.duration = iterate_.duration + damping * change_.duration;
  }

  /// The longest step, halved from the full one, whose simplified correction is at most twice the last.
  /// Newton's method often converges through larger corrections; a test of descent would shorten its steps.
  bool damped_step() {
    for (double damping = 1; damping >= least_damping && ++iterations_ <= most_iterations; damping /= 2) {
      move(damping);
      if (!(trial_.duration > 0) || !segments_.evaluate_with_variations(trial_, tolerance_)) continue;
      if (!(segments_.correct(trial_, simplified_) <= most_growth * correction_)) continue;
      std::swap(iterate_, trial_);
      return renew_factors();
    }
    return false;
  }

  /// Full steps; what remains after one falls by the same factor as the corrections. The first factor is that
  /// of Newton's method for second derivatives of size one.
  bool finish() {
    bool precise = setting_.loose <= tolerance_;
    double contraction = correction_;
    while (!precise || contraction * correction_ > tolerance_) {
      if (++iterations_ > most_iterations) return false;
      take_full_step();
      if (!segments_.evaluate(iterate_, tolerance_)) return false;
      const double last = correction_;
      correction_ = segments_.correct(iterate_, change_);
      if (std::exchange(precise, true)) contraction = correction_ / last;
      if (contraction <= slow) continue;
      if (!renew()) return false;
      contraction = correction_;
    }
    take_full_step();
    return true;
  }

  void take_full_step() {
    move(1);
    std::swap(iterate_, trial_);
  }

  System system_;
  BoundaryProblem problem_;
  Setting setting_;
  Segments<System, free_duration> segments_;
  double tolerance_ = 0, correction_ = 0;
  int iterations_ = 0;
  Iterate iterate_, trial_, change_, simplified_;
};

}  // namespace bench::shooting
