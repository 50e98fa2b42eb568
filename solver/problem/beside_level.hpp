#pragma once

#include <qd/dd_real.h>

#include <span>
#include <vector>

#include "system/extended_hessian.hpp"
#include "system/lagrangian.hpp"

/// \file L next to a level of one coordinate, at which it is infinite.

namespace extremal {

/// F = C(t) d^(1−γ)/(1 − γ) of the distance d from the level. L and L − dF/dt have the same extremals. If C
/// d^−γ is the part of the momentum that is infinite, and C' is zero at the ends, L − dF/dt is smaller than L
/// by d^2γ.
struct LevelGauge {
  double exponent = 0;                  ///< γ
  DoubleDouble start = 0.0, end = 0.0;  ///< C at t = 0 and at T
  double duration = 1;                  ///< T
};

/// x^e, also where x is not positive or not finite.
DoubleDouble power(const DoubleDouble& x, double e);

/// L and its derivatives at points that are given by the distance of one coordinate from a level. Next to the
/// level the coordinate itself has few digits, and differences in L, as in 1 − y², have fewer: they are taken
/// in 106 bits, if L is known to so many.
class BesideLevel {
 public:
  /// At one point; matrices n × n row by row.
  struct Values {
    DoubleDouble value;
    std::vector<DoubleDouble> q, v, qq, vq, vv;
  };

  /// `lagrangian` must outlive it. Without a level (coordinate −1) points are given by q alone.
  BesideLevel(const Lagrangian& lagrangian, int coordinate, double level, double side);

  bool extended() const { return hessian_ != nullptr; }
  /// The distance at which L is evaluated: without more digits that of the coordinate as it is rounded.
  double rounded(double distance) const;
  /// The entry of `q` for the coordinate is not read.
  const Values& at(double distance, std::span<const double> q, std::span<const double> v,
                   const DoubleDouble& t, Order order);
  /// Of the point evaluated last: L − dF/dt.
  const Values& without(const LevelGauge& gauge);
  /// p·q' − L there; the order was not Order::value.
  double energy() const;

 private:
  void read_doubles(Order order);
  void read_rows(Order order);
  void add_quadratic_part();

  const Lagrangian& lagrangian_;
  const ExtendedHessian* hessian_;
  std::size_t n_;
  int a_;
  double level_, side_;
  DoubleDouble distance_, t_;
  std::vector<DoubleDouble> q_, v_, rows_;
  Values values_;
  PointScratch<DoubleDouble> scratch_;
  Scratch double_scratch_;
};

}  // namespace extremal
