#include "analysis/jacobi.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/falling_form.hpp"
#include "analysis/limits.hpp"
#include "linear/dense.hpp"
#include "linear/equilibration.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

using namespace limits::jacobi;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Cholesky's pivots against the diagonal: below, a conjugate time may be near and X near singular.
constexpr double calm = 1e-3;
/// Largest entry of W, in the units of a piece, for which it stands for the fields.
constexpr double moderate = 1e3;
/// Eigenvalues within this of zero at the end of a piece are zero there.
constexpr double at_end = 1e-12;
/// Of a conjugate time, as a fraction of its piece.
constexpr double resolution = 1e-13;

MatrixXd even(const MatrixXd& m) { return (m + m.transpose()) / 2; }

/// Of momenta over coordinates, square roots: those in which the rows of A, B, D have entries of at most
/// about 1.
VectorXd units(const Piece& piece) {
  return equilibration(piece.a.cwiseAbs() + piece.b.cwiseAbs() + piece.b.transpose().cwiseAbs() +
                       piece.d.cwiseAbs());
}

/// A zero of f between `low` and `high`, where f has the values given, of opposite signs: the method of Brent
/// (Algorithms for Minimization without Derivatives, 4.2).
template <class F>
double zero(F f, double a, double fa, double b, double fb, double tolerance) {
  double c = a, fc = fa, step = b - a, before = step;
  for (;;) {
    if (std::abs(fc) < std::abs(fb)) {
      a = std::exchange(b, c), c = a;
      fa = std::exchange(fb, fc), fc = fa;
    }
    const double middle = 0.5 * (c - b);
    if (fb == 0 || std::abs(middle) <= tolerance) return b;
    if (std::abs(before) < tolerance || std::abs(fa) <= std::abs(fb)) {
      step = before = middle;
    } else {
      const double s = fb / fa, q = a == c ? 1 : fa / fc, r = a == c ? 0 : fb / fc;
      double p = a == c ? 2 * middle * s : s * (2 * middle * q * (q - r) - (b - a) * (r - 1));
      double d = a == c ? 1 - s : (q - 1) * (r - 1) * (s - 1);
      p > 0 ? d = -d : p = -p;
      const bool good = 2 * p < std::min(3 * middle * d - std::abs(tolerance * d), std::abs(before * d));
      before = good ? std::exchange(step, p / d) : (step = middle);
    }
    a = b, fa = fb;
    b += std::abs(step) > tolerance ? step : std::copysign(tolerance, middle);
    fb = f(b);
    if ((fb > 0) == (fc > 0)) {
      c = a, fc = fa;
      step = before = b - a;
    }
  }
}

}  // namespace

/// The fields are those with x_a = I (x_b = I) where `tau` is nearer the end (start), and so far from zero.
void JacobiFields::begin(SecondVariation& variation, int k, double tau) {
  variation.hold(k);
  const Piece piece = variation.piece(k);
  vanishing_ = 0;
  normalised_ = tau < 0.5;
  if (tau == 0) {
    p_ = piece.d;
    return;
  }
  if (variation.coordinates() >= least_large && variation.has_part_forms()) {
    normalised_ = true;
    p_ = variation.end_form(k, tau);
    return;
  }
  variation.fields(k, tau, from_start_, from_end_);
  if (normalised_) {
    p_ = even(piece.d - piece.b * solved(from_start_, from_end_));
    return;
  }
  x_ = -solved(from_end_, from_start_);
  p_ = piece.b + piece.d * x_;
}

const std::vector<double>& JacobiFields::advance(SecondVariation& variation, int k, bool first_only) {
  variation.hold(k);
  const Piece piece = variation.piece(k);
  times_.clear();
  if (normalised_ && piece.a.rows() >= least_large && !variation.of_scheme()) {
    if (advance_large(variation, k, first_only)) return times_;
    variation.hold(k);
  }
  if (normalised_ && step(piece)) return times_;
  split(piece);
  whole_ = form(variation, k, 1);
  eigenvalues_ = symmetric_eigenvalues(whole_);
  const int inside = static_cast<int>((eigenvalues_.array() < -at_end).count());
  const int reached = static_cast<int>((eigenvalues_.array() <= at_end).count());
  find(variation, k, first_only ? std::min(inside, 1) : inside);
  times_.insert(times_.end(), reached - inside, 1.0);
  carry(piece);
  vanishing_ = reached - inside;
  if (vanishing_ > 0) normalised_ = false;
  return times_;
}

/// W at the end is D − B (W + A)⁻¹ Bᵀ; false if W + A is not safely positive definite.
bool JacobiFields::step(const Piece& piece) {
  whole_ = p_ + piece.a;
  cholesky_.compute(whole_);
  if (cholesky_.info() != Eigen::Success) return false;
  const auto pivots = cholesky_.matrixLLT().diagonal().array().square();
  const auto scale = piece.a.diagonal().array().abs() + piece.b.diagonal().array().abs();
  if (!(pivots >= calm * scale).all()) return false;
  next_ = piece.b.transpose();
  cholesky_.matrixL().solveInPlace(next_);
  p_ = piece.d;
  p_.noalias() -= next_.transpose() * next_;
  return true;
}

/// As step(), also past conjugate times in the piece: W + A has as many negative eigenvalues. False if its
/// pivots lose digits, as where one is near the end of the piece.
bool JacobiFields::advance_large(SecondVariation& variation, int k, bool first_only) {
  if (!elimination_) elimination_.emplace();
  const Piece piece = variation.piece(k);
  const int n = static_cast<int>(piece.a.rows());
  whole_ = p_ + piece.a;
  elimination_->resize(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      elimination_->pivot_row(i)[j] = whole_(j, i);
      elimination_->rest_row(i)[j] = piece.d(j, i);
    }
  }
  for (int columns = 0; columns < n; columns += most_lanes)  // few rows of B at a time
    for (int i = 0; i < n; ++i)
      for (int j = columns; j < std::min(columns + most_lanes, n); ++j)
        elimination_->coupled_row(i)[j] = piece.b(j, i);
  if (!elimination_->eliminate()) return false;
  MatrixXd next(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) next(i, j) = next(j, i) = elimination_->rest_row(i)[j];
  if (const int count = elimination_->inertia().negative; count > 0) {
    work_left_ -= first_only ? 0 : double(count) * n * n * n;
    if (given_up()) return true;
    const VectorXd inverse = units(piece).cwiseInverse();
    const auto in_units = [&](const MatrixXd& m) -> MatrixXd {
      return inverse.asDiagonal() * m * inverse.asDiagonal();
    };
    const MatrixXd last = in_units(whole_);
    std::vector<MatrixXd> samples = variation.start_forms(k, FallingForm::points());
    for (MatrixXd& sample : samples) sample = in_units(p_ + sample);
    const std::optional<FallingForm> form = FallingForm::of(0, 1, 0, std::move(samples), last);
    std::optional<std::vector<double>> zeros;
    if (form) zeros = form->zeros(count, first_only);
    if (!zeros) return false;
    times_ = *std::move(zeros);
  }
  p_ = std::move(next);
  return true;
}

/// As distance(), by the eigenvalues of W + A(tau) nearest zero; nothing where one is zero.
std::optional<double> JacobiFields::distance_large(SecondVariation& variation, int k, double step) {
  if (!elimination_) elimination_.emplace();
  const Piece piece = variation.piece(k);
  const int n = static_cast<int>(piece.a.rows());
  const VectorXd inverse = units(piece).cwiseInverse();
  const auto in_units = [&](const MatrixXd& m) -> MatrixXd {
    return inverse.asDiagonal() * m * inverse.asDiagonal();
  };
  const MatrixXd last = in_units(p_ + piece.a);
  MatrixXd space(n, end_vectors);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < end_vectors; ++j) space(i, j) = std::cos(1 + 2.4 * i + 1.3 * i * j);
  for (int iteration = 0; iteration < end_steps; ++iteration) {
    elimination_->resize(n, end_vectors);
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) elimination_->pivot_row(i)[j] = last(j, i);
      for (int j = 0; j < end_vectors; ++j) elimination_->coupled_row(i)[j] = space(i, j);
    }
    if (!elimination_->eliminate()) return std::nullopt;
    elimination_->substitute();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < end_vectors; ++j) space(i, j) = elimination_->coupled_row(i)[j];
    space = extremal::orthonormal(space);
  }
  const double before = 1 - step;
  const MatrixXd earlier = in_units(p_ + variation.start_forms(k, {&before, 1})[0]);
  const SymmetricEigen ends = symmetric_eigen(space.transpose() * last * space);
  double nearest = INFINITY;
  for (int j = 0; j < end_vectors; ++j) {
    const VectorXd x = space * ends.vectors.col(j);
    nearest = std::min(nearest, std::abs(step * ends.values[j] / (x.dot(earlier * x) - ends.values[j])));
  }
  return nearest;
}

/// An orthonormal basis of the span, X above P, with coordinates in `unit`.
MatrixXd JacobiFields::orthonormal(const VectorXd& unit) const {
  const auto n = unit.size();
  MatrixXd both(2 * n, n);
  both.topRows(n) = unit.asDiagonal() * (normalised_ ? MatrixXd::Identity(n, n) : x_);
  both.bottomRows(n) = unit.cwiseInverse().asDiagonal() * p_;
  both.colwise().normalize();
  return extremal::orthonormal(both);
}

double JacobiFields::distance(SecondVariation& variation, int k) {
  constexpr double step = 0.01, far = 0.05;
  variation.hold(k);
  if (normalised_ && variation.coordinates() >= least_large && !variation.of_scheme()) {
    if (const std::optional<double> nearest = distance_large(variation, k, step)) return *nearest;
    variation.hold(k);
  } else if (normalised_) {
    const Piece piece = variation.piece(k);
    const VectorXd inverse = units(piece).cwiseInverse();
    const MatrixXd scaled = inverse.asDiagonal() * (p_ + piece.a) * inverse.asDiagonal();
    if (symmetric_eigenvalues(scaled).cwiseAbs().minCoeff() > far) return INFINITY;
  }
  split(variation.piece(k));
  const VectorXd last = symmetric_eigenvalues(form(variation, k, 1)),
                 before = symmetric_eigenvalues(form(variation, k, 1 - step));
  double nearest = INFINITY;
  for (Eigen::Index i = 0; i < last.size(); ++i)
    nearest = std::min(nearest, std::abs(step * last[i] / (before[i] - last[i])));
  return nearest;
}

/// An orthonormal basis of the span, in units in which A has a diagonal of 1, and the singular values of its
/// X. Where they are small that part of the form is divided by them, so that the form stays of order 1.
void JacobiFields::split(const Piece& piece) {
  const int n = static_cast<int>(piece.a.rows());
  unit_ = units(piece);
  const MatrixXd both = orthonormal(unit_);
  const SingularValues svd = singular_value_decomposition(both.topRows(n));
  x_ = unit_.cwiseInverse().asDiagonal() * both.topRows(n);
  p_ = unit_.asDiagonal() * both.bottomRows(n);
  normalised_ = false;
  const int r = n - vanishing_;
  const VectorXd root = svd.values.head(r).cwiseSqrt();
  range_ = svd.u.leftCols(r) * root.asDiagonal();
  share_ = svd.u.leftCols(r).transpose() * both.bottomRows(n) * svd.v.leftCols(r);
  // Σ UᵀPV is symmetric: of two mirrored entries, the one in the row of the smaller singular value is exact.
  for (int i = 0; i < r; ++i)
    for (int j = 0; j <= i; ++j)
      share_(i, j) = share_(j, i) = share_(i, j) * (root[j] > 0 ? root[i] / root[j] : 0);
}

/// Xᵀ(P + A(tau) X) on the range of X.
MatrixXd JacobiFields::form(SecondVariation& variation, int k, double tau) {
  const Piece piece = variation.piece(k);
  MatrixXd a = piece.a;
  if (tau < 1) {
    variation.fields(k, tau, from_start_, from_end_);
    a -= piece.b.transpose() * solved(from_end_, from_start_);
  }
  const VectorXd inverse = unit_.cwiseInverse();
  return share_ + range_.transpose() * even(inverse.asDiagonal() * a * inverse.asDiagonal()) * range_;
}

/// Eigenvalues times tau, which at first is about the form A of the piece.
void JacobiFields::find(SecondVariation& variation, int k, int count) {
  if (count == 0) return;
  const double first = std::max(symmetric_eigenvalues(whole_ - share_)[0], at_end);
  samples_.clear();
  samples_.push_back({0, VectorXd::Constant(eigenvalues_.size(), first)});
  samples_.push_back({1, eigenvalues_});
  for (int i = 0; i < count; ++i) times_.push_back(time_of_zero(variation, k, i));
  std::sort(times_.begin(), times_.end());
}

/// Where eigenvalue `index` is zero; what is evaluated on the way brackets those that follow.
double JacobiFields::time_of_zero(SecondVariation& variation, int k, int index) {
  const Sample *low = &samples_.front(), *high = &samples_[1];
  for (const Sample& sample : samples_) {
    const bool before = sample.values[index] > 0;
    if (before && sample.tau > low->tau) low = &sample;
    if (!before && sample.tau < high->tau) high = &sample;
  }
  const double from = low->tau, to = high->tau, value_from = low->values[index],
               value_to = high->values[index];
  const auto value = [&](double tau) {
    samples_.push_back({tau, tau * symmetric_eigenvalues(form(variation, k, tau))});
    return samples_.back().values[index];
  };
  return zero(value, from, value_from, to, value_to, resolution);
}

/// The fields at the end: B⁻ᵀ(P + A X) = −X there.
void JacobiFields::carry(const Piece& piece) {
  const MatrixXd next = -solved(piece.b.transpose(), p_ + piece.a * x_);
  p_ = (piece.b * x_ + piece.d * next).eval();
  x_ = next;
  const MatrixXd w = solved(x_.transpose(), p_.transpose());
  const VectorXd inverse = units(piece).cwiseInverse();
  normalised_ = (inverse.asDiagonal() * w * inverse.asDiagonal()).cwiseAbs().maxCoeff() < moderate;
  if (normalised_) p_ = even(w);
}

}  // namespace extremal
