#include "solve/fit/whole_path.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/copies.hpp"
#include "solve/fit/fitted_path.hpp"
#include "solve/fit/limits.hpp"
#include "solve/fit/members.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/frequency.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

using namespace limits::fit;

namespace {

/// A path and values of the unknowns, and the step from them.
struct Iterate {
  FittedProblem at;
  ElementTables tables;
  Path path;
  std::vector<double> values;
  Step step;                    ///< of the path
  std::vector<double> changes;  ///< of the values
  double length = 0;            ///< of both, relative
};

class WholePath {
 public:
  WholePath(const FitTask& task, const SolveOptions& options, int degree)
      : task_(task),
        options_(options),
        scheme_(options.scheme ? *options.scheme : lobatto(degree), exact_points),
        observer_(task.data, task.coordinates) {}

  std::optional<FirstFit> from(const FirstFit& first) {
    Iterate here, next;
    if (!begin(first, here) || !solve(here)) return std::nullopt;
    for (double damping = 1; here.length > short_step; damping = std::min(1.0, 2 * damping)) {
      while (!advance(here, damping, next) || next.length > (1 - damping / 4) * here.length) {
        damping /= 2;
        if (damping < strongest_damping || options_.deadline.passed()) return std::nullopt;
      }
      std::swap(here, next);
    }
    const Trajectory trajectory = first_copy(trajectory_of(here.path), task_.coordinates);
    return FirstFit{std::move(here.values), guess_of_elements(trajectory), trajectory.duration(),
                    first.iterations + iterations_};
  }

 private:
  /// The guess on elements that follow the frequency along it.
  bool begin(const FirstFit& fit, Iterate& first) {
    first.values = fit.values;
    if (!bind(first)) return false;
    Problem problem = first.at.problem;
    problem.guess = problem.paired ? guess_of_both(fit.guess, task_.coordinates) : fit.guess;
    const std::vector<double> ends = starting_ends(problem);
    std::vector<double> mesh = uniform_mesh(sketch_elements);
    put_guess(problem, fit.duration, ends, mesh, first);
    newton_.reset(problem, first.tables, first.path.elements());
    Frequency frequency;
    measure_frequency(problem, newton_.action(), first.tables, first.path, frequency);
    if (!frequency.finite()) return false;
    const double wanted = std::min<double>(frequency.phase() / longest_element, most_elements);
    mesh = frequency.mesh(std::max(sketch_elements, static_cast<int>(std::ceil(wanted))), 1);
    put_guess(problem, fit.duration, ends, mesh, first);
    return true;
  }

  void put_guess(const Problem& problem, double duration, const std::vector<double>& ends,
                 const std::vector<double>& mesh, Iterate& first) {
    first.path.reset(first.tables, mesh, duration);
    start_path(problem, ends, first.tables, first.path);
  }

  bool bind(Iterate& to) {
    std::optional<FittedProblem> at = task_.at(to.values);
    if (!at) return false;
    to.at = std::move(*at);
    to.tables.bind(scheme_, *to.at.problem.lagrangian);
    return true;
  }

  /// The step of Gauss and Newton.
  bool solve(Iterate& at) {
    ++iterations_;
    const Problem& problem = at.at.problem;
    newton_.reset(problem, at.tables, at.path.elements());
    if (!response_.factor(newton_, problem, at.path, at.tables, at.at.changes)) return false;
    newton_.model().solve(newton_.action(), newton_.closing(at.path), at.step);
    const std::vector<Step> members = moves_of_closed_path(problem, at.path, at.tables);
    const auto unknowns = static_cast<Eigen::Index>(task_.unknowns.size()),
               count = unknowns + std::ssize(members), rows = Eigen::Index{observer_.count()};
    Eigen::VectorXd residuals(rows), by_step(rows);
    Eigen::MatrixXd jacobian(rows, count);
    if (!observer_.residuals(at.path, at.at.formulas, {residuals.data(), static_cast<std::size_t>(rows)}))
      return false;
    const auto differentiate = [&](const Step& step, const ProblemChange& change, double* to) {
      observer_.derivatives(at.path, at.tables, at.at.formulas, step, change, to, 1);
    };
    differentiate(at.step, {}, by_step.data());
    std::vector<Step> responses(unknowns);
    for (Eigen::Index j = 0; j < unknowns; ++j) {
      response_.to(at.at.changes[j], responses[j]);
      differentiate(responses[j], at.at.changes[j], jacobian.col(j).data());
      jacobian.col(j) *= task_.unknowns[j].size;
    }
    for (Eigen::Index j = unknowns; j < count; ++j)
      differentiate(members[j - unknowns], {}, jacobian.col(j).data());
    if (!jacobian.allFinite() || !by_step.allFinite()) return false;
    const Eigen::VectorXd y = least_norm(jacobian, -(residuals + by_step), undetermined);
    at.changes.resize(unknowns);
    at.length = 0;
    for (Eigen::Index j = 0; j < unknowns; ++j) {
      at.changes[j] = y[j] * task_.unknowns[j].size;
      add(at.step, responses[j], at.changes[j]);
    }
    for (Eigen::Index j = unknowns; j < count; ++j) add(at.step, members[j - unknowns], y[j]);
    return measure(at);
  }

  bool measure(Iterate& at) const {
    const double size = scales(at.path, at.tables).q;
    at.length = std::abs(at.step.duration) / at.path.duration();
    for (const double x : at.step.nodes) at.length = std::max(at.length, std::abs(x) / size);
    return std::isfinite(at.length);
  }

  /// A part of the step, and the step from there.
  bool advance(const Iterate& from, double damping, Iterate& to) {
    to.values = from.values;
    for (std::size_t j = 0; j < to.values.size(); ++j) to.values[j] += damping * from.changes[j];
    if (!bind(to)) return false;
    const Duration& asked = to.at.problem.duration;
    const double duration = asked.free ? from.path.duration() + damping * from.step.duration : asked.value;
    if (!(duration > 0)) return false;
    to.path = from.path;
    to.path.add(from.step.nodes, from.step.inner, damping);
    to.path.set_duration(duration);
    meet_ends(to.at.problem, to.path);
    return solve(to);
  }

  const FitTask& task_;
  const SolveOptions& options_;
  SchemeTables scheme_;
  Observer observer_;
  NewtonIteration newton_;
  ExtremalResponse response_;
  int iterations_ = 0;
};

}  // namespace

/// Coarse elements lead there. Where the ends are nearly conjugate, values for them may have no other
/// extremal: so fine ones follow.
std::optional<FirstFit> fit_whole_path(const FitTask& task, const SolveOptions& options) {
  if (!task.at || !task.guess.given()) return std::nullopt;
  std::optional<FirstFit> fit = FirstFit{{}, task.guess, task.duration};
  for (const FitUnknown& unknown : task.unknowns) fit->values.push_back(unknown.start);
  for (const int degree : whole_path_degrees)
    if (fit) fit = WholePath(task, options, degree).from(*fit);
  return fit;
}

}  // namespace extremal
