#include "problem/symmetry.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "problem/closing.hpp"
#include "problem/problem.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Singular values below this, relative, are zero: entries are good to roundoff.
constexpr double null = 1e-9;
/// Points beyond as many as there are unknowns, and how many may be lost where L is not finite.
constexpr int spare_points = 8, most_tries = 4;

/// What the coordinates extend over along the guess, all alike; and points about it.
class Cloud {
 public:
  explicit Cloud(const Problem& problem) : problem_(problem), n_(problem.coordinates()) {
    VectorXd q(n_), low = VectorXd::Constant(n_, INFINITY), high = -low;
    for (int k = 0; k <= 32; ++k) {
      at(k / 32.0, q);
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    extent_ = (high - low).maxCoeff();
    if (!(extent_ > 0)) extent_ = std::max(1.0, high.cwiseAbs().maxCoeff());
  }
  double extent() const { return extent_; }

  void draw(VectorXd& q, VectorXd& v) {
    at(0.5 + 0.5 * number(), q);
    for (int a = 0; a < n_; ++a) {
      q[a] += 0.1 * extent_ * number();
      v[a] = 2 * extent_ / problem_.duration.value * number();
    }
  }

 private:
  double number() { return 2.0 * random_() / std::minstd_rand::max() - 1; }
  void at(double tau, VectorXd& q) const {
    q.setZero(n_);
    if (problem_.guess.given()) problem_.guess.at(tau, {q.data(), std::size_t(n_)});
  }

  const Problem& problem_;
  int n_;
  double extent_ = 1;
  std::minstd_rand random_{7};
};

/// Linear equations for the unknowns: entries of G row by row, then c and b, both in units of the extent.
class Equations {
 public:
  Equations(const Problem& problem, const ClosingMap& closure)
      : n_(problem.coordinates()),
        matrices_(n_ <= most_coordinates_for_rotations ? n_ * n_ : 0),
        columns_(matrices_ + n_ + (closure.identity() ? n_ : 0)) {}

  /// Invariance of L at so many points; false if L is finite at too few.
  bool add_invariance(const Problem& problem, Cloud& cloud) {
    const int points = columns_ + spare_points;
    rows_.setZero(points, columns_);
    VectorXd q(n_), v(n_);
    Scratch scratch;
    const auto span = [&](const VectorXd& x) { return std::span(x.data(), std::size_t(n_)); };
    int found = 0;
    for (int tries = 0; found < points && tries < most_tries * points; ++tries) {
      cloud.draw(q, v);
      const PointValues at =
          evaluate_at(*problem.lagrangian, span(q), span(v), 0.1 * tries, Order::gradient, scratch);
      auto row = rows_.row(found);
      for (int a = 0; a < n_; ++a) {
        for (int b = 0; b < n_ && matrices_ > 0; ++b) row[a * n_ + b] = at.dq[a] * q[b] + at.dv[a] * v[b];
        row[matrices_ + a] = cloud.extent() * at.dq[a];
        if (matrices_ + n_ < columns_) row[matrices_ + n_ + a] = -cloud.extent() * v[a];
      }
      const double size = row.norm();
      if (!std::isfinite(size)) continue;
      if (size > 0) row /= size;
      ++found;
    }
    return found == points;
  }

  /// A path that is moved must close as before: R G = G R and R c = G shift + c.
  void add_closure(const ClosingMap& closure, double extent) {
    if (closure.identity()) return;
    const auto& r = closure.r;
    const int before = static_cast<int>(rows_.rows());
    rows_.conservativeResize(before + matrices_ + n_, columns_);
    rows_.bottomRows(matrices_ + n_).setZero();
    for (int a = 0; a < n_ && matrices_ > 0; ++a)
      for (int b = 0; b < n_; ++b)
        for (int k = 0; k < n_; ++k) {
          rows_(before + a * n_ + b, k * n_ + b) += r(a, k);
          rows_(before + a * n_ + b, a * n_ + k) -= r(k, b);
        }
    for (int a = 0; a < n_; ++a)
      for (int k = 0; k < n_; ++k) {
        rows_(before + matrices_ + a, matrices_ + k) += r(a, k) - (a == k);
        if (matrices_ > 0) rows_(before + matrices_ + a, a * n_ + k) -= closure.c[k] / extent;
      }
  }

  std::vector<Generator> solutions(double extent) const {
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> qr;
    qr.setThreshold(null).compute(rows_);
    const Eigen::Index rank = qr.rank();
    std::vector<Generator> result;
    for (Eigen::Index k = rank; k < columns_; ++k) {
      // A P = Q (T 0; 0 0) Z: the last rows of Z span the null space of A P.
      const VectorXd x = qr.colsPermutation() * qr.matrixZ().row(k).transpose();
      Generator generator;
      generator.matrix.assign(std::size_t(n_) * n_, 0);
      std::copy_n(x.data(), matrices_, generator.matrix.data());
      for (int a = 0; a < n_; ++a) generator.shift.push_back(extent * x[matrices_ + a]);
      result.push_back(std::move(generator));
    }
    return result;
  }

 private:
  int n_, matrices_, columns_;
  MatrixXd rows_;
};

}  // namespace

std::vector<Generator> continuous_symmetries(const Problem& problem) {
  const ClosingMap closure = closing_map(problem);
  if (!closure.r.allFinite()) return {};
  Cloud cloud(problem);
  Equations equations(problem, closure);
  if (!equations.add_invariance(problem, cloud)) return {};
  equations.add_closure(closure, cloud.extent());
  return equations.solutions(cloud.extent());
}

}  // namespace extremal
