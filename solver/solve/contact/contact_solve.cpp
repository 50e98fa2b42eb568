#include "solve/contact/contact_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "solution/path_contacts.hpp"
#include "solve/contact/contact_check.hpp"
#include "solve/contact/first_paths.hpp"
#include "solve/contact/intervals.hpp"
#include "solve/contact/joined_path.hpp"
#include "solve/contact/limits.hpp"
#include "solve/search/distinct.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Clock = std::chrono::steady_clock;

/// A coarse path as points at its times.
Guess guess_of(const CoarseAction& action, const std::vector<double>& z) {
  Guess guess;
  for (int k = 0; k <= action.elements(); ++k)
    guess.tau.push_back(static_cast<double>(k) / action.elements());
  guess.q = z;
  return guess;
}

/// Nodes of a path between those of a coarser one.
std::vector<double> finer(const Guess& guess, int n, int elements) {
  std::vector<double> z((elements + 1) * n);
  for (int k = 0; k <= elements; ++k)
    guess.at(static_cast<double>(k) / elements, {z.data() + k * n, static_cast<std::size_t>(n)});
  return z;
}

/// One start of the search for a minimiser.
class ContactSearch {
 public:
  /// With `several`, whether a solution belongs to a continuum.
  ContactSearch(const Problem& problem, const SolveOptions& options, const ArcSolve& solve, bool several)
      : problem_(problem),
        options_(options),
        solve_(solve),
        arcs_(problem, options, solve),
        several_(several) {}

  /// From the nodes of a path of the coarsest elements.
  Solution run(std::vector<double> z) {
    for (const int elements : coarse_elements) {
      if (options_.deadline.passed()) break;
      const CoarseAction action(problem_, elements);
      if (elements * problem_.coordinates() > most_unknowns && elements != coarse_elements[0]) break;
      if (guess_.given()) z = finer(guess_, problem_.coordinates(), elements);
      const MinimumReport report = minimise(action.minimum(), z, options_.deadline);
      if (!report.converged) {
        refuse(report.unbounded ? Status::no_solution_near : Status::not_converged,
               report.unbounded
                   ? "no local minimiser is near: the action has no lower bound along paths that begin at "
                     "the guess. A free path that is longer than a window is no minimiser; shorten the "
                     "duration, or give inequalities that bound the path"
                   : "no local minimiser was found near the guess: the interior point method did not "
                     "converge. If the path is longer than a window and free of contact, there is none; "
                     "shorten the duration, or give another guess");
        if (report.unbounded) break;
        continue;
      }
      guess_ = guess_of(action, z);
      if (std::optional<Solution> found = join(intervals_of(problem_, action, z, report.multipliers)))
        return *std::move(found);
      if (saddle_) break;
    }
    if (options_.deadline.passed()) {
      failure_.status = Status::iteration_limit;
      failure_.message =
          fmt::format("stopped after {}; {}", options_.deadline.budget_text(), failure_.message);
    }
    failure_.iterations = arcs_.iterations();
    return std::move(failure_);
  }

  /// Whether what was found last is stationary, but no minimum.
  bool saddle() const { return saddle_; }
  /// Whether momenta do not determine all junctions of what was found: it belongs to a continuum.
  bool singular() const { return singular_; }

 private:
  /// Arcs of these intervals, which change until the law holds. Nothing where it does not.
  std::optional<Solution> join(std::vector<Interval> intervals) {
    PathPoints path = [this](double t, std::span<double> q) { guess_.at(t / problem_.duration.value, q); };
    std::optional<Junctions> junctions, before;
    for (int k = 0; k < most_changes && !options_.deadline.passed(); ++k) {
      tidy(intervals, problem_.duration.value);
      junctions.emplace(arcs_, intervals, path);
      const Junctions::Result result = junctions->run();
      if (result == Junctions::Result::collapsed) {
        leave_out(intervals, junctions->collapsed(), problem_.duration.value);
        continue;
      }
      if (result == Junctions::Result::failed) {
        refuse(Status::not_converged, "no local minimiser was found near the guess: " + junctions->message() +
                                          "; give another guess, or fewer inequalities");
        return std::nullopt;
      }
      if (const int pulling = pulled_touch(*junctions); pulling >= 0) {
        intervals[pulling + 1].touched = -1;
        continue;
      }
      const std::optional<Violation> violation = worst_violation(arcs_, *junctions);
      if (!violation) return accept(*junctions);
      refuse(Status::not_converged, describe(*violation));
      for (std::size_t i = 0; i < intervals.size(); ++i) {
        intervals[i].from = junctions->arcs()[i].from;
        intervals[i].to = junctions->arcs()[i].to;
      }
      before.emplace(*std::move(junctions));
      path = [&before](double t, std::span<double> q) { point_of(*before, t, q); };
      change(intervals, violation->constraint, violation->forbidden, violation->from, violation->to,
             problem_.duration.value);
    }
    return std::nullopt;
  }

  /// A touch whose impulse is negative; −1: there is none.
  static int pulled_touch(const Junctions& path) {
    for (std::size_t j = 0; j < path.touched().size(); ++j)
      if (path.touched()[j] >= 0 && path.impulse(static_cast<int>(j)) < 0) return static_cast<int>(j);
    return -1;
  }

  static void point_of(const Junctions& path, double t, std::span<double> q) {
    std::size_t i = 0;
    while (i + 1 < path.arcs().size() && t >= path.arcs()[i].to) ++i;
    const Trajectory& trajectory = path.solved()[i].trajectory;
    std::vector<double> v(q.size());
    trajectory.at(std::clamp(t - path.arcs()[i].from, 0.0, trajectory.duration()), q, v);
  }

  std::string describe(const Violation& violation) const {
    const std::string& text = problem_.inequalities->texts[violation.constraint];
    return violation.forbidden
               ? fmt::format(
                     "the path found does not keep '{}' near t = {:.6g}, by {:.1e}; give another guess", text,
                     (violation.from + violation.to) / 2, violation.amount)
               : fmt::format("the path found is pulled by '{}' near t = {:.6g}; give another guess", text,
                             (violation.from + violation.to) / 2);
  }

  std::optional<Solution> accept(Junctions& path) {
    if (path.arcs().size() == 1 && path.arcs().front().held.empty()) return accept_free(path);
    if (!is_minimum(arcs_, path)) {
      saddle_ = true;
      refuse(Status::no_solution_near,
             "no local minimiser is near: the path found is stationary, but other paths beside it that keep "
             "the inequalities have less action; give another guess, or shorten the duration");
      return std::nullopt;
    }
    Solution solution = joined_path(arcs_, path);
    singular_ = several_ && path.singular();
    if (solution.error_estimate <= options_.tolerance * path.size()) return solution;
    refuse(Status::not_converged,
           fmt::format("the error of the path is {:.1e}, more than the tolerance allows; times at which "
                       "contacts begin amplify roundoff. Give a larger tolerance",
                       solution.error_estimate));
    return std::nullopt;
  }

  /// An extremal that no inequality touches, by itself.
  std::optional<Solution> accept_free(const Junctions& path) {
    Problem free = problem_;
    free.inequalities = nullptr;
    free.guess = extremal::guess_of(path.solved().front().trajectory);
    Solution solution = solve_(free, options_);
    solution.iterations += arcs_.iterations();
    auto contacts = std::make_shared<PathContacts>();
    contacts->constraints = problem_.inequalities->count();
    contacts->arcs.push_back({0, problem_.duration.value, {}, nullptr});
    solution.contacts = std::move(contacts);
    if (!solution.converged()) {
      failure_ = std::move(solution);
      return std::nullopt;
    }
    if (solution.morse_index ? *solution.morse_index == 0 : is_minimum(arcs_, path)) {
      solution.message += "; no contact";
      return solution;
    }
    saddle_ = true;
    std::string window;
    if (!solution.windows.empty())
      window = fmt::format(", whose first ends at t = {:.6g}", solution.windows.front()[1]);
    refuse(Status::no_solution_near,
           fmt::format("no local minimiser is near: the extremal found is free of contact and longer than a "
                       "window{}, so it does not minimise the action; shorten the duration, or give "
                       "inequalities that bound the path",
                       window));
    return std::nullopt;
  }

  void refuse(Status status, std::string message) {
    failure_ = {};
    failure_.status = status;
    failure_.message = std::move(message);
  }

  const Problem& problem_;
  const SolveOptions& options_;
  const ArcSolve& solve_;
  Arcs arcs_;
  bool several_;
  Guess guess_;
  Solution failure_;
  bool singular_ = false, saddle_ = false;
};

/// Whether two paths are nearly the same, or belong to one continuum.
bool same(const Solution& a, bool singular_a, const Solution& b, bool singular_b, int n) {
  constexpr int points = 64;
  constexpr double apart = 1e-6;
  const double size = std::max(std::abs(a.action), std::abs(b.action));
  if (std::abs(a.action - b.action) > apart * size) return false;
  if (singular_a && singular_b) return true;
  std::vector<double> p(n), q(n), v(n);
  double distance = 0, extent = 0;
  for (int k = 0; k <= points; ++k) {
    const double t = k == points ? a.duration() : a.duration() * k / points;
    a.trajectory.at(t, p, v);
    b.trajectory.at(t, q, v);
    for (int i = 0; i < n; ++i) {
      distance = std::max(distance, std::abs(p[i] - q[i]));
      extent = std::max({extent, std::abs(p[i]), std::abs(q[i])});
    }
  }
  return distance <= apart * extent;
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

Solution solve_with_inequalities(const Problem& problem, const SolveOptions& options, const ArcSolve& solve) {
  const auto start = Clock::now();
  const CoarseAction action(problem, coarse_elements[0]);
  ContactSearch search(problem, options, solve, false);
  Solution solution = search.run(first_path(problem, action));
  // From a path that is symmetric, the method may come to a saddle: beside it there are minima. The steps of
  // a coarse path may also lead through what is forbidden.
  const bool bounded = search.saddle() || solution.status == Status::not_converged;
  for (int number = 0; !solution.converged() && bounded && number < most_bends && !options.deadline.passed();
       ++number)
    if (const std::optional<std::vector<double>> z = bent_path(problem, action, number)) {
      ContactSearch beside(problem, options, solve, false);
      Solution other = beside.run(*z);
      if (!other.converged()) continue;
      solution = std::move(other);
    }
  solution.seconds_solve = seconds_since(start) - solution.seconds_analyse;
  return solution;
}

std::vector<Solution> minimisers(const Problem& problem, const SolveOptions& options, int most,
                                 const ArcSolve& solve) {
  const auto start = Clock::now();
  const CoarseAction action(problem, coarse_elements[0]);
  std::vector<Solution> found;
  std::vector<char> singular;
  Solution failure;
  int vain = 0, tried = 0;
  for (int number = -1; number < bent_paths(problem); ++number) {
    if (static_cast<int>(found.size()) >= most || vain >= most_in_vain || options.deadline.passed()) break;
    const std::optional<std::vector<double>> z =
        number < 0 ? first_path(problem, action) : bent_path(problem, action, number);
    if (!z) continue;
    ++tried;
    ContactSearch search(problem, options, solve, true);
    Solution solution = search.run(*z);
    ++vain;
    if (!solution.converged()) {
      if (number < 0) failure = std::move(solution);
      continue;
    }
    bool known = false;
    for (std::size_t i = 0; i < found.size() && !known; ++i)
      known = same(found[i], singular[i] != 0, solution, search.singular(), problem.coordinates());
    if (known) continue;
    vain = 0;
    solution.seconds_solve = seconds_since(start);
    found.push_back(std::move(solution));
    singular.push_back(search.singular());
  }
  if (found.empty()) return {std::move(failure)};
  sort_by_action(found);
  if (static_cast<int>(found.size()) < most)
    found.front().message += fmt::format("; {} of {} local minimisers wanted were found from {} first paths",
                                         found.size(), most, tried);
  return found;
}

}  // namespace extremal
