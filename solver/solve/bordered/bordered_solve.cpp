#include "solve/bordered/bordered_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "solve/bordered/bordered_judge.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/bordered/minimise.hpp"
#include "solve/bordered/starting_states.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/resolution.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

using Clock = std::chrono::steady_clock;

/// A state, and where it came from.
struct Found {
  BorderedState state;
  const ElementTables *tables = nullptr, *own = nullptr;
  double correction = 0;
};

/// Why an attempt found nothing.
struct Failure {
  std::string message;
  Status status = Status::not_converged;
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
      rule_.emplace(*options.scheme, 0);
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
    std::optional<Failure> first_failure;
    std::size_t tried = 0;
    for (; tried < starts.size() && !(tried > 0 && spent()); ++tried) {
      if (static_cast<int>(found.size()) >= most) break;
      const Start& from = starts[tried];
      downhill_ = from.downhill;
      equations_.set_offsets({});
      Solution solution = options_.scheme ? solve_with_scheme(from) : solve_adapted(from);
      if (solution.converged()) {
        solution.strategy = from.strategy();
        const auto known = [&](const Solution& other) { return same(other, solution); };
        if (std::ranges::none_of(found, known)) found.push_back(timed(std::move(solution), start));
      } else if (!first_failure) {
        first_failure = {solution.message, solution.status};
      }
      const bool wanted = static_cast<int>(found.size()) < most;
      if (tried + 1 == unbent && wanted) add_bent(starts);
    }
    if (found.empty()) return {timed(failure(*first_failure), start)};
    std::ranges::stable_sort(found, {}, &Solution::action);
    if (static_cast<int>(found.size()) < most)
      found.front().message +=
          fmt::format("; {} of {} extremals wanted were found from {} guesses{}; more may exist",
                      found.size(), most, tried, spent() ? ", until the budget was spent" : "");
    return found;
  }

 private:
  bool spent() const { return options_.deadline.passed() || iterations_ >= options_.max_iterations; }

  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  bool has_targets() const {
    return extension_.multipliers() > 0 || !extension_.conditions.empty() || !extension_.where.empty();
  }

  Solution failure(const Failure& first) const {
    Solution solution;
    solution.status =
        spent() && first.status == Status::not_converged ? Status::iteration_limit : first.status;
    solution.message =
        first.message + (spent() ? "; the budget is spent" : "") +
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
  /// it too.
  bool is_balanced(Found& found, Failure& failure) {
    const double residual = equations_.residual();
    if (residual <= largest_residual) return true;
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
    Path path;
    without_constants(found.state.path, *found.own, path);
    resolution_.measure(path, *found.own);
    return resolution_.at(found.state.path.degree());
  }

  Scales sizes(const Found& found) const {
    Path path;
    without_constants(found.state.path, *found.own, path);
    return scales(path, *found.own);
  }

  /// The state on other elements.
  Found moved(const Found& found, const LegMesh& mesh, const Elements& elements) const {
    Found to{{{}, mesh, found.state.times, found.state.multipliers}, elements.tables, elements.own};
    Path old, path;
    without_constants(found.state.path, *found.own, old);
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

  /// Elements cut where their coefficients are larger than a part of the tolerance.
  LegMesh cut(const Found& found, double aim_q, double aim_v) const {
    const int degree = found.state.path.degree();
    LegMesh mesh;
    mesh.first.push_back(0);
    for (int l = 0; l < found.state.mesh.legs(); ++l) {
      for (int k = found.state.mesh.first[l]; k < found.state.mesh.first[l + 1]; ++k) {
        const Resolution::Tail& tail = resolution_.tails()[k];
        const double left = tail.size * tail.fall / (1 - std::min(tail.fall, 0.9));
        const double of_v = left * (degree + 1) * (degree + 2) / tail.h;
        const double excess = std::max(left / aim_q, of_v / aim_v);
        const int count =
            std::clamp(static_cast<int>(std::ceil(std::pow(std::max(excess, 0.0), 1.0 / (degree + 1)))), 1,
                       strongest_cut);
        for (int i = 0; i < count; ++i) mesh.parts.push_back(found.state.mesh.parts[k] / count);
      }
      mesh.first.push_back(static_cast<int>(mesh.parts.size()));
    }
    return mesh;
  }

  static LegMesh halved(const LegMesh& mesh) {
    LegMesh result;
    for (const int first : mesh.first) result.first.push_back(2 * first);
    for (const double part : mesh.parts) result.parts.insert(result.parts.end(), 2, part / 2);
    return result;
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
          const LegMesh finer = cut(found, way_error * sizes(found).q / 2, INFINITY);
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
    first_size_ = path_size(found.state.path, n_);
    return found;
  }

  Solution solve_adapted(const Start& start) {
    const Elements coarse = lobatto(first_degree);
    Found found = begin(first_mesh(coarse, start), coarse, start);
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
        const LegMesh next = cut(found, aim * tolerance, aim * of_v);
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
    const auto [q, v] = differences(found, finer);
    const double size = path_size(found.state.path, n_);
    const double error = std::max({q, truncation, (found.correction + finer.correction) * size});
    if (!(error <= tolerance && v <= of_v)) return std::nullopt;
    return judged(found, error);
  }

  Solution judged(const Found& found, double error) {
    const auto start = Clock::now();
    equations_.reset(problem_, *found.tables, *found.own, found.state.mesh);
    Solution solution = judge(problem_, options_, equations_, found.state, *found.own, error, first_size_);
    seconds_analyse_ += std::chrono::duration<double>(Clock::now() - start).count();
    return solution;
  }

  /// The largest differences of q and q' of two paths at the same parts of their legs.
  std::pair<double, double> differences(const Found& a, const Found& b) const {
    Path first, second;
    without_constants(a.state.path, *a.own, first);
    without_constants(b.state.path, *b.own, second);
    const Trajectory one = trajectory_of(first), two = trajectory_of(second);
    std::vector<double> q(n_), v(n_), other_q(n_), other_v(n_);
    double most_q = 0, most_v = 0;
    const int ratio = b.state.mesh.elements() / a.state.mesh.elements();
    const std::vector<double>& nodes = a.own->scheme().lobatto;
    for (int k = 0; k < one.elements(); ++k)
      for (const double tau : nodes) {
        one.in_element(k, tau, q, v);
        const int part = std::min(ratio - 1, static_cast<int>(tau * ratio));
        two.in_element(ratio * k + part, tau * ratio - part, other_q, other_v);
        for (int i = 0; i < n_; ++i) {
          most_q = std::max(most_q, std::abs(q[i] - other_q[i]));
          most_v = std::max(most_v, std::abs(v[i] - other_v[i]));
        }
      }
    return {most_q, most_v};
  }

  /// Equal elements of the scheme that is asked for: so many, or doubled until the tolerance is met.
  Solution solve_with_scheme(const Start& start) {
    const Elements elements{&scheme_, &own_scheme_};
    const int legs = starts_.legs();
    const bool pinned = options_.elements > 0;
    const LegMesh mesh = starts_.equal_elements(pinned ? options_.elements : std::max(8, 2 * legs));
    Found found = begin(mesh, elements, start);
    Failure failure;
    if (!reach(found, start, failure)) return failed(failure);
    const double gain = std::pow(2.0, options_.scheme->order) - 1;
    for (;;) {
      Found finer = moved(found, halved(found.state.mesh), elements);
      if (finer.state.mesh.elements() > most_scheme_elements)
        return failed(
            {fmt::format("{} elements of the scheme do not reach the tolerance; try a larger one, or a "
                         "scheme of higher order",
                         found.state.mesh.elements())});
      if (!newton(finer, failure)) return failed(failure);
      const double difference = differences(found, finer).first;
      if (pinned) return judged(found, difference * (1 + 1 / gain));
      if (difference * (1 + 1 / gain) <= options_.tolerance * sizes(found).q)
        return judged(found, difference * (1 + 1 / gain));
      if (spent()) return failed({"the limit of work for one solve is reached"});
      found = std::move(finer);
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
  int iterations_ = 0;
  bool downhill_ = false;  ///< of the start that is tried
  double seconds_analyse_ = 0, first_size_ = 1;
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
