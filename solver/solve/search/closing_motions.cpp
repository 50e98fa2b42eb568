#include "solve/search/closing_motions.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "linear/dense.hpp"
#include "problem/closing.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/motion_scan.hpp"
#include "solve/search/state_motion.hpp"

namespace extremal {

namespace limit = limits::closing_motions;

using Eigen::MatrixXd;

namespace {

/// Middles of the cells of a box, from −1 to 1 along each dimension; numbers count along the first fastest.
struct Lattice {
  Lattice(int dimensions, int across) : across(across), stride(dimensions + 1, 1) {
    for (int k = 0; k < dimensions; ++k) stride[k + 1] = stride[k] * across;
  }
  int dimensions() const { return static_cast<int>(stride.size()) - 1; }
  int points() const { return stride.back(); }
  int place(int number, int k) const { return number / stride[k] % across; }
  Eigen::VectorXd at(int number) const {
    Eigen::VectorXd point(dimensions());
    for (int k = 0; k < dimensions(); ++k) point[k] = (2 * place(number, k) + 1.0) / across - 1;
    return point;
  }
  /// Whether no neighbour along a dimension has a smaller value.
  bool least(const std::vector<double>& values, int number) const {
    for (int k = 0; k < dimensions(); ++k)
      for (const int side : {-1, 1}) {
        const int there = place(number, k) + side;
        if (there >= 0 && there < across && values[number + side * stride[k]] < values[number]) return false;
      }
    return true;
  }

  int across;
  std::vector<int> stride;
};

}  // namespace

ClosingMotions::ClosingMotions(const Problem& problem)
    : problem_(problem),
      n_(problem.coordinates()),
      cost_(problem.lagrangian->structure().quadratic ? 1 : limits::scanned_motions::implicit_cost) {
  if (!problem.periodic || problem.duration.free || problem.lagrangian->structure().autonomous ||
      problem.paired || problem.manifold || problem.phase || problem.extension || problem.inequalities ||
      n_ > limit::most_coordinates || !Flow::suits(*problem.lagrangian))
    return;
  flow_.emplace(*problem.lagrangian);
  const ClosingMap map = closing_map(problem);
  back_ = inverse(map.r);
  transposed_ = map.r.transpose();
  shift_ = map.c;
}

bool ClosingMotions::around(std::span<const double> q, std::span<const double> extents, double frequency) {
  const auto n = static_cast<std::size_t>(n_);
  std::vector<double> v(n, 0), p(n);
  centre_.resize(2 * n_);
  unit_.resize(2 * n_);
  std::copy_n(q.begin(), n, centre_.begin());
  std::copy_n(extents.begin(), n, unit_.begin());
  if (!flow_->momentum(q.first(n), v, 0, span_of(centre_).subspan(n))) return false;
  for (int a = 0; a < n_; ++a) {
    v[a] = frequency * extents[a];
    if (!flow_->momentum(q.first(n), v, 0, p)) return false;
    unit_[n_ + a] = std::abs(p[a] - centre_[n_ + a]);
    v[a] = 0;
  }
  return unit_.minCoeff() > 0 && unit_.allFinite();
}

double ClosingMotions::reach_of(const Solution& solution) {
  const auto n = static_cast<std::size_t>(n_);
  Vector y(2 * n_), v(n_);
  const std::span<double> q = span_of(y).first(n);
  solution.trajectory.at(0, q, span_of(v));
  if (!flow_->momentum(q, span_of(v), 0, span_of(y).subspan(n))) return 0;
  return (y - centre_).cwiseQuotient(unit_).lpNorm<Eigen::Infinity>();
}

/// By how much the motion misses its start: in the frame of one return later, see SettledMotion::returned().
ClosingMotions::Vector ClosingMotions::opening(const Vector& start, const Vector& end) const {
  Vector result(2 * n_);
  result << back_ * (end.head(n_) - shift_), transposed_ * end.tail(n_);
  return (result - start).cwiseQuotient(unit_);
}

/// From y to T; false if there is no motion until then.
template <class Slope>
bool ClosingMotions::integrate(const Slope& slope, Vector& y, double tolerance, int cost) {
  return move_state(slope, n_, problem_.duration.value, tolerance, cost * cost_, more_, y) && y.allFinite();
}

/// Infinite where there is no motion until T.
double ClosingMotions::opening_from(const Vector& start) {
  Vector y = start;
  const auto slope = [this](double t, std::span<const double> x, std::span<double> s) {
    return flow_->slope(t, x, s);
  };
  return integrate(slope, y, limit::coarse_step, 1) ? opening(start, y).norm() : INFINITY;
}

/// Least squares of what the motion misses.
ClosingMotions::Closing ClosingMotions::close(Vector& start) {
  const int states = 2 * n_;
  const auto slope = [this](double t, std::span<const double> x, std::span<double> s) {
    return flow_->slope_with_variations(t, x, s);
  };
  const auto linearise = [&](const Vector& from, Vector& miss, MatrixXd& derivatives) {
    Vector y(states * (1 + states));
    y << from, MatrixXd::Identity(states, states).reshaped();
    if (!integrate(slope, y, limit::fine_step, limits::scanned_motions::variations_cost)) return false;
    miss = opening(from, y.head(states));
    const MatrixXd end = y.tail(states * states).reshaped(states, states) * unit_.asDiagonal();
    derivatives.resize(states, states);
    derivatives << back_ * end.topRows(n_), transposed_ * end.bottomRows(n_);
    derivatives = unit_.cwiseInverse().asDiagonal() * derivatives;
    derivatives -= MatrixXd::Identity(states, states);
    return true;
  };
  Vector miss, tried_miss;
  MatrixXd derivatives, tried_derivatives;
  if (!linearise(start, miss, derivatives)) return Closing::fails;
  double damping = limit::first_damping;
  for (int k = 0; k < limit::most_steps && miss.norm() > limit::closed; ++k) {
    const MatrixXd normal = derivatives.transpose() * derivatives;
    const Vector weight = Vector::Constant(states, damping * normal.trace() / states);
    const Vector step = -solved(normal + MatrixXd(weight.asDiagonal()), derivatives.transpose() * miss);
    const Vector tried = start + step.cwiseProduct(unit_);
    const bool lasts = tried.allFinite() && linearise(tried, tried_miss, tried_derivatives);
    if (lasts && tried_miss.norm() < miss.norm()) {
      start = tried;
      miss.swap(tried_miss);
      derivatives.swap(tried_derivatives);
      damping *= limit::less_damping;
    } else {
      damping *= limit::more_damping;
    }
  }
  if (miss.norm() > limit::closed) return Closing::fails;
  return singular_values(derivatives).minCoeff() > limit::isolated ? Closing::closed : Closing::degenerate;
}

void ClosingMotions::try_from(const Vector& start, const std::function<void(const Guess& motion)>& visit) {
  const auto n = static_cast<std::size_t>(n_);
  std::vector<double> v(n, 0);
  const std::span<const double> q = span_of(start).first(n), p = span_of(start).subspan(n);
  if (!flow_->velocity(q, p, 0, v)) return;
  const Guess motion = motion_from(*problem_.lagrangian, q, v, problem_.duration.value, limit::coarse_step,
                                   [] { return true; });
  if (motion.given()) visit(motion);
}

bool ClosingMotions::all(double nearest, double farthest, int across,
                         const std::function<bool(int steps)>& more,
                         const std::function<void(const Guess& motion)>& visit) {
  more_ = more;
  const Lattice lattice(dimensions(), across);
  const auto reach = [&](int number) { return farthest * lattice.at(number).lpNorm<Eigen::Infinity>(); };
  const auto start = [&](int number) -> Vector {
    return centre_ + farthest * lattice.at(number).cwiseProduct(unit_);
  };
  const double seam = nearest - 2 * farthest / across;  // neighbours of the first
  std::vector<double> openings(lattice.points(), INFINITY);
  for (int k = 0; k < lattice.points() && more(0); ++k)
    if (reach(k) >= seam) openings[k] = opening_from(start(k));
  for (int k = 0; k < lattice.points() && more(0); ++k) {
    if (!(reach(k) > nearest) || !std::isfinite(openings[k]) || !lattice.least(openings, k)) continue;
    Vector nearer = start(k);
    const Closing result = close(nearer);
    if (result != Closing::degenerate) try_from(result == Closing::closed ? nearer : start(k), visit);
  }
  return more(0);
}

}  // namespace extremal
