#include "solve/contact/junctions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "linear/dense.hpp"
#include "solve/contact/limits.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<int> joined(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> both;
  std::ranges::set_union(a, b, std::back_inserter(both));
  return both;
}

/// Points of a guess of an arc.
constexpr int guess_points = 48;

}  // namespace

Junctions::Junctions(Arcs& arcs, const std::vector<Interval>& intervals, const PathPoints& path)
    : arcs_(arcs), problem_(arcs.problem()), n_(problem_.coordinates()), duration_(problem_.duration.value) {
  const auto point = [&](double t) {
    VectorXd q(n_);
    path(t, {q.data(), static_cast<std::size_t>(n_)});
    return q;
  };
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const Interval& interval = intervals[i];
    PathArc arc{interval.held, interval.from, interval.to, {}, {}, {}};
    for (int k = 0; k <= guess_points; ++k) {
      const double tau = static_cast<double>(k) / guess_points;
      const VectorXd q = point(interval.from + tau * (interval.to - interval.from));
      arc.guess.tau.push_back(tau);
      arc.guess.q.insert(arc.guess.q.end(), q.begin(), q.end());
    }
    parts_.push_back(std::move(arc));
    if (i == 0) continue;
    held_.push_back(joined(intervals[i - 1].held, interval.held));
    touched_.push_back(interval.touched);
    if (interval.touched >= 0) held_.back() = joined(held_.back(), {interval.touched});
    state_.q.push_back(point(interval.from));
    state_.t.push_back(interval.from);
  }
  state_.y = VectorXd::Zero(problem_.ends.free);
  for (int f = 0; f < problem_.ends.free; ++f) {
    const int e = problem_.ends.home[f];
    state_.y[f] = point(e < n_ ? 0 : duration_)[e % n_];
  }
}

int Junctions::unknowns() const {
  int sum = ends();
  for (const std::vector<int>& held : held_) sum += n_ - static_cast<int>(held.size()) + 1;
  return sum;
}

/// Arcs with the ends that a state gives them; its points are moved onto what they must satisfy.
bool Junctions::place(State& state, std::vector<PathArc>& parts) const {
  std::vector<double> ends = problem_.ends.offset;
  for (const Triplet& z : problem_.ends.z) ends[z.row] += z.value * state.y[z.column];
  parts.front().from = 0;
  parts.back().to = duration_;
  parts.front().start = Eigen::Map<const VectorXd>(ends.data(), n_);
  parts.back().end = Eigen::Map<const VectorXd>(ends.data() + n_, n_);
  if (!arcs_.project(parts.front().held, 0, parts.front().start)) return false;
  if (!arcs_.project(parts.back().held, duration_, parts.back().end)) return false;
  for (std::size_t j = 0; j < state.t.size(); ++j) {
    if (!arcs_.project(held_[j], state.t[j], state.q[j])) return false;
    parts[j].to = parts[j + 1].from = state.t[j];
    parts[j].end = parts[j + 1].start = state.q[j];
  }
  return true;
}

/// Arcs with these numbers.
bool Junctions::solve(Trial& trial, int first, int last) {
  for (int i = std::max(first, 0); i <= std::min<int>(last, static_cast<int>(trial.parts.size()) - 1); ++i) {
    trial.solved[i] = arcs_.solve(trial.parts[i]);
    if (!trial.solved[i].found) {
      message_ = fmt::format("the arc from t = {:.6g} to {:.6g} was not found: {}", trial.parts[i].from,
                             trial.parts[i].to, trial.solved[i].message);
      return false;
    }
    trial.parts[i].guess = guess_of(trial.solved[i].trajectory);
  }
  return true;
}

/// Natural conditions of the ends, then jumps of the momentum.
VectorXd Junctions::residual(const Trial& trial) const {
  const std::vector<SolvedArc>& solved = trial.solved;
  VectorXd r = VectorXd::Zero(ends() + count() * n_);
  const std::vector<double>& given = problem_.boundary.momenta;
  for (const Triplet& z : problem_.ends.z) {
    const bool at_end = z.row >= n_;
    double p = at_end ? solved.back().p_end[z.row - n_] : -solved.front().p_start[z.row];
    if (!given.empty()) p -= (at_end ? 1 : -1) * given[z.row];
    r[z.column] += z.value * p;
  }
  for (int j = 0; j < count(); ++j) r.segment(ends() + j * n_, n_) = jump(trial, j);
  return r;
}

/// Of the momentum. At a touch, in place of its part across the surface, the mean velocity across it, by the
/// metric in units of momentum.
VectorXd Junctions::jump(const Trial& trial, int junction) const {
  const SolvedArc &before = trial.solved[junction], &after = trial.solved[junction + 1];
  VectorXd jump = before.p_end - after.p_start;
  if (touched_[junction] < 0) return jump;
  const VectorXd& q = trial.parts[junction].end;
  const Manifold& all = *problem_.inequalities->all;
  const ConstraintValues values = all.at({q.data(), static_cast<std::size_t>(n_)}, trial.parts[junction].to);
  const VectorXd slope = values.slopes.row(touched_[junction]), across = all.metric() * slope;
  const double square = slope.dot(across);
  const double rate = 0.5 * slope.dot(before.v_end + after.v_start) + values.rates[touched_[junction]];
  return jump + (rate - across.dot(jump)) / square * slope;
}

double Junctions::impulse(int junction) const {
  const VectorXd& q = parts_[junction].end;
  const Manifold& all = *problem_.inequalities->all;
  const VectorXd slope =
      all.at({q.data(), static_cast<std::size_t>(n_)}, parts_[junction].to).slopes.row(touched_[junction]);
  const VectorXd across = all.metric() * slope;
  return across.dot(solved_[junction].p_end - solved_[junction + 1].p_start) / slope.dot(across);
}

/// By derivatives where the path is now.
bool Junctions::singular() {
  if (unknowns() == 0 || !differentiate()) return false;
  const SingularValues svd = singular_value_decomposition(slopes_);
  return svd.values[svd.values.size() - 1] < singular_rank * svd.values[0];
}

/// Displacements of the point of a junction that keep what is held there.
MatrixXd Junctions::basis(int junction) const {
  const std::size_t held = held_[junction].size();
  if (held == 0) return MatrixXd::Identity(n_, n_);
  if (held == static_cast<std::size_t>(n_)) return MatrixXd(n_, 0);
  const VectorXd& q = state_.q[junction];
  return complement(arcs_.manifold(held_[junction])
                        ->at({q.data(), static_cast<std::size_t>(n_)}, state_.t[junction])
                        .slopes.transpose());
}

/// A step of the ends, then of points and of the time of each junction: in units of size and duration. A
/// point moves along the path with its time.
Junctions::State Junctions::moved(const VectorXd& step) const {
  State state = state_;
  state.y += size_ * step.head(ends());
  Index at = ends();
  for (int j = 0; j < count(); ++j) {
    const MatrixXd directions = basis(j);
    const double later = duration_ * step[at + directions.cols()];
    state.q[j] += directions * (size_ * step.segment(at, directions.cols())) + later * solved_[j].v_end;
    state.t[j] += later;
    at += directions.cols() + 1;
  }
  return state;
}

bool Junctions::differentiate() {
  const int all = unknowns();
  slopes_ = MatrixXd::Zero(residual_.size(), all);
  int column = 0;
  const auto take = [&](auto&&... which) {
    VectorXd step = VectorXd::Zero(all);
    step[column] = difference;
    Trial trial{parts_, solved_, {}};
    State state = moved(step);
    if (!place(state, trial.parts) || !(solve(trial, which, which + 1) && ...)) return false;
    slopes_.col(column++) = (residual(trial) - residual_) / difference;
    return true;
  };
  const int last = static_cast<int>(parts_.size()) - 1;
  for (int f = 0; f < ends(); ++f)
    if (!take(-1, last)) return false;
  for (int j = 0; j < count(); ++j)
    for (Index c = 0; c <= n_ - static_cast<Index>(held_[j].size()); ++c)
      if (!take(j)) return false;
  return true;
}

VectorXd Junctions::newton_step() {
  const SingularValues svd = singular_value_decomposition(slopes_);
  VectorXd step = VectorXd::Zero(slopes_.cols());
  for (Index i = 0; i < svd.values.size(); ++i)
    if (svd.values[i] > rank * svd.values[0]) {
      step -= svd.u.col(i).dot(residual_) / svd.values[i] * svd.v.col(i);
      amplification_ = momentum_ / svd.values[i];
    }
  return step;
}

/// The part of a step that leaves every arc a part of its length.
double Junctions::longest_step(const VectorXd& step) const {
  std::vector<double> later(count() + 2, 0.0);
  Index at = ends();
  for (int j = 0; j < count(); ++j) {
    at += n_ - static_cast<Index>(held_[j].size());
    later[j + 1] = duration_ * step[at++];
  }
  double factor = 1;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const double change = later[i + 1] - later[i], length = parts_[i].to - parts_[i].from;
    if (change < -(1 - shortest_step) * length)
      factor = std::min(factor, -(1 - shortest_step) * length / change);
  }
  return factor;
}

double Junctions::movement_of(const VectorXd& step) const {
  double most = 0;
  if (ends() > 0) most = step.head(ends()).lpNorm<Eigen::Infinity>();
  Index at = ends();
  for (int j = 0; j < count(); ++j) {
    const Index columns = n_ - static_cast<Index>(held_[j].size());
    if (columns > 0) most = std::max(most, step.segment(at, columns).norm());
    at += columns + 1;
  }
  return most * size_;
}

/// Sizes of path and momenta.
void Junctions::measure() {
  VectorXd low = parts_.front().start, high = low;
  momentum_ = 0;
  for (const SolvedArc& solved : solved_) {
    const Trajectory& path = solved.trajectory;
    for (std::size_t i = 0; i < path.nodes.size(); ++i) {
      low[i % n_] = std::min(low[i % n_], path.nodes[i]);
      high[i % n_] = std::max(high[i % n_], path.nodes[i]);
    }
    momentum_ = std::max({momentum_, solved.p_start.norm(), solved.p_end.norm()});
  }
  size_ = (high - low).maxCoeff();
  const double largest = std::max(low.lpNorm<Eigen::Infinity>(), high.lpNorm<Eigen::Infinity>());
  if (!(size_ > 1e-12 * largest)) size_ = largest > 0 ? largest : 1;
  if (!(momentum_ > 0)) momentum_ = size_ / duration_;
}

Junctions::Result Junctions::run() {
  Trial trial{parts_, std::vector<SolvedArc>(parts_.size()), {}};
  const int last = static_cast<int>(parts_.size()) - 1;
  if (!place(state_, trial.parts)) {
    message_ = "a junction could not be moved onto the inequalities that are held there";
    return Result::failed;
  }
  if (!solve(trial, 0, last)) return Result::failed;
  residual_ = residual(trial);
  parts_ = std::move(trial.parts);
  solved_ = std::move(trial.solved);
  measure();
  movement_ = mismatch_ = 0;
  if (unknowns() == 0) return Result::matched;
  const double wanted = settled_share * arcs_.options().tolerance,
               enough = enough_share * arcs_.options().tolerance;
  bool useful = false, exact = false;  // the derivatives there are: not far off; not updated
  for (int k = 0; k < most_steps; ++k) {
    mismatch_ = residual_.norm() / momentum_;
    if (arcs_.options().deadline.passed()) break;
    if (!useful) {
      if (!differentiate()) return Result::failed;
      useful = exact = true;
    }
    const VectorXd step = newton_step();
    movement_ = movement_of(step);
    // Times as well: they change the path in second order only.
    const double change_left = step.lpNorm<Eigen::Infinity>();
    if (mismatch_ <= matched || change_left <= wanted) return Result::matched;
    double factor = longest_step(step);
    const double before = residual_.norm();
    bool nearer = false;
    for (; factor >= least_damping && !nearer; factor /= 2) {
      trial = {parts_, solved_, {}};
      State state = moved(factor * step);
      if (!place(state, trial.parts) || !solve(trial, 0, last)) continue;
      trial.residual = residual(trial);
      if (!(trial.residual.norm() < (1 - 0.1 * factor) * before)) continue;
      nearer = true;
      state_ = std::move(state);
      break;
    }
    if (!nearer) {
      if (change_left <= enough) return Result::matched;
      if (!exact) {
        useful = false;
        continue;
      }
      for (std::size_t i = 0; i < parts_.size(); ++i)
        if (parts_[i].to - parts_[i].from < 0.02 * duration_ && longest_step(step) < 1) {
          collapsed_ = static_cast<int>(i);
          return Result::collapsed;
        }
      if (message_.empty()) message_ = "the momenta of neighbouring arcs could not be made to agree";
      return Result::failed;
    }
    message_.clear();
    const VectorXd change = trial.residual - residual_, taken = factor * step;
    // Broyden's update serves as long as steps converge fast.
    slopes_ += (change - slopes_ * taken) * taken.transpose() / taken.squaredNorm();
    useful = factor == 1 && trial.residual.norm() < 0.1 * before;
    exact = false;
    parts_ = std::move(trial.parts);
    solved_ = std::move(trial.solved);
    residual_ = std::move(trial.residual);
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (parts_.size() > 1 && parts_[i].to - parts_[i].from < shortest_arc * duration_) {
        collapsed_ = static_cast<int>(i);
        return Result::collapsed;
      }
  }
  message_ = "the momenta of neighbouring arcs could not be made to agree";
  return Result::failed;
}

}  // namespace extremal
