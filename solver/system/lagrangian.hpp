#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

/// \file What the discrete action sees of a system: a Lagrangian evaluated over a batch of points, and
/// what is known of its structure. Formulas and C++ functors implement it through the tape; a
/// Lagrangian that cannot be traced may implement it directly.

struct dd_real;

namespace extremal {

/// An entry of a symmetric or general matrix.
struct Triplet {
  int row, column;
  double value;
};

/// An entry of the Hessian in z = (q_0 … q_{n-1}, q'_0 … q'_{n-1}), row >= column.
struct HessianEntry {
  int row, column;
};

/// What holds for L(q, q', t) at every point.
///
/// Where all second derivatives with a velocity are constant,
///   L = ½ q'ᵀ M q' + q'ᵀ C q + aᵀ q' + R(q, t),
/// the quadratic part stands here as numbers and only R is evaluated. Otherwise M, C, a are empty
/// and R = L. In both cases R is called the remainder.
struct Structure {
  int coordinates = 0;
  int parameters = 0;                 ///< active parameters: those that derivatives are asked for
  bool autonomous = true;             ///< L does not depend on t
  bool harmonic = true;               ///< t stands only in sin, cos and tan of α t + β(q, q')
  bool pulses = false;                ///< forces may act in pulses without tails, as exp(−x²)
  std::vector<double> frequencies;    ///< |α| of sin, cos and tan, ascending, unique
  bool quadratic = false;             ///< the form above holds
  std::vector<Triplet> mass;          ///< M, both triangles
  std::vector<Triplet> gyroscopic;    ///< C(row of q', column of q)
  std::vector<double> linear;         ///< a, or empty
  bool velocity_free = false;         ///< the remainder does not depend on q'
  bool first_order = false;           ///< of a system in phase space, see phase_space.hpp
  std::vector<int> gradient;          ///< indices z with a gradient row of the remainder, ascending
  std::vector<HessianEntry> hessian;  ///< entries with a Hessian row, sorted by (row, column), unique
};

enum class Order { value, gradient, hessian };

/// A batch of points, structure of arrays: coordinate a at point i is q[a*stride + i]; every row starts
/// at a multiple of 64 bytes. `count` is a multiple of simd_lanes(). `v` may be null where the remainder is
/// velocity_free, `t` where the system is autonomous.
struct Points {
  int count = 0;
  std::ptrdiff_t stride = 0;
  const double* q = nullptr;
  const double* v = nullptr;
  const double* t = nullptr;
};

/// Memory that an evaluation needs; one for each thread, reused between calls.
struct Scratch {
  std::vector<double> memory;
  std::vector<double*> operands;
  std::vector<double> point;             ///< of evaluate_at()
  double* reserve(std::size_t doubles);  ///< 64-byte aligned; contents undefined
};

/// The same for one point in numbers of another kind.
template <class Number>
struct PointScratch {
  std::vector<Number> memory;
  std::vector<Number*> operands;
};

/// With 64 bits, and with 106 as a sum of two (Hida, Li and Bailey, ARITH-15 (2001) 155).
using Extended = long double;
using DoubleDouble = dd_real;

class Kinks;

/// Immutable once made; evaluation may run in several threads, each with its own Scratch.
class Lagrangian {
 public:
  virtual ~Lagrangian() = default;

  const Structure& structure() const { return structure_; }

  /// Where L is not smooth; null where it is.
  virtual const Kinks* kinks() const { return nullptr; }

  /// Rows of the remainder at each point: out[k*stride + i] with k = 0 the value, then one row for each
  /// structure().gradient (from Order::gradient on), then one for each structure().hessian.
  /// `out` has the stride of the points.
  virtual void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const = 0;

  /// Rows ∂R/∂p, then ∂²R/∂z∂p for each structure().gradient, at each point.
  /// Rows of M, C, a never depend on an active parameter.
  virtual void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const = 0;

  /// The rows of Order::gradient at one point (n coordinates, n velocities, time), in extended precision.
  /// Numbers of the system itself are as they were rounded to double. False, and nothing is written, where
  /// that is not known.
  virtual bool evaluate_extended(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                                 PointScratch<Extended>& scratch) const {
    (void)q, (void)v, (void)t, (void)out, (void)scratch;
    return false;
  }
  virtual bool evaluate_extended(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                                 DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const {
    (void)q, (void)v, (void)t, (void)out, (void)scratch;
    return false;
  }

  /// The same with other values of the active parameters, where it was made for that. Null where values
  /// cannot be put in.
  virtual std::shared_ptr<const Lagrangian> with(std::span<const double> parameters) const {
    (void)parameters;
    return nullptr;
  }

  int rows(Order order) const {
    const int g = static_cast<int>(structure_.gradient.size()),
              h = static_cast<int>(structure_.hessian.size());
    return order == Order::value ? 1 : order == Order::gradient ? 1 + g : 1 + g + h;
  }

 protected:
  Structure structure_;
};

/// The whole L with its derivatives at one point: for guesses, checks and sampled output, not for the
/// inner loop. Vectors have n entries; matrices are n × n, row-major.
struct PointValues {
  double value = 0;
  std::vector<double> dq, dv;
  std::vector<double> qq, vq, vv;  ///< vq(row of q', column of q)
};
PointValues evaluate_at(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
                        double t, Order order, Scratch& scratch);

}  // namespace extremal
