#include "solve/bordered/bordered_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "machine/clock.hpp"
#include "solve/adapt/element_count.hpp"
#include "solve/adapt/limits.hpp"
#include "solve/bordered/bordered_judge.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/found.hpp"
#include "solve/bordered/jump_scan.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/bordered/minimise.hpp"
#include "solve/bordered/starting_states.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/plan.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

/// Why an attempt found nothing.
struct Failure {
  std::string message;
  Status status = Status::not_converged;
  bool refused = false;  ///< of a path that was found
};

class BorderedSolve {
 public:
  BorderedSolve(const Problem& problem, const SolveOptions& options)
      : problem_(problem),
        extension_(*problem.extension),
        options_(options),
        n_(problem.coordinates()),
        starts_(problem) {
    levels_.bind(extension_.lagrangian);
    own_levels_.bind(problem.lagrangian);
    if (options.scheme) {
      rule_.emplace(*options.scheme, limits::pinned::most_points);
      scheme_.bind(*rule_, *extension_.lagrangian);
      own_scheme_.bind(*rule_, *problem.lagrangian);
    }
  }

  using Same = std::function<bool(const Solution&, const Solution&)>;

  /// From the guess and, as long as fewer are found than are wanted, from others.
  std::vector<Solution> run(int most, const Same& same) {
    const auto start = Clock::now();
    std::vector<Start> starts{{}};
    if (has_targets()) starts.push_back({.led = true});
    if (may_be_minimised(problem_)) starts.push_back({.downhill = true});
    const std::size_t unbent = starts.size();
    std::vector<Solution> found;
    std::optional<Failure> why;
    std::size_t tried = 0;
    for (; tried < starts.size() && !(tried > 0 && spent()); ++tried) {
      if (static_cast<int>(found.size()) >= most) break;
      const Start& from = starts[tried];
      downhill_ = from.downhill;
      refused_ = false;
      equations_.set_offsets({});
      Solution solution = options_.scheme ? solve_with_scheme(from) : solve_adapted(from);
      if (solution.converged()) {
        solution.strategy = from.strategy();
        const auto known = [&](const Solution& other) { return same(other, solution); };
        if (std::ranges::none_of(found, known)) found.push_back(timed(std::move(solution), start));
      } else if (!why || tells_more(*why)) {
        why = Failure{solution.message, solution.status, refused_};
      }
      const bool wanted = static_cast<int>(found.size()) < most;
      if (tried + 1 == unbent && wanted) {
        add_zeros_of_jump(starts);
        if (!extension_.conditions.empty() && problem_.ends.free > 0 && !problem_.periodic)
          for (int k = 0; k < drawn_ends; ++k) starts.push_back({.ends = k});
        add_bent(starts);
      }
    }
    if (found.empty()) return {timed(failure(*why), start)};
    std::ranges::stable_sort(found, {}, &Solution::action);
    if (static_cast<int>(found.size()) < most)
      found.front().message +=
          fmt::format("; {} of {} extremals wanted were found from {} guesses{}; more may exist",
                      found.size(), most, tried, told_spent());
    return found;
  }

 private:
  bool spent() const { return options_.deadline.passed() || iterations_ >= options_.max_iterations; }

  /// What is spent, at the end of a message; empty: nothing.
  std::string told_spent() const {
    if (options_.deadline.passed())
      return fmt::format("; {} (solve.budget) is spent", options_.deadline.budget_text());
    if (spent()) return fmt::format("; {} steps of Newton's method are spent", iterations_);
    return {};
  }

  bool has_targets() const {
    return extension_.multipliers() > 0 || !extension_.conditions.empty() || !extension_.where.empty();
  }

  /// Why a path is no extremal says more than that none was reached.
  bool tells_more(const Failure& known) const {
    return refused_ && !known.refused && known.status == Status::not_converged;
  }

  /// Where a time is free between points that are one, it may become zero; empty: there are none.
  std::string told_equal_points() const {
    const auto end_at = [this](int first) {
      std::vector<std::pair<int, double>> fixed;
      for (int a = 0; a < n_; ++a)
        if (problem_.ends.fixed[first + a]) fixed.emplace_back(a, problem_.ends.offset[first + a]);
      return WaypointCondition{.fixed = std::move(fixed)};
    };
    std::vector<WaypointCondition> points{end_at(0)};
    points.insert(points.end(), extension_.waypoints.begin(), extension_.waypoints.end());
    points.push_back(end_at(n_));
    for (std::size_t k = 1; k < points.size(); ++k) {
      const WaypointCondition &before = points[k - 1], &after = points[k];
      if (!(before.free || after.free) || static_cast<int>(after.fixed.size()) < n_ ||
          before.fixed != after.fixed)
        continue;
      const std::string last = k + 1 < points.size() ? fmt::format("waypoint {}", k) : "the end";
      return fmt::format(
          "; {} is where {} is, and nothing may keep them apart in time: leave one out, or give the "
          "time",
          last, k > 1 ? fmt::format("waypoint {}", k - 1) : "the start");
    }
    return {};
  }

  Solution failure(const Failure& first) const {
    Solution solution;
    solution.status =
        spent() && first.status == Status::not_converged ? Status::iteration_limit : first.status;
    solution.message =
        first.message + told_spent() + told_equal_points() +
        "; no guess with waves added led to a solution; another guess of the path, of the unknowns or of the "
        "duration may";
    return solution;
  }

  Solution timed(Solution solution, Clock::time_point start) const {
    solution.iterations = iterations_;
    solution.seconds_analyse = seconds_analyse_;
    solution.seconds_solve = seconds_since(start) - seconds_analyse_;
    return solution;
  }

  /// Bends of the guess to both sides, that of less action first.
  void add_bent(std::vector<Start>& all) {
    const Elements elements = lobatto(first_degree);
    const LegMesh mesh = starts_.equal_elements(first_elements * starts_.legs());
    for (const BendRow& row : bends)
      for (int seed = 0; seed < row.seeds; ++seed) {
        Start one{row.size, row.first, row.last, static_cast<unsigned>(seed)}, other = one;
        other.size = -row.size;
        if (action_of(mesh, elements, other) < action_of(mesh, elements, one)) std::swap(one, other);
        for (Start& start : {std::ref(one), std::ref(other)}) {
          start.led = has_targets();
          if (start.led) all.push_back(start);
          start.led = false;
          all.push_back(start);
        }
      }
  }

  /// The waypoint of which alone the time is unknown; −1 where there is none.
  int only_free_waypoint() const {
    const auto& all = extension_.waypoints;
    const auto is_free = [](const WaypointCondition& w) { return w.free; };
    const bool others = problem_.periodic || problem_.paired || problem_.duration.free;
    if (others || std::ranges::count_if(all, is_free) != 1) return -1;
    return static_cast<int>(std::ranges::find_if(all, is_free) - all.begin());
  }

  /// Stationary with the times held, on so many elements.
  std::optional<JumpAtTime> solve_held(int waypoint, double time, int elements, const JumpAtTime* near) {
    if (spent()) return std::nullopt;
    const Elements coarse = lobatto(first_degree);
    std::vector<double> times = starts_.times();
    times[waypoint] = time;
    const LegMesh mesh = equal_elements(times, elements);
    Found found = near ? near->found : begin(mesh, coarse, {});
    move_to(found.state, *found.tables, times);
    if (near) found = moved(found, mesh, coarse);
    Failure failure;
    equations_.hold_times(true);
    const bool reached = newton(found, failure);
    equations_.hold_times(false);
    if (!reached || !equations_.evaluate(found.state, false)) return std::nullopt;
    return JumpAtTime{time, equations_.values()[equations_.first_time()], std::move(found)};
  }

  /// Those nearest to the guess first.
  void add_zeros_of_jump(std::vector<Start>& all) {
    const int waypoint = only_free_waypoint();
    if (waypoint < 0) return;
    downhill_ = false;
    equations_.set_offsets({});
    const std::vector<double>& times = starts_.times();
    const double at_guess = times[waypoint];
    int elements = fewest_scan_elements;
    for (; elements < most_scan_elements; elements *= 2) {
      const std::optional<JumpAtTime> first = solve_held(waypoint, at_guess, elements, nullptr);
      if (!first || errors(first->found).q <= way_error * sizes(first->found).q) break;
    }
    const int most = iterations_ + most_scan_steps;
    zeros_ = zeros_of_jump(waypoint > 0 ? times[waypoint - 1] : 0, times[waypoint + 1],
                           [&](double time, const JumpAtTime* near) -> std::optional<JumpAtTime> {
                             if (iterations_ > most) return std::nullopt;
                             return solve_held(waypoint, time, elements, near);
                           });
    std::ranges::stable_sort(zeros_, {},
                             [&](const JumpAtTime& zero) { return std::abs(zero.time - at_guess); });
    for (int k = 0; k < std::ssize(zeros_); ++k) all.push_back({.zero = k});
  }

  /// Of L alone; infinite where it is not finite.
  double action_of(const LegMesh& mesh, const Elements& elements, const Start& start) {
    equations_.reset(problem_, *elements.tables, *elements.own, mesh);
    const bool finite = equations_.evaluate(starts_.at(mesh, elements, start), false);
    return finite ? equations_.action().action() : INFINITY;
  }

  Elements lobatto(int degree) { return {&levels_.at(degree), &own_levels_.at(degree)}; }

  bool newton(Found& found, Failure& failure) {
    equations_.reset(problem_, *found.tables, *found.own, found.state.mesh);
    const auto told = [&](double step, double damping) {
      ++iterations_;
      cost_ += found.state.path.batches() * batch_cost(*found.tables, found.state.path.degree());
      if (options_.progress)
        options_.progress(
            {found.state.mesh.elements(), found.state.path.degree(), equations_.residual(), step, damping});
    };
    const auto stop = [&] { return spent(); };
    if (downhill_ && !minimise(equations_, found.state, stop, told)) {
      failure = {"the action has no minimum near the guess"};
      return false;
    }
    const BorderedReport report = converge(equations_, found.state, stop, told);
    found.correction = report.correction;
    failure = {report.failure};
    return report.converged && is_balanced(found, failure);
  }

  /// Steps across null directions leave a force along them where no solution is near: other elements leave
  /// it too. Along a shift in time of a closed path elements leave one as small as they err, and finer ones
  /// less.
  bool is_balanced(Found& found, Failure& failure) {
    const double residual = equations_.residual();
    const bool shifts = problem_.shifts_in_time() > 0 && !options_.scheme;
    const double error = shifts ? errors(found).q / sizes(found).q : 0;
    if (residual <= std::max(largest_residual, error)) return true;
    failure.message = residual_remains(residual);
    if (freedom_of(equations_, found.state).count() > 0)
      failure = {
          "the ends or the waypoints are conjugate along a path near the guess: its second variation is "
          "singular, and a force remains along its null directions, so that there is no extremal; "
          "move an end or a waypoint, or change a time",
          Status::conjugate_ends};
    return false;
  }

  static Solution failed(Failure failure) {
    Solution solution;
    solution.message = std::move(failure.message);
    solution.status = failure.status;
    return solution;
  }

  Resolution::Error errors(const Found& found) {
    resolution_.measure(found.own_path(), *found.own);
    return resolution_.at(found.state.path.degree());
  }

  Scales sizes(const Found& found) const {
    Scales result = scales(found.own_path(), *found.own);
    if (const PathSize size = path_size(found.state, n_); size.rests) {
      result.q = std::max(result.q, size.value);
      result.v = std::max(result.v, size.value / found.state.times.back());
    }
    return result;
  }

  /// The state on other elements.
  Found moved(const Found& found, const LegMesh& mesh, const Elements& elements) const {
    Found to{{{}, mesh, found.state.times, found.state.multipliers, found.state.size_of_start},
             elements.tables,
             elements.own};
    const Path old = found.own_path();
    Path path;
    const std::vector<double> lengths = element_lengths(mesh, found.state.times);
    path.reset(*elements.own, mesh_nodes(lengths), found.state.times.back(), lengths);
    path.resample_from(old, *elements.own, mesh_nodes(lengths));
    with_constants(path, *elements.tables, found.state.constants(n_), to.state.path);
    move_exactly(to.state, *elements.tables);
    starts_.set_waypoints(to.state);
    return to;
  }

  /// Elements as long as the parts of the legs say, to the last digit.
  static void move_exactly(BorderedState& state, const ElementTables& tables) {
    const std::vector<double> times = state.times;
    state.times.clear();
    move_to(state, tables, times);
  }

  /// Elements that resolve the starting path.
  LegMesh first_mesh(const Elements& elements, const Start& start) {
    const int legs = starts_.legs();
    const int most = start.size == 0 ? most_first_elements : most_bent_elements;
    // Steps downhill go to paths that the guess does not tell.
    for (int count = std::max(start.downhill ? most : first_elements, 2 * legs);; count *= 2) {
      const LegMesh mesh = starts_.equal_elements(count);
      Found found{starts_.at(mesh, elements, start), elements.tables, elements.own};
      if (count >= most || errors(found).q <= guess_error * sizes(found).q) return mesh;
    }
  }

  bool has_free_waypoints() const {
    return std::ranges::any_of(extension_.waypoints, [](const WaypointCondition& w) { return w.free; });
  }

  /// Newton's method from the start, of a bent one with the times of waypoints held first; or along the
  /// family of problems with the integrals and conditions that the start has, to those that are given.
  bool reach(Found& found, const Start& start, Failure& failure) {
    if (start.size != 0 && has_free_waypoints()) {
      equations_.hold_times(true);
      const bool reached = newton(found, failure);
      equations_.hold_times(false);
      if (!reached) return false;
    }
    if (!start.led) return newton(found, failure);
    equations_.reset(problem_, *found.tables, *found.own, found.state.mesh);
    if (!equations_.evaluate(found.state, false)) return false;
    const std::vector<double> targets = equations_.targets();
    const auto newton_at = [&](double part) {
      std::vector<double> offsets = targets;
      for (double& x : offsets) x *= 1 - part;
      equations_.set_offsets(offsets);
      return newton(found, failure);
    };
    if (!newton_at(0)) return false;
    double part = 0, step = 0.25;
    while (part < 1 && !spent()) {
      const Found kept = found;
      const double next = std::min(1.0, part + step);
      if (newton_at(next)) {
        part = next;
        step *= 2;
        if (errors(found).q > way_error * sizes(found).q && !options_.scheme) {
          const LegMesh finer = cut(found, resolution_, way_error * sizes(found).q / 2, INFINITY);
          if (finer.elements() > most_elements) return false;
          found = moved(found, finer, {found.tables, found.own});
        }
        continue;
      }
      found = kept;
      step = (next - part) / 4;
      if (step < least_part) return false;
    }
    equations_.set_offsets({});
    return part == 1 && newton(found, failure);
  }

  Found begin(const LegMesh& mesh, const Elements& elements, const Start& start) {
    Found found{starts_.at(mesh, elements, start), elements.tables, elements.own};
    equations_.reset(problem_, *elements.tables, *elements.own, mesh);
    estimate_multipliers(equations_, found.state, problem_);
    found.state.size_of_start = path_size(found.state, n_).value;
    return found;
  }

  Solution solve_adapted(const Start& start) {
    const Elements coarse = lobatto(first_degree);
    Found found = start.zero < 0 ? begin(first_mesh(coarse, start), coarse, start) : zeros_[start.zero].found;
    Failure failure;
    if (!reach(found, start, failure)) return failed(failure);
    for (int round = 0; round < most_refinements && !spent(); ++round) {
      const Scales size = sizes(found);
      const double tolerance = options_.tolerance * size.q,
                   of_v = velocity_tolerances * options_.tolerance * std::max(size.v, size.slowest);
      const Resolution::Error error = errors(found);
      const bool fine = found.state.path.degree() == degree;
      if (fine && error.q <= tolerance && error.v <= of_v) {
        if (std::optional<Solution> solution = compared(found, tolerance, of_v, error.q))
          return *std::move(solution);
        if (found.state.mesh.elements() * 2 > most_elements) break;
        found = moved(found, halved(found.state.mesh), lobatto(degree));
      } else {
        const LegMesh next = cut(found, resolution_, aim * tolerance, aim * of_v);
        if (next.elements() > most_elements) break;
        const bool same = next.elements() == found.state.mesh.elements();
        // From the first degree to the next, elements are not cut yet.
        found = moved(found, !fine ? found.state.mesh : same ? halved(next) : next, lobatto(degree));
      }
      if (!newton(found, failure)) return failed(failure);
    }
    return failed({spent()
                       ? "the limit of work for one solve is reached"
                       : "the elements do not resolve the path to the tolerance; try a larger tolerance"});
  }

  /// The solution, if elements of a higher degree confirm it.
  std::optional<Solution> compared(const Found& found, double tolerance, double of_v, double truncation) {
    Found finer = moved(found, found.state.mesh, lobatto(compared_with));
    Failure failure;
    if (!newton(finer, failure)) return std::nullopt;
    const auto [q, v] = differences(trajectory_of(found.own_path()), trajectory_of(finer.own_path()));
    const double size = path_size(found.state, n_).value;
    const double error = std::max({q, truncation, (found.correction + finer.correction) * size});
    if (!(error <= tolerance && v <= of_v)) return std::nullopt;
    return judged(found, {error});
  }

  Solution judged(const Found& found, const Measured& measured) {
    const auto start = Clock::now();
    equations_.reset(problem_, *found.tables, *found.own, found.state.mesh);
    Solution solution = judge(problem_, options_, equations_, found, measured);
    seconds_analyse_ += seconds_since(start);
    refused_ = !solution.converged();
    return solution;
  }

  /// L + Σ ν g with the constants of a state.
  std::shared_ptr<const Lagrangian> held(const Found& found) const {
    return extension_.at(found.state.constants(n_));
  }

  /// Elements of higher degree on the same mesh, or halved ones where there is no higher degree, at the
  /// extremal near a path.
  struct Companion {
    Trajectory path;
    Scales size;
    double error = 0;  ///< its distance from the path, and what it leaves out itself
  };

  std::optional<Companion> companion_of(const Found& found) {
    const int degree = options_.scheme->degree;
    const bool halves = degree + 3 > max_degree;
    Found finer = halves ? moved(found, halved(found.state.mesh), lobatto(degree))
                         : moved(found, found.state.mesh, lobatto(std::max(degree + 3, first_degree)));
    Failure failure;
    if (!newton(finer, failure)) return std::nullopt;
    Companion companion{trajectory_of(finer.own_path()), sizes(finer)};
    const Resolution::Error left_out = errors(finer);
    if (!problem_.paired && !holds_energy(*held(finer), finer.state.mesh, companion.path, left_out))
      return std::nullopt;
    const double own = left_out.q + (found.correction + finer.correction) * companion.size.q;
    companion.error = std::max(own, unit_roundoff * companion.size.magnitude) +
                      differences(trajectory_of(found.own_path()), companion.path).first;
    return companion;
  }

  /// Equal elements of the scheme that is asked for: so many, or as many as the tolerance needs.
  Solution solve_with_scheme(const Start& start) {
    const Elements elements{&scheme_, &own_scheme_};
    const bool adaptive = options_.elements == 0;
    ElementCount count(*options_.scheme, options_.tolerance,
                       adaptive ? std::max(first_elements, 2 * starts_.legs()) : options_.elements,
                       most_scheme_elements);
    Found found = start.zero < 0
                      ? begin(starts_.equal_elements(count.now()), elements, start)
                      : moved(zeros_[start.zero].found,
                              equal_elements(zeros_[start.zero].found.state.times, count.now()), elements);
    Failure failure;
    if (!reach(found, start, failure)) return failed(failure);
    for (;;) {
      const Scales size = sizes(found);
      const std::optional<Companion> companion = companion_of(found);
      // Without a better extremal near, the discrete one may be an artefact of the mesh.
      if (!adaptive) return judged(found, {companion ? companion->error : size.q});
      if (spent()) return failed({"the limit of work for one solve is reached"});
      if (companion) {
        const double allowed = options_.tolerance * size.q;
        double excess = companion->error / allowed;
        const std::optional<Path> raised =
            excess <= 1 ? recovered(found, *held(found), own_levels_) : std::nullopt;
        if (excess <= 1) {
          const Trajectory output = trajectory_of(raised ? *raised : found.own_path());
          const double of_v = velocity_tolerances * options_.tolerance * companion->size.v;
          if (of_v > 0) excess = std::max(excess, differences(output, companion->path).second / of_v);
        }
        if (excess <= 1) return judged(found, {companion->error, raised ? &*raised : nullptr});
        if (!count.grow(excess, size, {.dear = cost_ > limits::pinned::most_cost}))
          return failed({count.failure()});
      } else if (count.now() < count.most()) {
        count.multiply(2);
      } else {
        return failed({no_companion(count.now())});
      }
      found = moved(found, equal_elements(found.state.times, count.now()), elements);
      if (!newton(found, failure)) return failed(failure);
    }
  }

  const Problem& problem_;
  const Extension& extension_;
  const SolveOptions& options_;
  int n_;
  Levels levels_, own_levels_;
  std::optional<SchemeTables> rule_;
  ElementTables scheme_, own_scheme_;
  StartingStates starts_;
  BorderedEquations equations_;
  Resolution resolution_;
  std::vector<JumpAtTime> zeros_;
  int iterations_ = 0;
  double cost_ = 0;        ///< nanoseconds of the steps, by batch_cost()
  bool downhill_ = false;  ///< of the start that is tried
  bool refused_ = false;   ///< the path that it led to was judged to be no solution
  double seconds_analyse_ = 0;
};

}  // namespace

Solution solve_bordered(const Problem& problem, const SolveOptions& options) {
  return std::move(BorderedSolve(problem, options).run(1, {}).front());
}

std::vector<Solution> solve_bordered_all(const Problem& problem, const SolveOptions& options, int most,
                                         const std::function<bool(const Solution&, const Solution&)>& same) {
  return BorderedSolve(problem, options).run(most, same);
}

}  // namespace extremal
