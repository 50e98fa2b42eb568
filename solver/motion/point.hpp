#pragma once

#include <span>
#include <vector>

#include "machine/simd.hpp"
#include "system/lagrangian.hpp"

/// \file A Lagrangian at one point, without allocation after the first.

namespace extremal {

class PointEvaluator {
 public:
  /// `lagrangian` must outlive it.
  explicit PointEvaluator(const Lagrangian& lagrangian);
  PointEvaluator(const PointEvaluator&) = delete;
  PointEvaluator& operator=(const PointEvaluator&) = delete;

  /// Up to Order::gradient or Order::hessian at (q, q', t); false if not finite.
  bool evaluate(std::span<const double> q, std::span<const double> v, double t, Order order);

  const std::vector<double>& dq() const { return dq_; }  ///< ∂L/∂q
  const std::vector<double>& dv() const { return dv_; }  ///< ∂L/∂q'
  /// Second derivatives, both triangles of the symmetric ones; vq has rows of q' and columns of q.
  const std::vector<Triplet>& qq() const { return qq_; }
  const std::vector<Triplet>& vq() const { return vq_; }
  const std::vector<Triplet>& vv() const { return vv_; }

 private:
  bool read_gradient(std::span<const double> q, std::span<const double> v);
  bool read_hessian();

  const Lagrangian& lagrangian_;
  const int lanes_ = simd_lanes();  ///< the point fills a whole batch
  std::vector<double> dq_, dv_;
  std::vector<Triplet> qq_, vq_, vv_;
  Scratch storage_, scratch_;
  double *point_, *out_;
};

}  // namespace extremal
