#include "solve/search/pursuit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "solve/adapt/others_to_try.hpp"
#include "solve/external/external_solver.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/newton/ends.hpp"
#include "solve/periodic/equilibrium.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

Pursuit::Pursuit(const Problem& posed, const SolveOptions& how, Workspace& workspace)
    : problem(posed), options(how), w(workspace), refinement(posed, how, workspace, outcome) {
  std::swap(path, w.spare);
}

Pursuit::~Pursuit() { std::swap(path, w.spare); }

const ElementTables& Pursuit::open(const std::vector<double>& mesh, int degree) {
  refinement.open(mesh, degree);
  return tables();
}

bool Pursuit::collapsed() const { return shrank(problem, scales(path, tables()).range, outcome.first_range); }

Pursuit::Result Pursuit::pursue(const char* strategy) {
  outcome.strategy = strategy;
  outcome.elsewhere = strategy != newton_from_guess;
  run_external_solver(options.method, problem, tables(), path, options.deadline,
                      [this] { return refinement.count_step(); });
  Refinement::Result result = refinement.pursue();
  // A path far from the guess may be wild, and resolved by accident only. A minimiser is none.
  const auto minimal = [&] {
    return !problem.paired && !problem.phase && w.iteration.model().inertia(0).negative == 0;
  };
  const bool far = ran_away(problem, magnitude_, scales(path, tables()).magnitude);
  if (result == Refinement::Result::converged && far && problem.periodic) {
    outcome.message = "the orbit moved far away, to where forces vanish";
    result = Refinement::Result::failed;
  } else if (result == Refinement::Result::converged && outcome.elsewhere &&
             ((far && !minimal()) || !refinement.holds_on_other_elements())) {
    unheld_ = path;
    result = Refinement::Result::failed;
  }
  outcome.elsewhere = outcome.elsewhere || far;
  if (collapsed()) {
    outcome.message = shrank_to_rest;
    met_equilibrium_ = true;
    result = Refinement::Result::failed;
  }
  const bool converged = result == Refinement::Result::converged;
  const bool doubtful = converged ? !refinement.confirmed() : refinement.suspicious();
  // Neither a closed orbit nor one to infinity has ends that could be conjugate.
  const auto doubted = !problem.has_ends() ? Refinement::Result::failed : Refinement::Result::unreachable;
  if (converged && doubtful) return {doubted, doubtful};
  return {converged && acceptance_ ? judge() : result, doubtful};
}

bool Pursuit::found(const char* strategy) {
  if (exhausted()) return false;
  meet_ends(problem, path);
  return pursue(strategy).converged();
}

bool Pursuit::refine(const ElementTables& tables, const char* strategy) {
  refinement.take(tables);
  return conclude(found(strategy));
}

bool Pursuit::conclude(bool converged) {
  outcome.status = converged ? Status::converged : Status::not_converged;
  return converged;
}

Refinement::Result Pursuit::judge() {
  outcome.status = Status::converged;
  Acceptance::Verdict verdict = acceptance_->judge(outcome);
  for (int cut = 0; verdict == Acceptance::Verdict::coarse && cut < limits::search::most_cuts; ++cut) {
    refinement.rebind();
    if (refinement.pursue_with_ends_at(acceptance_->finer_at()) != Refinement::Result::converged) break;
    verdict = acceptance_->judge(outcome);
  }
  if (verdict == Acceptance::Verdict::accepted) return Refinement::Result::converged;
  outcome.status = Status::not_converged;
  refinement.rebind();
  if (acceptance_->too_loose()) refinement.allow(0);
  return verdict == Acceptance::Verdict::hopeless ? Refinement::Result::unreachable
                                                  : Refinement::Result::failed;
}

void Pursuit::measure_first_path() {
  const Scales size = scales(path, tables());
  magnitude_ = size.magnitude;
  if (!problem.has_ends()) outcome.first_range = size.range;
  const double unknowns = static_cast<double>(tables().unknowns()) * path.elements();
  const double by_work = std::max(limits::search::least_steps, limits::search::most_work / unknowns);
  allowance_ = std::min({options.max_iterations, limits::search::most_steps, static_cast<int>(by_work)});
  refinement.allow(allowance_);
}

void Pursuit::be_like(const Pursuit& other) {
  magnitude_ = other.magnitude_;
  outcome.first_range = other.outcome.first_range;
  allowance_ = other.allowance_;
}

void Pursuit::renew(double share) { refinement.allow(static_cast<int>(share * allowance_), share); }

void Pursuit::return_to_unheld() {
  if (unheld_) std::swap(path, *unheld_);
}

const Outcome& Pursuit::unless_spent() {
  if (outcome.status == Status::converged || !options.deadline.passed()) return outcome;
  outcome.status = Status::iteration_limit;
  outcome.message = fmt::format("{} (solve.budget) is spent, in Newton steps: {}; raise it, or try {}",
                                options.deadline.budget_text(), outcome.iterations,
                                others_to_try(problem, "a better guess", "a shorter duration"));
  return outcome;
}

}  // namespace extremal
