#include "solve/infinite_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "action/rule.hpp"
#include "problem/infinite_ends.hpp"
#include "solution/guessed_by.hpp"
#include "solve/limits.hpp"

namespace extremal {

using namespace limits::infinite_solve;

namespace {

/// A path sampled in time.
struct SampledPath {
  std::vector<double> t, q;  ///< ascending from 0; row by row
  double duration() const { return t.back(); }
};

SampledPath sampled(const Guess& guess, double duration) {
  SampledPath path{guess.tau, guess.q};
  for (double& t : path.t) t *= duration;
  return path;
}

SampledPath sampled(const Trajectory& trajectory) {
  return sampled(guess_of(trajectory, trajectory.degree + 1), trajectory.duration());
}

class InfiniteSolve {
 public:
  InfiniteSolve(const Problem& problem, const SolveOptions& options, const FiniteSolve& solve)
      : problem_(problem), options_(options), adaptive_(options.adaptive()), solve_(solve) {}

  Solution run() {
    Solution solution = found();
    if (solution.converged() && options_.scheme) {
      const double error = solution.error_estimate;
      Solution pinned = solve_(finite(sampled(solution.trajectory)), options_, true);
      pinned.strategy = solution.strategy;
      solution = std::move(pinned);
      if (solution.converged()) solution.error_estimate = std::max(solution.error_estimate, error);
    }
    if (!solution.converged()) return explained(std::move(solution));
    return finished(std::move(solution));
  }

 private:
  bool infinite(int end) const { return !equilibrium(end).empty(); }
  const std::vector<double>& equilibrium(int end) const {
    return end == 0 ? problem_.infinite->start : problem_.infinite->end;
  }
  RestPoint rest(int end, double duration) const {
    return rest_point_of(*problem_.lagrangian, *problem_.infinite, end == 1, end == 1 ? duration : 0);
  }

  /// The problem on the duration of a path, which is its guess.
  Problem finite(const SampledPath& path) const {
    Problem result = problem_;
    result.duration.value = path.duration();
    result.guess = {};
    for (const double t : path.t) result.guess.tau.push_back(t / path.duration());
    result.guess.tau.back() = 1;
    result.guess.q = path.q;
    result.boundary.costs.resize(2);
    for (const int end : {0, 1})
      if (infinite(end)) result.boundary.costs[end] = cost_to(rest(end, path.duration()), end == 1);
    return result;
  }

  /// Of an end of a path from its equilibrium, the largest of the coordinates.
  double deviation(const SampledPath& path, int end) const {
    if (!infinite(end)) return 0;
    const std::vector<double> centre = rest(end, path.duration()).q;
    const double* q = path.q.data() + (end == 0 ? 0 : path.q.size() - centre.size());
    double found = 0;
    for (std::size_t a = 0; a < centre.size(); ++a) found = std::max(found, std::abs(q[a] - centre[a]));
    return found;
  }

  /// A path that decays beyond its infinite ends for so many times of the slowest linear motion.
  SampledPath extended(const SampledPath& path, std::array<double, 2> decays) const {
    const std::size_t n = problem_.coordinates();
    SampledPath result = path;
    for (const int end : {0, 1}) {
      if (!infinite(end) || decays[end] == 0) continue;
      const RestPoint at = rest(end, path.duration());
      const double added = decays[end] / at.decay(end == 1);
      const int count = std::max(1, static_cast<int>(std::ceil(decays[end] * samples_a_decay)));
      std::vector<double> t, q;
      for (int k = 1; k <= count; ++k) {
        const double s = added * k / count;
        const double* from = path.q.data() + (end == 0 ? 0 : path.q.size() - n);
        t.push_back(s);
        for (std::size_t a = 0; a < n; ++a)
          q.push_back(at.q[a] + (from[a] - at.q[a]) * std::exp(-at.decay(end == 1) * s));
      }
      if (end == 1) {
        for (double& x : t) x += result.duration();
        result.t.insert(result.t.end(), t.begin(), t.end());
        result.q.insert(result.q.end(), q.begin(), q.end());
        continue;
      }
      SampledPath shifted;
      for (int k = count; k-- > 0;) {
        shifted.t.push_back(added - t[k]);
        shifted.q.insert(shifted.q.end(), q.begin() + k * n, q.begin() + (k + 1) * n);
      }
      for (const double x : result.t) shifted.t.push_back(added + x);
      shifted.q.insert(shifted.q.end(), result.q.begin(), result.q.end());
      shifted.t.front() = 0;
      result = std::move(shifted);
    }
    return result;
  }

  /// From the guess; from that in another size or place; from extremals of short durations between fixed
  /// ends; from other guesses. The first that leads to rest on longer and longer parts is the one; else what
  /// failed last.
  Solution found() {
    const SampledPath guess = sampled(problem_.guess, problem_.duration.value);
    Solution result;
    const auto leads = [&](Solution first, std::string_view strategy = {}) {
      const bool shrank = first.converged() && shrunk_to_rest(first);
      result = shrank ? at_rest_alone() : first.converged() ? lengthened(std::move(first)) : std::move(first);
      if (result.converged() && shrunk_to_rest(result)) result = at_rest_alone();
      if (result.converged() && !strategy.empty()) result.strategy = strategy;
      return result.converged();
    };
    if (leads(solve_(finite(guess), adaptive_, true))) return result;
    for (const double decays : lengthenings)
      if (leads(solve_(finite(extended(guess, {decays, decays})), adaptive_, true))) return result;
    if (const auto other = resized(guess);
        other && leads(solve_(finite(*other), adaptive_, true), "newton from the guess in another size"))
      return result;
    if (const auto other = moved(guess);
        other && leads(solve_(finite(*other), adaptive_, true), "newton from the guess moved in time"))
      return result;
    for (const double decays : short_durations) {
      if (options_.deadline.passed()) return result;
      if (leads(through_short(guess, decays))) return result;
    }
    if (!options_.deadline.passed()) leads(solve_(finite(guess), adaptive_, false));
    return result;
  }

  /// Whether rest is an extremal of the problem: then others are saddles of the action between it and paths
  /// far away.
  bool allows_rest() const {
    if (infinite(0) && infinite(1)) return equilibrium(0) == equilibrium(1);
    const auto fixed = [](char f) { return f != 0; };
    return std::ranges::none_of(problem_.ends.fixed, fixed);
  }

  SampledPath in_size(const SampledPath& guess, double size, double rate, int samples) const {
    const std::size_t n = problem_.coordinates();
    const double T = guess.duration(), middle = infinite(0) ? (infinite(1) ? 0.5 * T : T) : 0;
    const std::vector<double>& rest = equilibrium(infinite(1) ? 1 : 0);
    SampledPath path;
    std::vector<double> q(n);
    for (int k = 0; k <= samples; ++k) {
      path.t.push_back(T * k / samples);
      problem_.guess.at(std::clamp((middle + rate * (path.t.back() - middle)) / T, 0.0, 1.0), q);
      for (std::size_t a = 0; a < n; ++a) path.q.push_back(rest[a] + size * (q[a] - rest[a]));
    }
    return path;
  }

  /// ∫ L − L(rest) dt.
  double action_of(const SampledPath& path) const {
    const std::size_t n = problem_.coordinates();
    const std::vector<double>& rest = equilibrium(infinite(1) ? 1 : 0);
    const std::vector<double> zero(n, 0);
    std::vector<double> q(n), v(n);
    double sum = 0;
    for (std::size_t k = 1; k < path.t.size(); ++k) {
      const double step = path.t[k] - path.t[k - 1], middle = path.t[k] - 0.5 * step;
      for (std::size_t a = 0; a < n; ++a) {
        const double before = path.q[(k - 1) * n + a], after = path.q[k * n + a];
        q[a] = 0.5 * (before + after);
        v[a] = (after - before) / step;
      }
      sum += step * (evaluate_at(*problem_.lagrangian, q, v, middle, Order::value, scratch_).value -
                     evaluate_at(*problem_.lagrangian, rest, zero, middle, Order::value, scratch_).value);
    }
    return sum;
  }

  /// The guess in that size in which its action is largest, and in that rate in which this largest one is
  /// least: near the pass between rest and paths far away. Nothing if rest is no extremal, or there is no
  /// pass.
  std::optional<SampledPath> resized(const SampledPath& guess) const {
    if (!allows_rest()) return std::nullopt;
    double least = INFINITY, size = 0, rate = 0;
    for (int i = -scan_rates; i <= scan_rates; ++i) {
      const double at_rate = std::pow(2.0, i / 2.0);
      double most = 0, at_most = 0;
      bool passed = false;
      for (int k = -scan_sizes; k <= scan_sizes && !passed; ++k) {
        const double at_size = std::pow(2.0, k / 4.0),
                     action = action_of(in_size(guess, at_size, at_rate, scan_samples));
        if (!std::isfinite(action)) break;
        passed = at_most > 0 && action < most;
        if (action > most) {
          most = action;
          at_most = at_size;
        }
      }
      if (!passed || !(most < least)) continue;
      least = most;
      size = at_most;
      rate = at_rate;
    }
    if (!(size > 0)) return std::nullopt;
    return in_size(guess, size, rate, samples_of_resized);
  }

  /// The guess moved in time to where its action is stationary: where the path is between two rests, as that
  /// of a bubble with a thin wall is, the way over the pass moves the wall alone.
  std::optional<SampledPath> moved(const SampledPath& guess) const {
    if (!allows_rest() || infinite(0) == infinite(1)) return std::nullopt;
    const double T = guess.duration(), shortest = infinite(0) ? most_shift * T : -most_shift * T;
    const auto action_at = [&](double later) { return action_of(later_by(guess, later, scan_samples)); };
    // Of the shortest path nearly all of the action is kinetic.
    const double sign = std::copysign(1, action_at(shortest));
    const auto action = [&](double later) { return sign * action_at(later); };
    double step = shift_step * T, best = 0, at_best = 0;
    double before = action(-most_shift * T), here = action(-most_shift * T + step);
    for (double later = -most_shift * T + step; later < most_shift * T; later += step) {
      const double after = action(later + step);
      if (here > before && here > after && here > at_best) {
        best = later;
        at_best = here;
      }
      before = std::exchange(here, after);
    }
    if (!(at_best > 0)) return std::nullopt;
    for (; step > least_shift * T; step /= 2)
      for (const double later : {best - step / 2, best + step / 2})
        if (const double found = action(later); found > at_best) {
          best = later;
          at_best = found;
        }
    return later_by(guess, best, samples_of_resized);
  }

  /// A guess with one infinite end, later by so much: at the finite end it rests, or begins on its way.
  SampledPath later_by(const SampledPath& guess, double later, int samples) const {
    const std::size_t n = problem_.coordinates();
    const double T = guess.duration(),
                 duration = infinite(0) ? std::max(T, T - later) : std::max(T, T + later);
    SampledPath path;
    std::vector<double> q(n);
    for (int k = 0; k <= samples; ++k) {
      path.t.push_back(duration * k / samples);
      const double from = infinite(0) ? path.t.back() - (duration - T) : path.t.back();
      problem_.guess.at(std::clamp((from - later) / T, 0.0, 1.0), q);
      path.q.insert(path.q.end(), q.begin(), q.end());
    }
    return path;
  }

  /// The part of a guess about its middle, or beside the finite end, with its ends fixed at the equilibria;
  /// then the whole.
  Solution through_short(const SampledPath& guess, double decays) {
    const std::size_t n = problem_.coordinates();
    double length = 0;
    for (const int end : {0, 1})
      if (infinite(end)) length += decays / rest(end, guess.duration()).decay(end == 1);
    length = std::min(length, guess.duration());
    Problem part = problem_;
    part.infinite.reset();
    part.duration.value = length;
    const double from = infinite(0) ? (infinite(1) ? 0.5 : 1) * (guess.duration() - length) : 0;
    part.guess = {};
    std::vector<double> q(n);
    for (int k = 0; k <= samples_of_part; ++k) {
      part.guess.tau.push_back(static_cast<double>(k) / samples_of_part);
      const double t = from + part.guess.tau.back() * length;
      problem_.guess.at(std::min(1.0, t / guess.duration()), q);
      part.guess.q.insert(part.guess.q.end(), q.begin(), q.end());
    }
    for (const int end : {0, 1})
      for (std::size_t a = 0; a < equilibrium(end).size(); ++a)
        part.boundary.fix(static_cast<int>(a), end == 1, equilibrium(end)[a]);
    part.ends = solve_relation(part.boundary);
    Solution found = solve_(part, adaptive_, true);
    if (!found.converged()) return found;
    // The fixed ends are left where the path still departs from them.
    SampledPath path = sampled(found.trajectory);
    return solve_(finite(extended(path, {kept_decays, kept_decays})), adaptive_, true);
  }

  /// On longer parts, until they change the path no more. The error of an end falls at least as its deviation
  /// does.
  Solution lengthened(Solution solution) {
    for (int round = 0; round < most_lengthenings; ++round) {
      if (options_.deadline.passed()) break;
      const SampledPath before = sampled(solution.trajectory);
      const double range = largest_range(before);
      std::array<double, 2> decays{};
      for (const int end : {0, 1}) {
        const double wanted = std::sqrt(wanted_error * adaptive_.tolerance) * range;
        if (infinite(end))
          decays[end] = std::clamp(std::log(deviation(before, end) / wanted), std::log(lengthening_factor),
                                   most_decays);
      }
      const std::array<double, 2> old{deviation(before, 0), deviation(before, 1)};
      double shift = 0;
      Solution next;
      for (const double factor : further) {
        if (next.converged()) break;
        for (const int end : {0, 1}) decays[end] *= factor;
        shift = infinite(0) ? decays[0] / rest(0, 0).slowest_out : 0;
        next = solve_(finite(extended(before, decays)), adaptive_, true);
      }
      if (!next.converged()) return next;
      const SampledPath after = sampled(next.trajectory);
      for (const int end : {0, 1})
        if (infinite(end) && deviation(after, end) > std::max(0.5 * old[end], at_rest * range))
          return astray();
      const double moved = change(before, next.trajectory, shift);
      next.iterations += solution.iterations;
      next.seconds_solve += solution.seconds_solve;
      next.seconds_analyse += solution.seconds_analyse;
      solution = std::move(next);
      const double left = moved / (lengthening_factor - 1);
      if (left > most_error * adaptive_.tolerance * range) continue;
      solution.error_estimate += left;
      return solution;
    }
    solution = {};
    solution.message =
        "longer parts of the time axis change the path by more than the tolerance: it approaches the "
        "equilibrium too slowly; loosen the tolerance";
    return solution;
  }

  /// Whether the guess leaves the equilibrium and the solution does not.
  bool shrunk_to_rest(const Solution& solution) const {
    const double first = range_of(sampled(problem_.guess, problem_.duration.value));
    return range_of(sampled(solution.trajectory)) < shrunk * first;
  }

  static Solution at_rest_alone() {
    Solution none;
    none.status = Status::no_solution_near;
    none.message =
        "Newton's method leads from the guess to rest at the equilibrium, which is no other extremal; try a "
        "larger guess, or one of another shape";
    return none;
  }

  static Solution astray() {
    Solution none;
    none.status = Status::no_solution_near;
    none.message =
        "the path found does not approach the equilibrium: longer parts of it end as far away; try another "
        "guess";
    return none;
  }

  double largest_range(const SampledPath& path) const {
    const double range = range_of(path);
    return range > 0 ? range : 1;
  }

  double range_of(const SampledPath& path) const {
    const std::size_t n = problem_.coordinates();
    double range = 0;
    for (std::size_t a = 0; a < n; ++a) {
      double low = path.q[a], high = low;
      for (std::size_t k = a; k < path.q.size(); k += n) {
        low = std::min(low, path.q[k]);
        high = std::max(high, path.q[k]);
      }
      range = std::max(range, high - low);
    }
    return range;
  }

  /// Largest difference of two paths, the second one begun earlier by `shift`; where shifts in time are no
  /// difference, with the shift that makes it least.
  double change(const SampledPath& before, const Trajectory& after, double shift) const {
    const std::size_t n = problem_.coordinates();
    std::vector<double> q(n), v(n);
    double largest = 0;
    for (int pass = 0; pass <= (problem_.shifts_in_time() ? shift_steps : 0); ++pass) {
      double along = 0, speed = 0;
      largest = 0;
      for (std::size_t k = 0; k < before.t.size(); ++k) {
        const double t = before.t[k] + shift;
        if (t < 0 || t > after.duration()) continue;
        const double length = 0.5 * (before.t[std::min(k + 1, before.t.size() - 1)] - before.t[k - (k > 0)]);
        after.at(t, q, v);
        for (std::size_t a = 0; a < n; ++a) {
          const double difference = q[a] - before.q[k * n + a];
          largest = std::max(largest, std::abs(difference));
          along += length * difference * v[a];
          speed += length * v[a] * v[a];
        }
      }
      if (speed > 0) shift -= along / speed;
    }
    return largest;
  }

  /// ∫ L dt of rest at the equilibrium over the part that is shown.
  double action_of_rest(const Trajectory& trajectory) const {
    const Lagrangian& lagrangian = *problem_.lagrangian;
    const int end = infinite(1) ? 1 : 0;
    if (lagrangian.structure().autonomous) return rest(end, 0).value * trajectory.duration();
    const Rule rule = gauss_rule(quadrature_points);
    const std::vector<double>&q = equilibrium(end), zero(q.size(), 0);
    Scratch scratch;
    double sum = 0;
    for (int k = 0; k < trajectory.elements(); ++k)
      for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        sum += rule.weights[i] * trajectory.length(k) *
               evaluate_at(lagrangian, q, zero, trajectory.times[k] + rule.nodes[i] * trajectory.length(k),
                           Order::value, scratch)
                   .value;
    return sum;
  }

  /// The slowest decay as |t| → ∞: in L that depends on t what falls as 1/t is taken off (Richardson).
  double decay(int end, double duration) const {
    const auto at = [&](double time) { return rest(end, time).decay(end == 1); };
    const double here = at(duration);
    if (problem_.lagrangian->structure().autonomous) return here;
    const double limit = 2 * at(2 * duration) - here;
    return std::isfinite(limit) && limit > 0 ? limit : here;
  }

  Solution finished(Solution solution) const {
    const double duration = solution.duration();
    solution.action -= action_of_rest(solution.trajectory);
    solution.rates.emplace();
    if (infinite(0)) solution.rates->start = decay(0, duration);
    if (infinite(1)) solution.rates->end = decay(1, duration);
    solution.message += infinite(0) && infinite(1) ? " on (-∞, ∞)"
                        : infinite(1)              ? " on [0, ∞)"
                                                   : " on (-∞, 0]";
    solution.message += fmt::format("; shown are {:.6g} of it", duration);
    return solution;
  }

  Solution explained(Solution solution) const {
    solution.message += "; on an infinite interval";
    if (solution.message.find("try ") == std::string::npos)
      solution.message += ": try another guess, or another 'guess.duration' for the part that it describes";
    return solution;
  }

  const Problem& problem_;
  const SolveOptions& options_;
  SolveOptions adaptive_;
  const FiniteSolve& solve_;
  mutable Scratch scratch_;
};

}  // namespace

Solution solve_infinite(const Problem& problem, const SolveOptions& options, const FiniteSolve& solve) {
  return InfiniteSolve(problem, options, solve).run();
}

}  // namespace extremal
