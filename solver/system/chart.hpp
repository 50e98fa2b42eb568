#pragma once

#include <span>
#include <vector>

/// \file Coordinates of the manifold of holonomic constraints: system/minimal_expressions.hpp.

namespace extremal {

/// Polar coordinates in the plane of two columns of a basis: their factors are
///   z_angle = x + r cos φ,  z_radius = y + r sin φ,   φ = y_angle / unit,  r = y_radius,
/// so that φ goes on where a path turns about (x, y).
struct Polar {
  int angle = 0, radius = 0;  ///< of y, and of the columns
  double x = 0, y = 0;
  double unit = 1;              ///< so that y_angle is measured like a length in q
  std::vector<int> invariants;  ///< the constraints that rotations about (x, y) leave as they are
};

/// q = B z(y), y = (u; w); z = y but for pairs in polar coordinates.
struct Chart {
  int coordinates = 0;        ///< n
  int free = 0;               ///< n − m, of u
  std::vector<double> basis;  ///< B, n × n, row-major: columns of u, then of w
  std::vector<Polar> polar;
  std::vector<int> order;     ///< of the constraints: A is factored without pivoting in this order
  std::vector<double> signs;  ///< of the pivots, m
  std::vector<double> point;  ///< (u, w) of a point of the manifold, from whose w others are searched for
  /// Where it is given, w is searched for from the sums of these multiples, a row for each of w: of 1, of
  /// each of u, and of cos φ and sin φ of each of u that is an angle.
  std::vector<double> start;
  double time = 0;  ///< t at the point
  double size = 0;  ///< of w: a step of the search is compared with it

  /// Number of multiples in a row of `start`.
  int features() const;
  /// Those of u, `features()` of them.
  void put_features(std::span<const double> u, std::span<double> out) const;

  /// q at y, and q' with y'; n each.
  void lift(std::span<const double> y, std::span<double> q) const;
  void lift(std::span<const double> y, std::span<const double> dy, std::span<double> v) const;
  /// ∂q/∂y, n × n, row-major.
  std::vector<double> slopes(std::span<const double> y) const;
  /// y at q, with the angles that are nearest to those of `near` (n; or empty); `inverse`: that of B.
  std::vector<double> coordinates_of(std::span<const double> inverse, std::span<const double> q,
                                     std::span<const double> near) const;

 private:
  void combine(std::span<const double> z, std::span<double> q) const;
};

}  // namespace extremal
