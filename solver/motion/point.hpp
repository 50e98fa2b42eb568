#pragma once

#include <array>
#include <span>
#include <vector>

#include "machine/simd.hpp"
#include "system/lagrangian.hpp"

/// \file A Lagrangian at one point, without allocation after the first.

namespace extremal {

class PointEvaluator {
 public:
  /// `lagrangian` must outlive it. With `copies` = 2 it is that of two copies of the coordinates, of a system
  /// with forces F (system/copies.hpp), evaluated where they agree: then dq is ∂L/∂q + F, and second
  /// derivatives are those of dq and dv along the points where copies agree, so that they are not symmetric.
  explicit PointEvaluator(const Lagrangian& lagrangian, int copies = 1);
  PointEvaluator(const PointEvaluator&) = delete;
  PointEvaluator& operator=(const PointEvaluator&) = delete;

  /// Up to Order::gradient or Order::hessian at (q, q', t); false if not finite.
  bool evaluate(std::span<const double> q, std::span<const double> v, double t, Order order);

  const std::vector<double>& dq() const { return dq_; }  ///< ∂L/∂q
  const std::vector<double>& dv() const { return dv_; }  ///< ∂L/∂q'
  /// Second derivatives, both triangles; vq has rows of q' and columns of q, qv the opposite. Entries of one
  /// place add up.
  const std::vector<Triplet>& qq() const { return second_[0]; }
  const std::vector<Triplet>& qv() const { return second_[1]; }
  const std::vector<Triplet>& vq() const { return second_[2]; }
  const std::vector<Triplet>& vv() const { return second_[3]; }
  /// Those of vq and vv that are constant, and ∂L/∂q' at q = q' = 0 where all second derivatives by
  /// velocities are.
  std::span<const Triplet> constant_vq() const { return std::span(second_[2]).first(constant_[2]); }
  std::vector<Triplet> constant_vv() const {
    return {second_[3].begin(), second_[3].begin() + static_cast<std::ptrdiff_t>(constant_[3])};
  }
  std::span<const double> linear() const { return linear_; }

 private:
  /// Where one Hessian row of the Lagrangian goes.
  struct Place {
    int source, block;
    std::size_t at;
  };
  void place(int row, int column, double value, int source);
  bool read_gradient(std::span<const double> q, std::span<const double> v);
  bool read_hessian();

  const Lagrangian& lagrangian_;
  const std::size_t n_, all_;       ///< coordinates, and those of the Lagrangian
  const int lanes_ = simd_lanes();  ///< the point fills a whole batch
  std::vector<double> dq_, dv_;
  std::vector<double> linear_;
  std::array<std::vector<Triplet>, 4> second_;  ///< qq, qv, vq, vv
  std::array<std::size_t, 4> constant_ = {};
  std::vector<Place> places_;
  Scratch storage_, scratch_;
  double *point_, *out_;
};

}  // namespace extremal
