#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "motion/dop853.hpp"

/// \file q along a motion, between the steps of its integrator too.

namespace extremal {

/// Times from one to another, later or earlier, in a unit, and q there, row by row.
struct SampledMotion {
  std::vector<double> tau, q;
};

struct MotionSampling {
  double tolerance;                          ///< of the integrator's steps, relative
  int a_step;                                ///< samples, equally spaced
  double unit;                               ///< of time
  std::function<bool(int steps)> more = {};  ///< whether there may be another step after so many
  std::array<double, 2> least = {0, 0};      ///< of q and p: smaller ones count as so large
};

/// After each step: moves y = (q, p) to where the motion is at t, if that is known better. Whether to go on.
template <class Real>
using Anchor = std::function<bool(Real t, std::span<Real> y)>;

/// The motion from (q, v) at t = `from`, as a flow in (q, p), to t = `to`. q is that at tau·unit exactly,
/// though steps end elsewhere. False where it cannot be followed: the samples end there, and there are none
/// if L is not finite at (q, v).
template <class Real, class AnyFlow>
bool sample_motion(AnyFlow&& flow, std::span<const Real> q, std::span<const Real> v, double from, double to,
                   const MotionSampling& options, SampledMotion& samples, const Anchor<Real>& anchor = {}) {
  const std::size_t n = q.size();
  std::vector<Real> y(q.begin(), q.end()), between(n);
  y.resize(2 * n);
  samples = {};
  if (!flow.momentum(std::span(y).first(n), v, from, std::span(y).subspan(n))) return false;
  DormandPrince<Real> method(
      [&flow](Real t, std::span<const Real> x, std::span<Real> slope) { return flow.slope(t, x, slope); },
      static_cast<int>(2 * n));
  IntegrationOptions integration;
  integration.tolerance = options.tolerance;
  integration.block = static_cast<int>(n);
  integration.least = options.least;
  const auto add = [&](double tau, std::span<const Real> point) {
    samples.tau.push_back(tau);
    for (std::size_t a = 0; a < n; ++a) samples.q.push_back(static_cast<double>(point[a]));
  };
  add(from / options.unit, y);
  for (Real t = from, before = from; t != to; before = t) {
    if ((options.more && !options.more(method.steps())) ||
        method.accept_step(t, y, to, integration) != Integrated::done ||
        !method.prepare_interpolation(y, static_cast<int>(2 * n)))
      return false;
    for (int k = 1; k <= options.a_step; ++k) {
      const Real near = k < options.a_step ? before + (t - before) * k / options.a_step : t;
      const auto tau = static_cast<double>(near / options.unit);
      if (tau == samples.tau.back()) continue;
      method.interpolate((tau * Real(options.unit) - before) / (t - before), between);
      add(tau, between);
    }
    if (anchor && !anchor(t, y)) return false;
  }
  return true;
}

}  // namespace extremal
