#pragma once

#include <functional>
#include <span>
#include <vector>

#include "motion/dop853.hpp"

/// \file q along a motion, between the steps of its integrator too.

namespace extremal {

/// Times from one to another, later or earlier, and q there, row by row.
struct SampledMotion {
  std::vector<double> t, q;
};

struct MotionSampling {
  double tolerance;  ///< of the integrator's steps, relative
  int a_step;        ///< samples, equally spaced
  double unit;       ///< no two samples are at one t/unit: extended times may be one in double precision
  std::function<bool(int steps)> more = {};  ///< whether there may be another step after so many
};

/// The motion from (q, v) at t = `from`, as a flow in (q, p), to t = `to`. False where it cannot be followed:
/// the samples end there, and there are none if L is not finite at (q, v).
template <class Real, class AnyFlow>
bool sample_motion(AnyFlow flow, std::span<const double> q, std::span<const double> v, double from, double to,
                   const MotionSampling& options, SampledMotion& samples) {
  const std::size_t n = q.size();
  std::vector<Real> y(q.begin(), q.end()), between(2 * n);
  const std::vector<Real> velocity(v.begin(), v.end());
  y.resize(2 * n);
  samples = {};
  if (!flow.momentum(std::span(y).first(n), velocity, from, std::span(y).subspan(n))) return false;
  DormandPrince<Real> method(
      [&flow](Real t, std::span<const Real> x, std::span<Real> slope) { return flow.slope(t, x, slope); },
      static_cast<int>(2 * n));
  IntegrationOptions integration;
  integration.tolerance = options.tolerance;
  integration.block = static_cast<int>(n);
  const auto add = [&](Real t, std::span<const Real> point) {
    const double rounded = static_cast<double>(t);
    if (!samples.t.empty() && samples.t.back() / options.unit == rounded / options.unit) return;
    samples.t.push_back(rounded);
    for (const Real x : point) samples.q.push_back(static_cast<double>(x));
  };
  add(from, std::span(y).first(n));
  for (Real t = from, before = from; t != to; before = t) {
    if ((options.more && !options.more(method.steps())) ||
        method.accept_step(t, y, to, integration) != Integrated::done ||
        !method.prepare_interpolation(y, static_cast<int>(2 * n)))
      return false;
    for (int k = 1; k < options.a_step; ++k) {
      const Real theta = Real(k) / options.a_step;
      method.interpolate(theta, between);
      add(before + theta * (t - before), std::span(between).first(n));
    }
    add(t, std::span(y).first(n));
  }
  return true;
}

}  // namespace extremal
