#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/dense.hpp"
#include "solve/contact/junctions.hpp"
#include "solve/contact/limits.hpp"

/// \file Newton's method for junctions.

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

/// By derivatives where the path is now.
bool Junctions::singular() {
  if (unknowns() == 0 || residual_.size() == 0 || !differentiate()) return false;
  const SingularValues svd = singular_value_decomposition(slopes_);
  return svd.values[svd.values.size() - 1] < singular_rank * svd.values[0];
}

/// A step of the ends, the constants, then of the point and the time of each junction: in units of size and
/// duration. A point moves along the path with its time.
Junctions::State Junctions::moved(const VectorXd& step) const {
  State state = state_;
  state.ends += ends_.scaled(step.head(ends_.unknowns()));
  state.constants += constant_units_.cwiseProduct(step.segment(ends_.unknowns(), constant_count()));
  Index at = first_of_junctions();
  for (int j = 0; j < count(); ++j) {
    const MatrixXd directions = basis(j);
    state.q[j] += directions * (size_ * step.segment(at, directions.cols()));
    at += directions.cols();
    if (!timed(j)) continue;
    const double later = duration_ * step[at++];
    state.q[j] += later * solved_[j].v_end;
    state.t[j] += later;
  }
  return state;
}

/// A displacement that is small against the arcs beside it.
double Junctions::difference_at(int junction) const {
  const double shorter = std::min(parts_[junction].to - parts_[junction].from,
                                  parts_[junction + 1].to - parts_[junction + 1].from);
  return std::min(difference, difference_share * shorter / duration());
}

bool Junctions::differentiate() {
  const int all = unknowns(), last = static_cast<int>(parts_.size()) - 1;
  slopes_ = MatrixXd::Zero(residual_.size(), all);
  int column = 0;
  const auto take = [&](bool first_moves, bool last_moves, int junction, bool all_move = false) {
    VectorXd step = VectorXd::Zero(all);
    const double by = junction < 0 ? difference : difference_at(junction);
    step[column] = by;
    Trial trial{moved(step), parts_, solved_, {}};
    if (!place(trial.state, trial.parts)) return false;
    if (all_move) {
      if (!solve(trial, 0, last)) return false;
    } else {
      if (first_moves && !solve(trial, 0, 0)) return false;
      if (last_moves && !(first_moves && last == 0) && !solve(trial, last, last)) return false;
    }
    if (junction >= 0 && !solve(trial, junction, junction + 1)) return false;
    slopes_.col(column++) = (residual(trial) - residual_) / by;
    return true;
  };
  for (int f = 0; f < ends_.coordinates(); ++f)
    if (!take(ends_.moves(f, false), ends_.moves(f, true), -1)) return false;
  if (ends_.free_duration() && !take(false, true, -1)) return false;
  for (int i = 0; i < ends_.multipliers(); ++i)
    if (!take(false, false, -1)) return false;
  for (int i = 0; i < constant_count(); ++i)
    if (!take(true, true, -1, true)) return false;
  for (int j = 0; j < count(); ++j)
    for (Index c = 0; c < directions(j) + (timed(j) ? 1 : 0); ++c)
      if (!take(false, false, j)) return false;
  return true;
}

VectorXd Junctions::newton_step() {
  const SingularValues svd = singular_value_decomposition(slopes_);
  VectorXd step = VectorXd::Zero(slopes_.cols());
  range_ = svd.u;
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
  Index at = first_of_junctions();
  for (int j = 0; j < count(); ++j) {
    at += directions(j);
    if (timed(j)) later[j + 1] = duration_ * step[at++];
  }
  if (ends_.free_duration()) later.back() = duration_ * step[ends_.coordinates()];
  double factor = 1;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const double change = later[i + 1] - later[i], length = parts_[i].to - parts_[i].from;
    if (change < -(1 - shortest_step) * length)
      factor = std::min(factor, -(1 - shortest_step) * length / change);
  }
  return factor;
}

/// With the duration, q at a time moves as fast as the path.
double Junctions::movement_of(const VectorXd& step) const {
  double most = 0;
  const int free = ends_.coordinates();
  if (free > 0) most = step.head(free).lpNorm<Eigen::Infinity>();
  if (ends_.free_duration()) most = std::max(most, std::abs(step[free]) * duration_ * speed_ / size_);
  if (constant_count() > 0)
    most = std::max(most, step.segment(ends_.unknowns(), constant_count()).lpNorm<Eigen::Infinity>());
  Index at = first_of_junctions();
  for (int j = 0; j < count(); ++j) {
    const Index columns = directions(j);
    if (columns > 0) most = std::max(most, step.segment(at, columns).norm());
    at += columns + (timed(j) ? 1 : 0);
  }
  return most * size_;
}

/// The first arc shorter than this part of the duration; −1: there is none.
int Junctions::shrunken(double part) const {
  for (std::size_t i = 0; i < parts_.size() && parts_.size() > 1; ++i)
    if (parts_[i].to - parts_[i].from < part * duration()) return static_cast<int>(i);
  return -1;
}

/// The arcs of the first state.
bool Junctions::start() {
  Trial trial{state_, parts_, std::vector<SolvedArc>(parts_.size()), {}};
  if (!place(trial.state, trial.parts)) {
    message_ = "a junction could not be moved onto the inequalities that are held there";
    return false;
  }
  if (!solve(trial, 0, static_cast<int>(parts_.size()) - 1)) return false;
  state_ = trial.state;
  parts_ = trial.parts;
  solved_ = trial.solved;
  measure();
  residual_ = residual(trial);
  return true;
}

/// One arc that is the whole of a closed path.
bool Junctions::solve_closed() {
  PathArc& arc = parts_.front();
  const VectorXd ends = ends_.ends(state_.ends);
  arc.start = ends.head(n_);
  arc.end = ends.tail(n_);
  solved_ = {arcs_.solve_closed(arc)};
  if (!solved_.front().found) {
    message_ = solved_.front().message;
    return false;
  }
  arc.to = solved_.front().trajectory.duration();
  measure();
  return true;
}

/// Whether the equations of the ends and of the constants hold, and a step solves them; false where nothing
/// that is unknown changes one of them.
bool Junctions::conditions_hold(const VectorXd& step) {
  const Index rows = first_of_junctions();
  const double missed = (residual_ + slopes_ * step).head(rows).norm(), now = residual_.head(rows).norm();
  const double allowed = arcs_.options().tolerance * momentum_;
  if (now <= allowed && (missed <= disagreeing * now || missed <= enough_share * allowed)) return true;
  message_ = "the conditions at the ends, or for the unknowns, do not hold there";
  return false;
}

/// Whether a part of a step brings the momenta nearer to each other.
bool Junctions::take_step(const VectorXd& step, double factor, Trial& trial) {
  trial = {moved(factor * step), parts_, solved_, {}};
  if (!place(trial.state, trial.parts) || !solve(trial, 0, static_cast<int>(parts_.size()) - 1)) return false;
  trial.residual = residual(trial);
  return reducible(trial.residual) < (1 - 0.1 * factor) * reducible(residual_);
}

Junctions::Result Junctions::run() {
  /// An arc that steps make shorter than this part of the duration will have no length.
  constexpr double vanishing_arc = 0.02;
  const bool closed = problem_.periodic && parts_.size() == 1 && !problem_.extension;
  if (!(closed ? solve_closed() : start())) return Result::failed;
  movement_ = mismatch_ = 0;
  if (closed || unknowns() == 0) return Result::matched;
  const double wanted = converged_share * arcs_.options().tolerance,
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
    // More equations than unknowns that do not agree: contacts begin, or end, one after the other.
    const double remains = (residual_ + slopes_ * step).norm();
    if (remains > disagreeing * residual_.norm() && find_changes()) return Result::simultaneous;
    movement_ = movement_of(step);
    // Times as well: they change the path in second order only.
    const double change_left = step.lpNorm<Eigen::Infinity>();
    if (mismatch_ <= matched) return Result::matched;
    if (change_left <= wanted) return conditions_hold(step) ? Result::matched : Result::failed;
    Trial trial;
    double factor = longest_step(step);
    bool nearer = false;
    while (factor >= least_damping && !nearer) {
      nearer = take_step(step, factor, trial);
      if (!nearer) factor /= 2;
    }
    if (!nearer) {
      if (change_left <= enough) return conditions_hold(step) ? Result::matched : Result::failed;
      if (!exact) {
        useful = false;
        continue;
      }
      if (longest_step(step) < 1 && (collapsed_ = shrunken(vanishing_arc)) >= 0) return Result::collapsed;
      if (message_.empty()) message_ = "the momenta of neighbouring arcs could not be made to agree";
      return Result::failed;
    }
    message_.clear();
    const VectorXd change = trial.residual - residual_, taken = factor * step;
    // Broyden's update serves as long as steps converge fast.
    slopes_ += (change - slopes_ * taken) * taken.transpose() / taken.squaredNorm();
    useful = factor == 1 && reducible(trial.residual) < 0.1 * reducible(residual_);
    exact = false;
    state_ = std::move(trial.state);
    parts_ = std::move(trial.parts);
    solved_ = std::move(trial.solved);
    residual_ = std::move(trial.residual);
    if ((collapsed_ = shrunken(shortest_arc)) >= 0) return Result::collapsed;
  }
  message_ = "the momenta of neighbouring arcs could not be made to agree";
  return Result::failed;
}

}  // namespace extremal
