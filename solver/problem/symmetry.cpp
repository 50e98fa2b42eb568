#include "problem/symmetry.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "linear/dense.hpp"
#include "problem/problem.hpp"
#include "system/kinks.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Singular values below this, relative, are zero: entries are good to roundoff.
constexpr double null = 1e-9;
/// Conditions at a path that is known to a tolerance are kept within this.
constexpr double kept = 1e-6;
/// Entries of a symmetry below this are zero: where it leaves a path as it is, roundoff would move it.
constexpr double negligible = 1e-12;
/// Points beyond as many as there are unknowns (twice as many where they are at several places), and how many
/// may be lost where L is not finite.
constexpr int spare_points = 8, most_tries = 8;

/// What the coordinates extend over along the guess, all alike; and points about it.
class Cloud {
 public:
  Cloud(const Problem& problem, const std::vector<double>& scales)
      : problem_(problem), scales_(scales), n_(problem.coordinates()) {
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
  std::size_t places() const { return scales_.size(); }

  void draw(VectorXd& q, VectorXd& v) {
    at(0.5 + 0.5 * number(), q);
    const double scale = scales_[drawn_++ % scales_.size()];
    for (int a = 0; a < n_; ++a) {
      q[a] = scale * (q[a] + 0.1 * extent_ * number());
      v[a] = scale * 2 * extent_ / problem_.duration.value * number();
    }
  }

  /// In [−1, 1].
  double number() { return 2.0 * random_() / std::minstd_rand::max() - 1; }

 private:
  void at(double tau, VectorXd& q) const {
    q.setZero(n_);
    if (problem_.guess.given()) problem_.guess.at(tau, {q.data(), std::size_t(n_)});
  }

  const Problem& problem_;
  const std::vector<double>& scales_;
  int n_;
  double extent_ = 1;
  std::minstd_rand random_{7};
  unsigned drawn_ = 0;
};

/// Linear equations for the unknowns: entries of G row by row, then c in units of the extent, and b in units
/// of momentum.
class Equations {
 public:
  Equations(const Problem& problem, int most_coordinates)
      : n_(problem.coordinates()),
        matrices_(n_ <= most_coordinates ? n_ * n_ : 0),
        columns_(matrices_ + 2 * n_) {}

  /// Invariance of L at so many points; false if L is finite at too few.
  bool add_invariance(const Problem& problem, Cloud& cloud) {
    const int points = static_cast<int>(std::min<std::size_t>(2, cloud.places())) * columns_ + spare_points;
    rows_.setZero(points, columns_);
    VectorXd q(n_), v(n_);
    Scratch scratch;
    const auto span = [&](const VectorXd& x) { return std::span(x.data(), std::size_t(n_)); };
    int found = 0;
    double momentum = 1;
    for (int tries = 0; found < points && tries < most_tries * points; ++tries) {
      cloud.draw(q, v);
      const PointValues at =
          evaluate_at(*problem.lagrangian, span(q), span(v), 0.1 * tries, Order::gradient, scratch);
      if (const double p = Eigen::Map<const VectorXd>(at.dv.data(), n_).norm(); found == 0 && p > 0)
        momentum = p;
      auto row = rows_.row(found);
      for (int a = 0; a < n_; ++a) {
        for (int b = 0; b < n_ && matrices_ > 0; ++b) row[a * n_ + b] = at.dq[a] * q[b] + at.dv[a] * v[b];
        row[matrices_ + a] = cloud.extent() * at.dq[a];
        row[matrices_ + n_ + a] = -momentum * v[a];
      }
      const double size = row.norm();
      if (!std::isfinite(size)) continue;
      if (size > 0) row /= size;
      ++found;
    }
    return found == points;
  }

  /// Invariance of the surfaces on which L is not smooth; at each point of all together, with weights.
  void add_surfaces(const Problem& problem, Cloud& cloud) {
    if (!problem.lagrangian->kinks()) return;
    const Eigen::Index before = rows_.rows(), points = columns_ + spare_points;
    rows_.conservativeResize(before + points, columns_);
    rows_.bottomRows(points).setZero();
    VectorXd q(n_), v(n_);
    Scratch scratch;
    for (Eigen::Index k = 0; k < points; ++k) {
      cloud.draw(q, v);
      VectorXd by_q = VectorXd::Zero(n_), by_v = by_q;
      for (const KinkSurface& surface : problem.lagrangian->kinks()->surfaces()) {
        const PointValues u =
            evaluate_at(*surface.u, {q.data(), std::size_t(n_)}, {v.data(), std::size_t(n_)},
                        0.1 * static_cast<double>(k), Order::gradient, scratch);
        const double weight = cloud.number();
        by_q += weight * Eigen::Map<const VectorXd>(u.dq.data(), n_);
        by_v += weight * Eigen::Map<const VectorXd>(u.dv.data(), n_);
      }
      auto row = rows_.row(before + k);
      for (int a = 0; a < n_; ++a) {
        for (int b = 0; b < n_ && matrices_ > 0; ++b) row[a * n_ + b] = by_q[a] * q[b] + by_v[a] * v[b];
        row[matrices_ + a] = cloud.extent() * by_q[a];
      }
      if (const double size = row.norm(); size > 0 && std::isfinite(size))
        row /= size;
      else
        row.setZero();
    }
  }

  /// With ends x = offset + Z y that satisfy B x = value, ends that are moved must, too: B (G⊕G) Z = 0 and
  /// B ((G⊕G) offset + (c, c)) = 0; and b · (q(T) − q(0)) must not depend on y.
  void add_ends(const Problem& problem, double extent) {
    const EndMap& ends = problem.ends;
    MatrixXd y = MatrixXd::Zero(2 * n_, ends.free + 1);
    y.col(ends.free) = Eigen::Map<const VectorXd>(ends.offset.data(), 2 * n_) / extent;
    for (const Triplet& z : ends.z) y(z.row, z.column) += z.value;
    // Without G only the last is an equation.
    const int relations = problem.boundary.rows, first = matrices_ > 0 ? 0 : ends.free,
              moved = relations * (ends.free + 1 - first);
    MatrixXd added = MatrixXd::Zero(moved + ends.free, columns_);
    for (int j = first; j <= ends.free; ++j)
      for (const Triplet& entry : problem.boundary.matrix) {
        auto row = added.row((j - first) * relations + entry.row);
        const int a = entry.column % n_, end = entry.column - a;
        for (int k = 0; k < n_ && matrices_ > 0; ++k) row[a * n_ + k] += entry.value * y(end + k, j);
        if (j == ends.free) row[matrices_ + a] += entry.value;
      }
    for (int j = 0; j < ends.free; ++j)
      for (int a = 0; a < n_; ++a) added(moved + j, matrices_ + n_ + a) = y(n_ + a, j) - y(a, j);
    // Of closed paths most are satisfied anyway.
    const Eigen::Index before = rows_.rows();
    Eigen::Index count = before;
    rows_.conservativeResize(before + added.rows(), columns_);
    for (Eigen::Index k = 0; k < added.rows(); ++k)
      if (added.row(k).cwiseAbs().maxCoeff() > null) rows_.row(count++) = added.row(k);
    rows_.conservativeResize(count, columns_);
  }

  std::vector<Generator> solutions(double extent) const {
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> qr;
    qr.setThreshold(null).compute(rows_);
    const Eigen::Index rank = qr.rank();
    std::vector<Generator> result;
    for (Eigen::Index k = rank; k < columns_; ++k) {
      // A P = Q (T 0; 0 0) Z: the last rows of Z span the null space of A P.
      VectorXd x = qr.colsPermutation() * qr.matrixZ().row(k).transpose();
      x = (x.array().abs() < negligible).select(0, x);
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

std::vector<Generator> continuous_symmetries(const Problem& problem, const SymmetrySearch& search) {
  Cloud cloud(problem, search.scales);
  Equations equations(problem, search.most_coordinates);
  if (!equations.add_invariance(problem, cloud)) return {};
  if (search.of_surfaces) equations.add_surfaces(problem, cloud);
  equations.add_ends(problem, cloud.extent());
  return equations.solutions(cloud.extent());
}

std::vector<Generator> symmetries_that_keep(const MatrixXd& values,
                                            const std::vector<Generator>& symmetries) {
  if (values.rows() == 0 || symmetries.empty()) return symmetries;
  const auto [u, sizes, v] = singular_value_decomposition(values);
  const Eigen::Index rank = (sizes.array() > kept * std::max(1.0, sizes[0])).count();
  std::vector<Generator> result;
  for (Eigen::Index j = rank; j < values.cols(); ++j) {
    Generator sum{std::vector<double>(symmetries[0].matrix.size()),
                  std::vector<double>(symmetries[0].shift.size())};
    for (std::size_t s = 0; s < symmetries.size(); ++s) {
      const double factor = v(static_cast<Eigen::Index>(s), j);
      for (std::size_t k = 0; k < sum.matrix.size(); ++k) sum.matrix[k] += factor * symmetries[s].matrix[k];
      for (std::size_t k = 0; k < sum.shift.size(); ++k) sum.shift[k] += factor * symmetries[s].shift[k];
    }
    result.push_back(std::move(sum));
  }
  return result;
}

}  // namespace extremal
