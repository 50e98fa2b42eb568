#include "problem/rest_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Matrix = Eigen::MatrixXd;

/// For difference quotients in time, in units of the time since zero.
constexpr double time_step = 1e-6;
constexpr int most_newton_steps = 30;
constexpr double newton_goal = 1e-14;
/// Exponents whose real part is smaller, relative to the largest exponent, are imaginary: a double zero
/// splits by the square root of roundoff.
constexpr double imaginary = 1e-7;
constexpr int most_sign_steps = 100;
constexpr double sign_goal = 1e-14;
/// Exponents that a message lists.
constexpr int most_listed = 12;

Matrix square_matrix(const std::vector<double>& rows, Eigen::Index n) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(rows.data(), n, n);
}

/// L and its derivatives at rest.
class AtRest {
 public:
  AtRest(const Lagrangian& lagrangian, double t) : lagrangian_(lagrangian), t_(t) {}
  PointValues operator()(const Eigen::VectorXd& q) { return later(q, 0); }
  /// By so many units of time.
  PointValues later(const Eigen::VectorXd& q, double by) {
    const std::vector<double> rest(q.size(), 0);
    return evaluate_at(lagrangian_, {q.data(), static_cast<std::size_t>(q.size())}, rest,
                       t_ + by * time_unit(), Order::hessian, scratch_);
  }
  double time_unit() const { return t_ != 0 ? std::abs(t_) : 1; }

 private:
  const Lagrangian& lagrangian_;
  double t_;
  Scratch scratch_;
};

/// sign(A) by Newton's iteration with scaling by the determinant (Roberts, Int. J. Control 32 (1980) 677):
/// the eigenvalues become the signs of their real parts. Empty where it does not converge.
Matrix matrix_sign(Matrix a) {
  const double size = static_cast<double>(a.rows());
  bool scaled = true;
  for (int k = 0; k < most_sign_steps; ++k) {
    const Eigen::PartialPivLU<Matrix> lu(a);
    const Matrix inverse = lu.solve(Matrix::Identity(a.rows(), a.rows()));
    if (!inverse.allFinite()) return {};
    const double logarithm = lu.matrixLU().diagonal().array().abs().log().sum() / size;
    const double scale = scaled ? std::exp(-logarithm) : 1;
    const Matrix next = 0.5 * (scale * a + inverse / scale);
    const double change = (next - a).norm();
    a = next;
    if (change <= sign_goal * size * a.norm()) return a;
    if (change <= 1e-2 * a.norm()) scaled = false;
  }
  return {};
}

/// P of the invariant subspace (q, P q) on which sign(A) = −side.
Matrix graph(const Matrix& sign, double side) {
  const Eigen::Index n = sign.rows() / 2;
  Matrix projector = sign;  // (sign + side I) (I; P) = 0
  projector.diagonal().array() += side;
  const Matrix left = projector.rightCols(n), right = -projector.leftCols(n);
  const Eigen::ColPivHouseholderQR<Matrix> qr(left);
  if (qr.rank() < n) return {};
  const Matrix p = qr.solve(right);
  return 0.5 * (p + p.transpose());
}

/// What masses and gyroscopic terms that change in time add to linear_motion(): with η'' they are
/// Mη'' + (Ṁ + C − Cᵀ)η' + (Ċ − K)η = 0, so that exp(ct) L has the rates of damped motions. π is Mη' + Cη
/// with M and C of this time.
Matrix drift(AtRest& at, const Eigen::VectorXd& q, const PointValues& values) {
  const Eigen::Index n = q.size();
  const PointValues after = at.later(q, time_step), before = at.later(q, -time_step);
  const double lapse = 2 * time_step * at.time_unit();
  const Matrix mass_rate = (square_matrix(after.vv, n) - square_matrix(before.vv, n)) / lapse,
               mixed_rate = (square_matrix(after.vq, n) - square_matrix(before.vq, n)) / lapse,
               damping = mass_rate * solved(square_matrix(values.vv, n), Matrix::Identity(n, n));
  Matrix added = Matrix::Zero(2 * n, 2 * n);
  added.bottomRows(n) << damping * square_matrix(values.vq, n) - mixed_rate, -damping;
  return added;
}

/// A power of two.
double unit_of_mass(const PointValues& values) {
  const Eigen::Map<const Eigen::ArrayXd> masses(values.vv.data(), std::ssize(values.vv));
  return std::exp2(std::round(std::log2(masses.abs().maxCoeff())));
}

/// linear_motion() with what changes in time, momenta in units of the mass, which may be of any size.
Matrix motion_about(const Lagrangian& lagrangian, AtRest& at, const Eigen::VectorXd& q,
                    const PointValues& values) {
  const Eigen::Index n = q.size();
  Matrix a = linear_motion(values, n);
  if (!lagrangian.structure().autonomous) a += drift(at, q, values);
  a.topRightCorner(n, n) *= unit_of_mass(values);
  a.bottomLeftCorner(n, n) /= unit_of_mass(values);
  return a;
}

double least_real_part(const Eigen::VectorXcd& exponents) { return exponents.real().cwiseAbs().minCoeff(); }

}  // namespace

Matrix linear_motion(const PointValues& values, Eigen::Index n) {
  const Matrix c = square_matrix(values.vq, n),
               inverse = solved(square_matrix(values.vv, n), Matrix::Identity(n, n)), slope = inverse * c;
  Matrix a(2 * n, 2 * n);
  a << -slope, inverse, square_matrix(values.qq, n) - c.transpose() * slope, slope.transpose();
  return a;
}

/// Of Mη'' = Kη + (Cᵀ − C)η', or of first order where there are no masses, as in phase space.
Eigen::VectorXcd exponents_of_motion(const Lagrangian& lagrangian, std::span<const double> q,
                                     bool two_copies) {
  const auto all = std::ssize(q), n = two_copies ? all / 2 : all;
  const PointValues values = AtRest(lagrangian, 0)(Eigen::Map<const Eigen::VectorXd>(q.data(), all));
  // Equations are derivatives by the first copy, motions those of both.
  const auto of_one = [&](const Matrix& both) -> Matrix {
    return two_copies ? both.topLeftCorner(n, n) + both.topRightCorner(n, n) : both;
  };
  const Matrix c = square_matrix(values.vq, all), m = of_one(square_matrix(values.vv, all)),
               k = of_one(square_matrix(values.qq, all)), slope = of_one(c.transpose()) - of_one(c);
  Matrix a;
  if (m.isZero(0)) {
    a = -solved(slope, k);
  } else {
    a = Matrix::Zero(2 * n, 2 * n);
    a.topRightCorner(n, n).setIdentity();
    a.bottomRows(n) << solved(m, k), solved(m, slope);
  }
  if (!a.allFinite()) return Eigen::VectorXcd::Constant(a.rows(), NAN);
  return general_eigenvalues(a);
}

double slowest_rate(const Lagrangian& lagrangian, std::span<const double> q, double t) {
  const Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(q.data(), std::ssize(q));
  AtRest at(lagrangian, t);
  const Matrix a = motion_about(lagrangian, at, point, at(point));
  return a.allFinite() ? least_real_part(general_eigenvalues(a)) : NAN;
}

RestPoint rest_point(const Lagrangian& lagrangian, std::span<const double> near, double t) {
  const auto n = static_cast<Eigen::Index>(near.size());
  const Eigen::VectorXd given = Eigen::Map<const Eigen::VectorXd>(near.data(), n);
  AtRest at(lagrangian, t);
  Eigen::VectorXd q = given;
  PointValues values = at(q);
  const auto force = [&] { return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.dq.data(), n)); };
  RestPoint rest;
  rest.force = force().cwiseAbs().maxCoeff();
  if (!std::isfinite(values.value) || !force().allFinite() || !square_matrix(values.qq, n).allFinite() ||
      !square_matrix(values.vv, n).allFinite() || !square_matrix(values.vq, n).allFinite())
    throw std::invalid_argument("L or a derivative of it is not finite at rest there");
  rest.distance = INFINITY;
  const double size = std::max(given.cwiseAbs().maxCoeff(), 1e-300);
  for (int k = 0; k < most_newton_steps; ++k) {
    const Eigen::VectorXd step = least_norm(square_matrix(values.qq, n), -force());
    if (!step.allFinite() || force().isZero(0)) {
      if (force().isZero(0)) rest.distance = (q - given).cwiseAbs().maxCoeff();
      break;
    }
    q += step;
    values = at(q);
    if (!force().allFinite() || !square_matrix(values.qq, n).allFinite()) break;
    if (step.cwiseAbs().maxCoeff() > newton_goal * size) continue;
    rest.distance = (q - given).cwiseAbs().maxCoeff();
    break;
  }
  if (!std::isfinite(rest.distance)) {
    q = given;
    values = at(q);
  }
  rest.q.assign(q.begin(), q.end());
  rest.momentum = values.dv;
  rest.value = values.value;
  rest.stiffness = square_matrix(values.qq, n).cwiseAbs().maxCoeff();
  const Matrix a = motion_about(lagrangian, at, q, values);
  if (!a.allFinite()) throw std::invalid_argument("the mass matrix ∂²L/∂q'∂q' is singular at rest there");
  rest.exponents = general_eigenvalues(a);
  rest.slowest = least_real_part(rest.exponents);
  rest.slowest_in = rest.slowest_out = INFINITY;
  for (const std::complex<double>& x : rest.exponents) {
    double& slowest = x.real() < 0 ? rest.slowest_in : rest.slowest_out;
    slowest = std::min(slowest, std::abs(x.real()));
  }
  rest.hyperbolic = rest.slowest > imaginary * rest.exponents.cwiseAbs().maxCoeff();
  if (!rest.hyperbolic) return rest;
  const Matrix sign = matrix_sign(a);
  if (sign.size() == 0) return rest;
  rest.stable = unit_of_mass(values) * graph(sign, 1);
  rest.unstable = unit_of_mass(values) * graph(sign, -1);
  return rest;
}

EndCost cost_to(const RestPoint& rest, bool at_end) {
  const std::size_t n = rest.q.size();
  const Matrix& subspace = at_end ? rest.stable : rest.unstable;
  const double sign = at_end ? -1 : 1;
  EndCost cost{rest.q, rest.momentum, std::vector<double>(n * n)};
  for (double& p : cost.slope) p *= sign;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      cost.stiffness[a * n + b] = sign * subspace(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  return cost;
}

std::string exponents_text(const RestPoint& rest) {
  std::string text;
  int listed = 0;
  for (const std::complex<double>& x : rest.exponents) {
    if (x.imag() < 0) continue;
    if (listed++ == most_listed) return text + ", …";
    if (!text.empty()) text += ", ";
    const double negligible = 1e-9 * rest.exponents.cwiseAbs().maxCoeff();
    const bool real = std::abs(x.imag()) <= negligible, turning = std::abs(x.real()) <= negligible;
    if (real)
      text += fmt::format("{:.6g}", turning ? 0.0 : x.real());
    else if (turning)
      text += fmt::format("±{:.6g}i", x.imag());
    else
      text += fmt::format("{:.6g} ± {:.6g}i", x.real(), x.imag());
  }
  return text;
}

}  // namespace extremal
