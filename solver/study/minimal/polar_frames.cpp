#include "study/minimal/polar_frames.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <utility>

#include "linear/dense.hpp"
#include "study/minimal/limits.hpp"

namespace extremal {
namespace {

using namespace limits::polar;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Two linear functions of q and what else the constraint depends on.
struct Plane {
  MatrixXd rows;    ///< 2 × n
  VectorXd centre;  ///< of these
  MatrixXd beside;  ///< further rows
  bool spatial;     ///< the distance from the centre is not the same everywhere
  double turned = 0;
};

/// Numbers that roundoff keeps from 0 and ±1.
MatrixXd rounded(MatrixXd m) {
  for (double& x : m.reshaped())
    if (std::abs(x - std::round(x)) < roundoff) x = std::round(x);
  return m;
}

/// The directions of one constraint.
class Directions {
 public:
  Directions(const Manifold& manifold, const PathPoints& path, int constraint)
      : manifold_(manifold), path_(path), constraint_(constraint), n_(manifold.coordinates()) {
    for (const VectorXd& q : path.q) size_ = std::max(size_, q.lpNorm<Eigen::Infinity>());
    size_ = size_ > 0 ? size_ : 1;
    find();
  }

  /// Planes of directions that are nearest to coordinates, or the one that is nearest to the path.
  std::vector<Plane> planes(bool of_coordinates) const {
    std::vector<Plane> found;
    if (curved_) {
      if (of_coordinates) add_planes_of_coordinates(found);
      return found;
    }
    const Index count = scaled_.rows();
    if (count < 2) return found;
    if (!of_coordinates) {
      MatrixXd moments = MatrixXd::Zero(count, count);
      for (const VectorXd& q : path_.q) {
        const VectorXd x = scaled_ * q - centre_;
        moments += x * x.transpose();
      }
      add(symmetric_eigen(moments).vectors.rowwise().reverse(), 0, 1, found);
      return found;
    }
    const MatrixXd axes = near_coordinates();
    for (Index i = 0; i < count; ++i)
      for (Index j = i + 1; j < count; ++j) add(axes, i, j, found);
    return found;
  }

  Index count() const { return scaled_.rows(); }

 private:
  /// Value, gradient and second derivative of the constraint.
  PointValues at(const VectorXd& q, double t) const {
    const Index all = n_ + 1 + manifold_.constraints();
    VectorXd point = VectorXd::Zero(all);
    point.head(n_) = q;
    point[n_] = t;
    point[n_ + 1 + constraint_] = 1;
    const VectorXd rest = VectorXd::Zero(all);
    Scratch scratch;
    return evaluate_at(*manifold_.parts().forms, span_of(point), span_of(rest), 0, Order::hessian, scratch);
  }
  MatrixXd second(const PointValues& values) const {
    const Index all = n_ + 1 + manifold_.constraints();
    return Eigen::Map<const MatrixXd>(values.qq.data(), all, all).topLeftCorner(n_, n_);
  }

  void find() {
    const std::size_t middle = path_.q.size() / 2;
    const PointValues here = at(path_.q[middle], path_.times[middle]);
    const MatrixXd q = second(here);
    std::mt19937_64 random(20240229);
    std::uniform_real_distribution<double> beside(-size_, size_);
    for (int i = 0; i < tries; ++i) {
      const std::size_t k = i % path_.q.size();
      VectorXd place = path_.q[k];
      for (double& x : place) x += beside(random);
      curved_ = !((second(at(place, path_.times[k])) - q).norm() <= roundoff * q.norm());
      if (curved_) return;
    }
    const SymmetricEigen parts = symmetric_eigen(q);
    const double largest = parts.values.cwiseAbs().maxCoeff();
    if (!(largest > 0)) return;
    std::vector<Index> of_sign[2];
    for (Index i = 0; i < n_; ++i)
      if (std::abs(parts.values[i]) > flat * largest) of_sign[parts.values[i] > 0].push_back(i);
    const std::vector<Index>& taken = of_sign[of_sign[1].size() >= of_sign[0].size()];
    const VectorXd slope = Eigen::Map<const VectorXd>(here.dq.data(), n_) - q * path_.q[middle];  // at q = 0
    scaled_.resize(std::ssize(taken), n_);
    centre_.resize(std::ssize(taken));
    for (Index i = 0; i < std::ssize(taken); ++i) {
      const double value = parts.values[taken[i]], root = std::sqrt(std::abs(value));
      const VectorXd v = parts.vectors.col(taken[i]);
      scaled_.row(i) = root * v.transpose();
      centre_[i] = -root * v.dot(slope) / value;
    }
  }

  /// Where second derivatives vary: two coordinates that the constraint reads, about zero, or about the
  /// centre of the circle that the path is nearest to.
  void add_planes_of_coordinates(std::vector<Plane>& found) const {
    std::vector<Index> read;
    VectorXd sum = VectorXd::Zero(n_);
    for (std::size_t k = 0; k < path_.q.size(); k += 1 + path_.q.size() / tries)
      sum += Eigen::Map<const VectorXd>(at(path_.q[k], path_.times[k]).dq.data(), n_).cwiseAbs();
    for (Index a = 0; a < n_; ++a)
      if (sum[a] > 0) read.push_back(a);
    if (std::ssize(read) > most_coordinates_of_planes) return;
    for (std::size_t i = 0; i < read.size(); ++i)
      for (std::size_t j = i + 1; j < read.size(); ++j) {
        Plane plane{MatrixXd::Zero(2, n_), VectorXd::Zero(2), MatrixXd(0, n_), true};
        plane.rows(0, read[i]) = plane.rows(1, read[j]) = 1;
        for (const bool about_zero : {true, false}) {
          if (!about_zero) plane.centre = centre_of_circle(plane.rows);
          if (!plane.centre.allFinite() || !measure(plane)) continue;
          found.push_back(plane);
          break;
        }
      }
  }

  /// |x|² = 2 c·x + d, by least squares.
  VectorXd centre_of_circle(const MatrixXd& rows) const {
    MatrixXd left(std::ssize(path_.q), 3);
    VectorXd right(left.rows());
    for (Index k = 0; k < left.rows(); ++k) {
      const Eigen::Vector2d x = rows * path_.q[static_cast<std::size_t>(k)];
      left.row(k) << 2 * x.transpose(), 1;
      right[k] = x.squaredNorm();
    }
    return least_norm(left, right).topRows(2);
  }

  /// Orthonormal columns in the scaled directions: what coordinates of q make of them, the longest first.
  MatrixXd near_coordinates() const {
    MatrixXd left = scaled_, axes(scaled_.rows(), scaled_.rows());
    for (Index i = 0; i < axes.cols(); ++i) {
      Index longest = 0;
      for (Index a = 1; a < n_; ++a)
        if (left.col(a).norm() > (1 + flat) * left.col(longest).norm()) longest = a;
      axes.col(i) = left.col(longest).normalized();
      left -= axes.col(i) * (axes.col(i).transpose() * left);
    }
    return axes;
  }

  void add(const MatrixXd& axes, Index i, Index j, std::vector<Plane>& found) const {
    MatrixXd all = axes.transpose() * scaled_;
    VectorXd centre = axes.transpose() * centre_;
    const double scale = 1 / std::max(all.row(i).cwiseAbs().maxCoeff(), all.row(j).cwiseAbs().maxCoeff());
    all = rounded(scale * all);
    centre *= scale;
    Plane plane;
    plane.rows.resize(2, n_);
    plane.rows << all.row(i), all.row(j);
    plane.centre.resize(2);
    plane.centre << centre[i], centre[j];
    for (double& c : plane.centre)
      if (std::abs(c) < roundoff * size_) c = 0;
    plane.spatial = all.rows() > 2;
    plane.beside.resize(all.rows() - 2, n_);
    for (Index row = 0, to = 0; row < all.rows(); ++row)
      if (row != i && row != j) plane.beside.row(to++) = all.row(row);
    if (measure(plane)) found.push_back(std::move(plane));
  }

  /// Whether the path keeps away from the centre; how far it turns.
  bool measure(Plane& plane) const {
    double least = INFINITY, most = 0, angle = 0, low = INFINITY, high = -INFINITY;
    for (const VectorXd& q : path_.q) {
      const Eigen::Vector2d x = plane.rows * q - plane.centre;
      const double next = std::atan2(x[1], x[0]), whole = 2 * std::numbers::pi;
      angle = low > high ? next : next + whole * std::round((angle - next) / whole);
      low = std::min(low, angle);
      high = std::max(high, angle);
      least = std::min(least, x.norm());
      most = std::max(most, x.norm());
    }
    plane.turned = high - low;
    return least > least_radius * most;
  }

  const Manifold& manifold_;
  const PathPoints& path_;
  const int constraint_;
  const Index n_;
  double size_ = 0;
  MatrixXd scaled_;  ///< a row √|λ| v for each direction
  VectorXd centre_;
  bool curved_ = false;  ///< second derivatives vary
};

/// Independent rows: what makes a frame of planes.
class FrameOfPlanes {
 public:
  explicit FrameOfPlanes(Index n) : n_(n), rows_(0, n) {}

  bool take(const MatrixXd& rows) {
    if (rows_.rows() + rows.rows() > n_) return false;
    MatrixXd more(rows_.rows() + rows.rows(), n_);
    more << rows_, rows;
    if (singular_values(more.rowwise().normalized()).minCoeff() < independent_rows) return false;
    rows_ = std::move(more);
    return true;
  }

  /// Coordinates of q complete the rows, each the one that is farthest from those there are.
  MatrixXd completed() {
    while (rows_.rows() < n_) {
      MatrixXd across = MatrixXd::Identity(n_, n_);
      if (rows_.rows() > 0) {
        const SingularValues parts = singular_value_decomposition(rows_);
        const MatrixXd along = parts.v.leftCols(rows_.rows());
        across -= along * along.transpose();
      }
      Index farthest = 0;
      for (Index a = 1; a < n_; ++a)
        if (across(a, a) > (1 + flat) * across(farthest, farthest)) farthest = a;
      rows_.conservativeResize(rows_.rows() + 1, n_);
      rows_.row(rows_.rows() - 1) = VectorXd::Unit(n_, farthest).transpose();
    }
    return rows_;
  }

 private:
  const Index n_;
  MatrixXd rows_;
};

/// Of planes in this order, as many as are independent.
Frame frame_of(const Manifold& manifold, const PathPoints& path, const std::vector<Plane>& planes) {
  FrameOfPlanes rows(manifold.coordinates());
  Frame frame;
  std::vector<const Plane*> taken;
  for (const Plane& plane : planes)
    if (rows.take(plane.rows)) taken.push_back(&plane);
  for (const Plane* plane : taken) {
    frame.spatial |= plane->spatial;
    for (Index i = 0; i < plane->beside.rows(); ++i) rows.take(plane->beside.row(i));
  }
  const MatrixXd all = rows.completed();
  frame.basis = rounded(inverse(all));
  for (std::size_t i = 0; i < taken.size(); ++i) {
    Polar pair;
    pair.angle = static_cast<int>(2 * i);
    pair.radius = pair.angle + 1;
    pair.x = taken[i]->centre[0];
    pair.y = taken[i]->centre[1];
    double radius = 0;
    for (const VectorXd& q : path.q) radius += (taken[i]->rows * q - taken[i]->centre).norm();
    radius *=
        frame.basis.middleCols(pair.angle, 2).cwiseAbs().maxCoeff() / static_cast<double>(path.q.size());
    pair.unit = std::exp2(std::round(std::log2(radius)));
    pair.invariants = invariant_constraints(manifold, path, frame.basis, pair);
    frame.polar.push_back(std::move(pair));
  }
  return frame;
}

/// Marks the constraints that depend on t, if t multiplies coordinates in any of them; else none. What
/// rotations leave unchanged at the times of a path may change at others.
std::vector<char> moving_constraints(const Manifold& manifold) {
  const int n = manifold.coordinates();
  const std::vector<HessianEntry>& entries = manifold.parts().forms->structure().hessian;
  std::vector<char> timed(manifold.constraints());
  bool mixed = false;
  for (const HessianEntry& e : entries) {
    const auto [low, high] = std::minmax(e.row, e.column);
    mixed |= low < n && high == n;
    if (low == n && high > n) timed[high - n - 1] = 1;
  }
  if (!mixed) std::ranges::fill(timed, 0);
  return timed;
}

}  // namespace

std::vector<int> invariant_constraints(const Manifold& manifold, const PathPoints& path,
                                       const MatrixXd& basis, const Polar& pair) {
  const MatrixXd by_q = inverse(basis);
  const Index m = manifold.constraints();
  std::vector<char> changed = moving_constraints(manifold);
  std::mt19937_64 random(20240229);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < tries; ++i) {
    const std::size_t k = i * path.q.size() / tries;
    VectorXd z = by_q * path.q[k];
    const double size = z.lpNorm<Eigen::Infinity>();
    for (double& x : z) x += 0.3 * size * any(random);
    const double angle = std::numbers::pi * any(random), c = std::cos(angle), s = std::sin(angle);
    const double x = z[pair.angle] - pair.x, y = z[pair.radius] - pair.y;
    VectorXd turned = z;
    turned[pair.angle] = pair.x + c * x - s * y;
    turned[pair.radius] = pair.y + s * x + c * y;
    const VectorXd before = basis * z, after = basis * turned;
    const ConstraintValues one = manifold.at(span_of(before), path.times[k]),
                           other = manifold.at(span_of(after), path.times[k]);
    for (Index g = 0; g < m; ++g) {
      const double scale =
          (one.slopes.row(g).norm() + other.slopes.row(g).norm()) * (before.norm() + after.norm());
      changed[g] |= !(std::abs(one.g[g] - other.g[g]) <= roundoff * scale);
    }
  }
  std::vector<int> found;
  for (Index g = 0; g < m; ++g)
    if (!changed[g]) found.push_back(static_cast<int>(g));
  return found;
}

std::vector<Frame> polar_frames(const Manifold& manifold, const PathPoints& path) {
  std::vector<Plane> planes;
  for (int k = 0; k < manifold.constraints(); ++k) {
    const Directions directions(manifold, path, k);
    for (const bool of_coordinates : {true, false})
      if (of_coordinates || directions.count() > 2)
        for (Plane& plane : directions.planes(of_coordinates)) planes.push_back(std::move(plane));
  }
  std::ranges::stable_sort(planes, std::greater(), &Plane::turned);
  std::vector<Frame> frames;
  // Of a constraint with more directions one plane after the other is the first.
  for (std::size_t i = 0; i < planes.size() && frames.size() < most_frames; ++i) {
    if (!frames.empty() && !planes[i].spatial) continue;
    std::vector<Plane> ordered{planes[i]};
    for (std::size_t j = 0; j < planes.size(); ++j)
      if (j != i) ordered.push_back(planes[j]);
    frames.push_back(frame_of(manifold, path, ordered));
  }
  return frames;
}

}  // namespace extremal
