#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "method.hpp"
#include "variations.hpp"

/// \file A motion, with or without its variations.

namespace bench::shooting {

/// Errors of a step are measured in these units.
struct Scales {
  double q = 1, v = 1;
};

/// DOP853 with the step length set by the error of the motion. Variations are advanced after a step is
/// accepted, with the derivatives at its stages.
template <class System>
class Integrator {
 public:
  Integrator(const System& system, Scales scales) : system_(system), scales_(scales) {
    q_ = v_ = next_q_ = next_v_ = stage_q_ = stage_v_ = system.coordinates();
    f_.fill(q_);
    slope_.fill(system.slope());
  }

  /// Moves the state (q, q') and its variations on by `duration`. `step` is the length of the first step, 0
  /// if none is known; on return, that of the first one accepted. False if the integration fails.
  template <int width>
  bool advance(double* state, double duration, double tolerance, double& step,
               Variations<System, width>& variations) {
    return run<width>(state, duration, tolerance, step, [&](double h) { variations.step(slope_, h); });
  }
  bool advance(double* state, double duration, double tolerance, double& step) {
    return run<0>(state, duration, tolerance, step, [](double) {});
  }

 private:
  using Coordinates = typename System::Coordinates;

  static constexpr double safety = 0.9, most_growth = 6, most_shrinking = 1.0 / 3;
  /// Shortening where f cannot be evaluated.
  static constexpr double retreat = 0.25;
  /// Of the length that first_step() estimates.
  static constexpr double first_part = 0.5;
  static constexpr double roundoff = 1e-14;
  static constexpr int most_trials = 1000000;

  /// Calls accepted(h) after each accepted step.
  template <int width, class Accepted>
  bool run(double* state, double duration, double tolerance, double& step, const Accepted& accepted) {
    std::copy_n(state, system_.n, q_.begin());
    std::copy_n(state + system_.n, system_.n, v_.begin());
    evaluate<width>(0, q_, v_);
    double h = step > 0 ? step : std::min(first_step(tolerance), duration), left = duration;
    step = 0;
    for (int trial = 0; trial < most_trials; ++trial) {
      const double steps = std::ceil(left / h * (1 - roundoff));  // of equal length, to the end
      h = left / steps;
      if (!(h > roundoff * duration)) return false;
      take_step<width>(h);
      const double error = measure_error(h) / tolerance;
      if (!(error <= 1)) {
        h *= std::isfinite(error) ? std::max(most_shrinking, safety / eighth_root(error)) : retreat;
        continue;
      }
      accepted(h);
      q_ = next_q_;
      v_ = next_v_;
      if (step == 0) step = h;
      if (steps == 1) {
        std::copy_n(q_.begin(), system_.n, state);
        std::copy_n(v_.begin(), system_.n, state + system_.n);
        return true;
      }
      left -= h;
      h *= std::min(most_growth, safety / eighth_root(error));
      evaluate<width>(0, q_, v_);
    }
    return false;
  }

  static double eighth_root(double x) { return std::sqrt(std::sqrt(std::sqrt(x))); }

  template <int width>
  void evaluate(int stage, const Coordinates& q, const Coordinates& v) {
    system_.acceleration(q.data(), v.data(), f_[stage].data(), width > 0 ? &slope_[stage] : nullptr);
  }

  /// A time in which the state changes by about the eighth root of the tolerance, in the scales.
  double first_step(double tolerance) const {
    double change = 0;
    for (int c = 0; c < system_.n; ++c)
      change = std::max({change, std::abs(f_[0][c]) / scales_.v, std::abs(v_[c]) / scales_.q});
    return first_part * eighth_root(tolerance) / change;
  }

  template <class Row, bool velocities>
  void sum(double h, Coordinates& q, Coordinates& v) const {
    for (int c = 0; c < system_.n; ++c) {
      const auto f = [&](int k) { return f_[k][c]; };
      q[c] = q_[c] + h * (Row::c * v_[c] + h * sum_stages<Row, Of::position>(f));
      if constexpr (velocities) v[c] = v_[c] + h * sum_stages<Row, Of::velocity>(f);
    }
  }

  template <int width, std::size_t... i>
  void take_stages(double h, std::index_sequence<i...>) {
    ((sum<Stage<i + 1>, !System::velocity_free>(h, stage_q_, stage_v_),
      evaluate<width>(i + 1, stage_q_, stage_v_)),
     ...);
  }

  template <int width>
  void take_step(double h) {
    take_stages<width>(h, std::make_index_sequence<stages - 1>());
    sum<EndOfStep, true>(h, next_q_, next_v_);
  }

  /// Hairer, Nørsett and Wanner (II.10.17): |h| e5² / √(e5² + 0.01 e3²).
  double measure_error(double h) const {
    double sum5 = 0, sum3 = 0;
    for (int c = 0; c < system_.n; ++c) {
      const auto f = [&](int k) { return f_[k][c]; };
      const double q5 = h * sum_stages<Error5, Of::position>(f) / scales_.q;
      const double v5 = sum_stages<Error5, Of::velocity>(f) / scales_.v;
      const double q3 = h * sum_stages<Error3, Of::position>(f) / scales_.q;
      const double v3 = sum_stages<Error3, Of::velocity>(f) / scales_.v;
      sum5 += q5 * q5 + v5 * v5;
      sum3 += q3 * q3 + v3 * v3;
    }
    return sum5 == 0 ? 0 : h * sum5 / std::sqrt((sum5 + 0.01 * sum3) * 2 * system_.n);
  }

  System system_;
  Scales scales_;
  Coordinates q_, v_, next_q_, next_v_, stage_q_, stage_v_;
  std::array<Coordinates, stages> f_;
  std::array<typename System::Slope, stages> slope_;
};

}  // namespace bench::shooting
