#include "rivals/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "linear/dense.hpp"
#include "rivals/guessed_path.hpp"

namespace extremal {

namespace {

constexpr int most_steps = 20000;
std::span<const double> view(const Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

}  // namespace

Segments::Segments(const Problem& problem, int segments, const Deadline& deadline)
    : problem_(problem),
      n_(problem.coordinates()),
      segments_(segments),
      deadline_(deadline),
      conditions_(problem),
      flow_(problem.motion(), problem.motion_copies()),
      lane_flow_(problem.motion(), problem.motion_copies()),
      integrator_(lane_flow_),
      first_steps_(std::max(segments, 1), 0.0),
      first_tolerances_(std::max(segments, 1), 1.0) {
  if (segments < 1) throw std::invalid_argument(fmt::format("segments = {}; need at least 1", segments));
}

Eigen::VectorXd Segments::velocity(const Eigen::VectorXd& state, double t) {
  Eigen::VectorXd v(n_);
  const auto n = static_cast<std::size_t>(n_);
  if (!flow_.velocity(view(state).first(n), view(state).subspan(n), t, {v.data(), n}))
    v.setConstant(std::nan(""));
  return v;
}

bool Segments::guess(Course& course) {
  const GuessedPath path(problem_);
  const auto n = static_cast<std::size_t>(n_);
  course.duration = problem_.duration.value;
  course.states.resize(2 * n_, segments_);
  Eigen::VectorXd low = path.at(1), high = low;
  for (int k = 0; k < segments_; ++k) {
    const double tau = static_cast<double>(k) / segments_;
    const Eigen::VectorXd q = path.at(tau), v = path.slope(tau) / course.duration;
    Eigen::VectorXd p(n_);
    if (!flow_.momentum(view(q), view(v), tau * course.duration, {p.data(), n})) return false;
    course.states.col(k) << q, p;
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  scale_ = std::max({(high - low).maxCoeff(), low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()});
  if (scale_ == 0) scale_ = 1;
  free_start(course);
  return course.states.allFinite();
}

/// Conditions on the start alone are linear in it: they are met once, and kept.
void Segments::free_start(Course& course) {
  const Eigen::VectorXd start = course.states.col(0);
  EndStates ends{start.head(n_), start.tail(n_), Eigen::VectorXd::Zero(n_), start.head(n_), start.tail(n_)};
  const int linear = conditions_.rows() - (problem_.duration.free ? 1 : 0);
  const EndConditions::Values values = conditions_.at(ends, {});
  std::vector<char> early(conditions_.rows(), 1);
  for (const Triplet& e : values.derivatives)
    if (e.column >= 2 * n_) early[e.row] = 0;
  later_.clear();
  std::vector<int> place(conditions_.rows(), -1);
  int count = 0;
  for (int r = 0; r < conditions_.rows(); ++r) {
    if (r < linear && early[r])
      place[r] = count++;
    else
      later_.push_back(r);
  }
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * n_, count);
  Eigen::VectorXd miss(count);
  for (const Triplet& e : values.derivatives)
    if (place[e.row] >= 0) rows(e.column, place[e.row]) += e.value;
  for (int r = 0; r < conditions_.rows(); ++r)
    if (place[r] >= 0) miss[place[r]] = values.residual[r];
  // Most conditions name one coordinate: the others are free as they are.
  const Eigen::MatrixXd used = rows.cwiseAbs();
  if (((used.array() > 0).colwise().count() == 1).all()) {
    basis_.setZero(2 * n_, 2 * n_ - count);
    for (int i = 0, column = 0; i < 2 * n_; ++i) {
      if (used.row(i).sum() == 0)
        basis_(i, column++) = 1;
      else
        course.states(i, 0) -= rows.row(i).dot(miss) / rows.row(i).squaredNorm();
    }
    return;
  }
  course.states.col(0) -= least_norm(rows.transpose(), miss);
  basis_ = complement(rows);
}

/// Each segment's variations are dealt out to `split` spans.
void Segments::load(const Course& course, int split, int columns) {
  const std::size_t size = static_cast<std::size_t>(2 * n_), block = size * (1 + columns);
  initial_.assign(block * split * segments_, 0.0);
  final_.resize(initial_.size());
  spans_.assign(static_cast<std::size_t>(split) * segments_, {});
  for (int k = 0; k < segments_; ++k)
    for (int part = 0; part < split; ++part) {
      const std::size_t index = static_cast<std::size_t>(k) * split + part;
      double* const start = initial_.data() + index * block;
      Eigen::Map<Eigen::VectorXd>(start, 2 * n_) = course.states.col(k);
      for (int c = 0; c < columns; ++c) {
        const int seed = part * columns + c;
        Eigen::Map<Eigen::VectorXd> variation(start + (1 + c) * size, 2 * n_);
        if (k == 0 && seed < basis_.cols()) variation = basis_.col(seed);
        if (k > 0 && seed < 2 * n_) variation[seed] = 1;
      }
      const double T = course.duration;
      spans_[index] = {.start = T * k / segments_,
                       .end = k + 1 == segments_ ? T : T * (k + 1) / segments_,
                       .initial = start,
                       .final = final_.data() + index * block,
                       .first_step = first_steps_[k],
                       .tolerance = first_tolerances_[k]};
    }
}

bool Segments::unload(const Course& course, int split, int columns) {
  const std::size_t size = static_cast<std::size_t>(2 * n_), block = size * (1 + columns);
  ends_.resize(2 * n_, segments_);
  blocks_.transition.resize(columns > 0 ? segments_ : blocks_.transition.size());
  right_.assign(segments_ + 1, Eigen::VectorXd::Zero(2 * n_));
  for (int k = 0; k < segments_; ++k) {
    const MotionSpan& span = spans_[static_cast<std::size_t>(k) * split];
    first_steps_[k] = span.first_step;
    first_tolerances_[k] = span.tolerance;
    ends_.col(k) = Eigen::Map<const Eigen::VectorXd>(span.final, 2 * n_);
    if (k + 1 < segments_) right_[k] = course.states.col(k + 1) - ends_.col(k);
    if (columns == 0) continue;
    const int width = static_cast<int>(k == 0 ? basis_.cols() : 2 * n_);
    blocks_.transition[k].resize(2 * n_, width);
    for (int seed = 0; seed < width; ++seed)
      blocks_.transition[k].col(seed) = Eigen::Map<const Eigen::VectorXd>(
          final_.data() + (static_cast<std::size_t>(k) * split + seed / columns) * block +
              (1 + seed % columns) * size,
          2 * n_);
    if (!blocks_.transition[k].allFinite()) return false;
  }
  return ends_.allFinite();
}

EndStates Segments::end_states(const Course& course) {
  const Eigen::VectorXd start = course.states.col(0), end = ends_.col(segments_ - 1);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(n_);
  if (problem_.duration.energy) v = velocity(start, 0);
  return {start.head(n_), start.tail(n_), v, end.head(n_), end.tail(n_)};
}

/// How the ends of segments move as times stretch with the duration.
void Segments::end_slopes(const Course& course) {
  blocks_.extra.clear();
  if (!problem_.duration.free) return;
  const std::size_t size = static_cast<std::size_t>(2 * n_) * simd_lanes();
  AlignedDoubles y(size), slope(size), t(simd_lanes());
  for (int begin = 0; begin < segments_; begin += simd_lanes()) {
    for (int l = 0; l < simd_lanes(); ++l)
      for (int i = 0; i < 2 * n_; ++i)
        y[static_cast<std::size_t>(i) * simd_lanes() + l] = ends_(i, std::min(begin + l, segments_ - 1));
    lane_flow_.slope(t.data(), y.data(), 0, slope.data());
    for (int l = 0; l < simd_lanes() && begin + l < segments_; ++l) {
      Eigen::VectorXd f(2 * n_);
      for (int i = 0; i < 2 * n_; ++i) f[i] = slope[static_cast<std::size_t>(i) * simd_lanes() + l];
      // Of one unit of log T, so that its size compares with the others'.
      blocks_.extra.push_back(f * (course.duration / segments_));
    }
  }
}

/// The conditions at the ends that the start alone does not meet.
void Segments::close(const Course& course) {
  const EndConditions::Values values = conditions_.at(end_states(course), {});
  const auto rows = static_cast<Eigen::Index>(later_.size());
  std::vector<int> place(conditions_.rows(), -1);
  for (std::size_t r = 0; r < later_.size(); ++r) place[later_[r]] = static_cast<int>(r);
  Eigen::MatrixXd by_start = Eigen::MatrixXd::Zero(rows, 2 * n_);
  blocks_.by_last.setZero(rows, 2 * n_);
  for (const Triplet& e : values.derivatives) {
    if (place[e.row] < 0) continue;
    if (e.column < 2 * n_)
      by_start(place[e.row], e.column) += e.value;
    else
      blocks_.by_last(place[e.row], e.column - 2 * n_) += e.value;
  }
  blocks_.by_first = by_start * basis_;
  if (problem_.duration.free) blocks_.by_extra.setZero(rows);
  blocks_.may_be_singular = problem_.periodic;
  right_.back().resize(rows);
  for (Eigen::Index r = 0; r < rows; ++r) right_.back()[r] = -values.residual[later_[r]];
}

bool Segments::evaluate(const Course& course, double tolerance, bool with_variations) {
  const int wanted = static_cast<int>(segments_ == 1 ? basis_.cols() : 2 * n_);
  int split = with_variations ? std::clamp(simd_lanes() / segments_, 1, std::max(wanted, 1)) : 1;
  const int columns = with_variations ? (wanted + split - 1) / split : 0;
  if (columns > 0) split = (wanted + columns - 1) / columns;
  load(course, split, columns);
  if (!integrator_.run(spans_, columns, tolerance, most_steps, deadline_)) return false;
  if (!unload(course, split, columns)) return false;
  if (with_variations) end_slopes(course);
  close(course);
  return right_.back().allFinite();
}

void Segments::factor() { system_.factor(blocks_); }

Segments::Correction Segments::correct() const {
  const AlmostBlockDiagonal::Solution found = system_.solve(right_);
  Correction step;
  step.finite = found.finite();
  step.states.resize(2 * n_, segments_);
  step.states.col(0) = basis_ * found.first;
  for (int k = 1; k < segments_; ++k) step.states.col(k) = found.rest[k - 1];
  step.end = found.rest.back();
  step.duration = found.extra;
  step.size = std::max({step.states.topRows(n_).cwiseAbs().maxCoeff() / scale_,
                        step.end.head(n_).cwiseAbs().maxCoeff() / scale_, std::abs(found.extra)});
  return step;
}

}  // namespace extremal
