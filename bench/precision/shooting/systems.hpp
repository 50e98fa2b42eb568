#pragma once

#include <array>
#include <cmath>

/// \file Accelerations with their derivatives, written by hand for one system each.
///
/// A system has n coordinates, a `Slope` that holds what is not constant in ∂q''/∂q and ∂q''/∂q', and
/// - coordinates(), columns(), slope(): zeros, of the right size;
/// - acceleration(q, v, a, slope): q'' and, unless null, the slope from the same subexpressions;
/// - vary<width>(slope, x, y, w): w = ∂q''/∂q x + ∂q''/∂q' y for `width` columns, row by row.
/// `velocity_free`: q'' does not depend on q', and v and y are not read.

namespace bench::shooting {

/// The number of coordinates is known to the compiler; all columns of variations are one block.
template <int count>
struct FewCoordinates {
  static constexpr int n = count;
  /// Columns of a block of variations: of all components, and of as many as are unknown at the start.
  static constexpr int width = 2 * count;
  static constexpr int first_width(bool free_duration) { return count - free_duration; }
  using Coordinates = std::array<double, count>;
  template <int width>
  using Columns = std::array<double, count * width>;

  static Coordinates coordinates() { return {}; }
  template <int width>
  static Columns<width> columns() {
    return {};
  }
};

/// q'' = −ω² sin q.
struct Pendulum : FewCoordinates<1> {
  static constexpr bool velocity_free = true;
  struct Slope {
    double qq;
  };
  double stiffness;

  static Slope slope() { return {}; }
  /// g, l
  explicit Pendulum(const double* p) : stiffness(p[0] / p[1]) {}

  void acceleration(const double* q, const double*, double* a, Slope* slope) const {
    a[0] = -stiffness * std::sin(q[0]);
    if (slope) slope->qq = -stiffness * std::cos(q[0]);
  }
  template <int width>
  void vary(const Slope& slope, const double* x, const double*, double* w) const {
    for (int j = 0; j < width; ++j) w[j] = slope.qq * x[j];
  }
};

/// ∂q''/∂q of two coordinates, symmetric.
struct PlaneSlope {
  double xx, xy, yy;

  template <int width>
  void apply(const double* x, double* w) const {
    for (int j = 0; j < width; ++j) {
      w[j] = xx * x[j] + xy * x[width + j];
      w[width + j] = xy * x[j] + yy * x[width + j];
    }
  }
};

/// q'' = −μ q/r³.
struct Kepler : FewCoordinates<2> {
  static constexpr bool velocity_free = true;
  using Slope = PlaneSlope;
  double mu;

  static Slope slope() { return {}; }
  explicit Kepler(const double* p) : mu(p[0]) {}

  void acceleration(const double* q, const double*, double* a, Slope* slope) const {
    const double x = q[0], y = q[1];
    const double square = x * x + y * y, inverse = 1 / square;
    const double pull = mu * inverse * inverse * std::sqrt(square);
    a[0] = -pull * x;
    a[1] = -pull * y;
    if (!slope) return;
    const double tide = 3 * pull * inverse;
    *slope = {tide * x * x - pull, tide * x * y, tide * y * y - pull};
  }
  template <int width>
  void vary(const Slope& slope, const double* x, const double*, double* w) const {
    slope.apply<width>(x, w);
  }
};

/// V = (x² + y²)/2 + k (x² y − y³/3).
struct HenonHeiles : FewCoordinates<2> {
  static constexpr bool velocity_free = true;
  using Slope = PlaneSlope;
  double coupling;

  static Slope slope() { return {}; }
  explicit HenonHeiles(const double* p) : coupling(p[0]) {}

  void acceleration(const double* q, const double*, double* a, Slope* slope) const {
    const double x = q[0], y = q[1];
    const double twice_x = 2 * coupling * x, twice_y = 2 * coupling * y;
    a[0] = -x - twice_x * y;
    a[1] = -y - coupling * (x * x - y * y);
    if (slope) *slope = {-1 - twice_y, -twice_x, -1 + twice_y};
  }
  template <int width>
  void vary(const Slope& slope, const double* x, const double*, double* w) const {
    slope.apply<width>(x, w);
  }
};

/// With d = a − b, I = (m1 + m2) l1², J = m2 l2², K = m2 l1 l2, P = (m1 + m2) g l1, Q = m2 g l2:
///   I a'' + K cos d b'' = −K sin d b'² − P sin a,
///   K cos d a'' + J b'' =  K sin d a'² − Q sin b.
struct DoublePendulum : FewCoordinates<2> {
  static constexpr bool velocity_free = false;
  struct Slope {
    std::array<double, 8> row;  ///< ∂a''/∂(a, b, a', b'), ∂b''/∂(a, b, a', b')
  };
  double inertia_a, inertia_b, coupling, weight_a, weight_b;

  static Slope slope() { return {}; }
  /// m1, m2, l1, l2, g
  explicit DoublePendulum(const double* p)
      : inertia_a((p[0] + p[1]) * p[2] * p[2]),
        inertia_b(p[1] * p[3] * p[3]),
        coupling(p[1] * p[2] * p[3]),
        weight_a((p[0] + p[1]) * p[4] * p[2]),
        weight_b(p[1] * p[4] * p[3]) {}

  void acceleration(const double* q, const double* v, double* a, Slope* slope) const {
    const double sin_a = std::sin(q[0]), cos_a = std::cos(q[0]);
    const double sin_b = std::sin(q[1]), cos_b = std::cos(q[1]);
    const double c = coupling * (cos_a * cos_b + sin_a * sin_b);
    const double s = coupling * (sin_a * cos_b - cos_a * sin_b);
    const double inverse = 1 / (inertia_a * inertia_b - c * c);
    const double f = -s * v[1] * v[1] - weight_a * sin_a, g = s * v[0] * v[0] - weight_b * sin_b;
    a[0] = inverse * (inertia_b * f - c * g);
    a[1] = inverse * (inertia_a * g - c * f);
    if (!slope) return;
    // M ∂q'' = ∂(f, g) − ∂M q'', where ∂c/∂a = −s and ∂c/∂b = s.
    const double f_d = s * a[1] - c * v[1] * v[1], g_d = s * a[0] + c * v[0] * v[0];
    const double f_a = f_d - weight_a * cos_a, g_b = -g_d - weight_b * cos_b;
    const double f_v = -2 * s * v[1], g_v = 2 * s * v[0];
    slope->row = {inverse * (inertia_b * f_a - c * g_d),
                  inverse * (-inertia_b * f_d - c * g_b),
                  -inverse * c * g_v,
                  inverse * inertia_b * f_v,
                  inverse * (inertia_a * g_d - c * f_a),
                  inverse * (inertia_a * g_b + c * f_d),
                  inverse * inertia_a * g_v,
                  -inverse * c * f_v};
  }
  template <int width>
  void vary(const Slope& slope, const double* x, const double* y, double* w) const {
    const auto& d = slope.row;
    for (int j = 0; j < width; ++j) {
      w[j] = d[0] * x[j] + d[1] * x[width + j] + d[2] * y[j] + d[3] * y[width + j];
      w[width + j] = d[4] * x[j] + d[5] * x[width + j] + d[6] * y[j] + d[7] * y[width + j];
    }
  }
};

/// In the rotating frame, primaries at −μ and 1 − μ:
///   U = (x² + y²)/2 + (1 − μ)/r1 + μ/r2,   x'' = 2 y' + ∂U/∂x, y'' = −2 x' + ∂U/∂y, z'' = ∂U/∂z.
struct RestrictedThreeBody : FewCoordinates<3> {
  static constexpr bool velocity_free = false;
  struct Slope {
    double xx, xy, yy, xz, yz, zz;
  };
  double mu;

  static Slope slope() { return {}; }
  explicit RestrictedThreeBody(const double* p) : mu(p[0]) {}

  void acceleration(const double* q, const double* v, double* a, Slope* slope) const {
    const double x1 = q[0] + mu, x2 = x1 - 1, y = q[1], z = q[2];
    const double aside = y * y + z * z;
    const double square1 = x1 * x1 + aside, square2 = x2 * x2 + aside;
    const double inverse1 = 1 / square1, inverse2 = 1 / square2;
    const double pull1 = (1 - mu) * inverse1 * inverse1 * std::sqrt(square1);
    const double pull2 = mu * inverse2 * inverse2 * std::sqrt(square2);
    const double pull = pull1 + pull2;
    a[0] = 2 * v[1] + q[0] - pull1 * x1 - pull2 * x2;
    a[1] = -2 * v[0] + y - pull * y;
    a[2] = -pull * z;
    if (!slope) return;
    const double tide1 = 3 * pull1 * inverse1, tide2 = 3 * pull2 * inverse2;
    const double tide = tide1 + tide2, along = tide1 * x1 + tide2 * x2;
    *slope = {1 - pull + tide1 * x1 * x1 + tide2 * x2 * x2,
              along * y,
              1 - pull + tide * y * y,
              along * z,
              tide * y * z,
              tide * z * z - pull};
  }
  template <int width>
  void vary(const Slope& s, const double* x, const double* y, double* w) const {
    for (int j = 0; j < width; ++j) {
      const double dx = x[j], dy = x[width + j], dz = x[2 * width + j];
      w[j] = s.xx * dx + s.xy * dy + s.xz * dz + 2 * y[width + j];
      w[width + j] = s.xy * dx + s.yy * dy + s.yz * dz - 2 * y[j];
      w[2 * width + j] = s.xz * dx + s.yz * dy + s.zz * dz;
    }
  }
};

}  // namespace bench::shooting
