#include "solve/branch/diagram.hpp"

#include <utility>

#include "problem/copies.hpp"
#include "solution/in_phase_space.hpp"
#include "solution/on_manifold.hpp"
#include "solution/one_copy.hpp"
#include "solve/branch/other_branches.hpp"
#include "solve/guess/hamilton_path.hpp"
#include "solve/periodic/doubled_orbit.hpp"

namespace extremal {

namespace {

/// The family of the orbits run through twice.
ProblemFamily doubled(const ProblemFamily& family) {
  ProblemFamily twice = family;
  twice.problem = make_problem(doubled(family.problem));
  twice.half = [at = family.at, map = closing_map(family.problem)](double value) {
    const std::optional<Problem> problem = at ? at(value) : std::nullopt;
    return problem ? closing_map(*problem) : map;
  };
  if (family.varied == Varied::duration) {
    twice.from *= 2;
    twice.to *= 2;
  }
  if (family.at)
    twice.at = [at = family.at, duration = family.problem.duration.value](double parameter) {
      std::optional<Problem> problem = at(parameter);
      if (problem && problem->duration.free) problem->duration.value = duration;
      if (problem) problem = doubled(*problem);
      return problem;
    };
  return twice;
}

/// The same problem for another duration, where that is not free.
Problem lasting(const Problem& problem, double duration) {
  Problem result = problem;
  result.duration.value = duration;
  return result;
}

/// The family with its duration a parameter like others: for forces, and where the energy is that of rest at
/// all durations, so that it closes no equations.
ProblemFamily by_parameter(ProblemFamily family) {
  if (family.varied != Varied::duration) return family;
  family.varied = Varied::parameter;
  family.at = [problem = family.problem](double duration) -> std::optional<Problem> {
    if (!(duration > 0)) return std::nullopt;
    return lasting(problem, duration);
  };
  return family;
}

/// The family of problems of two copies.
ProblemFamily family_of_pairs(const ProblemFamily& family) {
  ProblemFamily pairs = family;
  pairs.problem = *family.problem.pair;
  pairs.at = [at = family.at](double parameter) {
    std::optional<Problem> problem = at(parameter);
    if (problem) problem = pair_of(*problem);
    return problem;
  };
  return pairs;
}

}  // namespace

Diagram::Diagram(ProblemFamily family, ContinuationOptions options)
    : family_(std::move(family)), options_(std::move(options)) {
  if (family_.problem.pair) {
    with_forces_ = by_parameter(std::move(family_));
    family_ = family_of_pairs(*with_forces_);
  }
  if (family_.problem.phase)
    if (std::optional<Problem> near = near_hamilton_path(family_.problem, options_.solve.deadline)) {
      near->reduction = family_.problem.reduction;
      family_.problem = *std::move(near);
    }
  current_.emplace(family_, options_);
  branches_.emplace_back();
}

bool Diagram::advance() {
  while (to_next_point()) {
    point_ = current_->point();
    state_in_coordinates_of_scene();
    if (point_.solution.converged()) {
      point_.branch = static_cast<int>(branches_.size()) - 1;
      ++branches_.back().points;
      if (const std::optional<BranchStart>& start = current_->start()) find_others(*start);
      const PointKind kind = point_.kind;
      if (branches_.size() > 1)
        not_followed_ += kind == PointKind::branch || kind == PointKind::period_doubling;
      ++count_;
      return true;
    }
    BranchRecord& record = branches_.back();
    record.end = record.points > 0 ? BranchEnd::limit : BranchEnd::not_started;
    record.message = point_.solution.message;
    if (!begin_next()) current_.reset();
  }
  return false;
}

/// False where all branches have ended.
bool Diagram::to_next_point() {
  while (current_ && !current_->advance()) {
    if (count_ == 0 && current_->singular_at_first() && family_.varied == Varied::duration) {
      family_ = by_parameter(std::move(family_));
      current_.emplace(family_, options_);
      continue;
    }
    note();
    if (!begin_next()) current_.reset();
  }
  if (!current_) return false;
  note();
  return true;
}

/// What was found for two copies, in phase space or with constraints. A path off these is no solution.
void Diagram::state_in_coordinates_of_scene() {
  const ProblemFamily& own = with_forces_ ? *with_forces_ : family_;
  const bool other = own.varied == Varied::parameter;
  const bool needed = with_forces_ || own.problem.phase || own.problem.manifold;
  const std::optional<Problem> there = needed && other ? own.at(point_.parameter) : std::nullopt;
  const Problem& problem = there ? *there : own.problem;
  if (with_forces_) point_.solution = one_copy(problem, std::move(point_.solution), nullptr);
  if (problem.phase) observe_in_phase_space(problem, point_.solution);
  if (problem.manifold) move_onto_manifold(problem, point_.solution);
}

void Diagram::note() {
  BranchRecord& record = branches_.back();
  record.end = current_->end();
  record.message = current_->message();
  if (record.end != BranchEnd::none && not_followed_ > 0)
    record.message +=
        "; what begins at its own branch points and period doublings is not followed: begin another family "
        "with one of its points";
  if (with_forces_)
    record.worst_action_slope.reset();
  else
    record.worst_action_slope = current_->worst_action_slope();
  record.worst_momentum = current_->worst_momentum();
}

void Diagram::find_others(const BranchStart& start) {
  const bool twice = start.kind == PointKind::period_doubling;
  const OtherBranches others = other_branches(twice ? doubled(family_) : family_, options_.solve, start);
  for (const FirstState& first : others.found) waiting_.push_back({count_, first, twice});
  if (!others.complete) waiting_.push_back({.origin = count_});
}

bool Diagram::begin_next() {
  ContinuationOptions options = options_;
  options.other_branches = false;
  const Deadline& deadline = options.solve.deadline;
  while (!waiting_.empty()) {
    Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    BranchRecord& record = branches_.emplace_back();
    not_followed_ = 0;
    record.origin = next.origin;
    if (deadline.passed()) {
      record.end = BranchEnd::budget;
      record.message = deadline.budget_text() + " (solve.budget) is spent; raise it";
      waiting_.clear();
    } else if (!next.first) {
      record.end = BranchEnd::not_started;
      record.message = "no other branch was found where the equations are singular; others may begin there";
    } else {
      current_.emplace(next.twice ? doubled(family_) : family_, options, *std::move(next.first));
      return true;
    }
  }
  return false;
}

}  // namespace extremal
