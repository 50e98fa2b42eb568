#include "solve/singular_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "action/rule.hpp"
#include "problem/point_range.hpp"
#include "solve/limits.hpp"

namespace extremal {

using namespace limits::singular_solve;

namespace {

/// An instant: the variable s, and where it is nearer to the end what is left of it.
struct Instant {
  double s = 0, rest = 0;
};

class InTime {
 public:
  InTime(const Problem& problem, const EndVariables& variables, const Solution& smooth)
      : problem_(problem), x_(variables), smooth_(smooth), n_(problem.coordinates()), q_(n_), v_(n_) {}

  Trajectory trajectory() {
    const std::vector<Instant> mesh = instants();
    const std::vector<double>& points = lobatto_barycentric(degree).nodes;
    Trajectory result{.coordinates = static_cast<int>(n_), .degree = degree, .times = {}, .nodes = {}};
    result.times.push_back(0);
    for (std::size_t k = 0; k + 1 < mesh.size(); ++k) {
      const bool late = from_end(mesh[k]);
      const double from = late ? x_.remaining(mesh[k].s) : x_.time(mesh[k].s),
                   to = late ? x_.remaining(mesh[k + 1].s) : x_.time(mesh[k + 1].s);
      for (std::size_t j = 0; j < points.size(); ++j) {
        const double at = from + points[j] * (to - from);
        read(j == 0                   ? mesh[k].s
             : j + 1 == points.size() ? mesh[k + 1].s
             : late                   ? x_.duration - x_.remaining_inverse(at)
                                      : x_.time_inverse(at));
        result.nodes.insert(result.nodes.end(), q_.begin(), q_.end());
        result.slopes.insert(result.slopes.end(), v_.begin(), v_.end());
      }
      result.times.push_back(k + 2 == mesh.size() ? x_.duration : x_.time(mesh[k + 1].s));
      result.lengths.push_back(std::abs(to - from));
    }
    bound_slopes(result);
    return result;
  }

  /// Whether ∫ L dt is finite towards an end: it is not where (dt/ds) L has a pole, so that its product with
  /// s does not fall.
  bool integrable(bool at_end) {
    const double T = x_.duration;
    BesideLevel beside(*problem_.lagrangian, x_.coordinate, x_.level, x_.side);
    const auto product = [&](double part) {
      const double s = at_end ? T - part * T : part * T;
      read(s);
      return part * T * x_.rate(s) *
             std::abs(to_double(beside.at(distance_, q_, v_, x_.precise_time(s), Order::value).value));
    };
    const double near = product(pole_part), far = product(pole_farther * pole_part);
    return near <= pole_fall * far || near <= pole_part * std::abs(smooth_.action);
  }

  /// p·q' − L in the middle of the elements of w: at the last of them and its largest difference from others.
  void read_energy(Solution& solution) {
    solution.energy = solution.energy_drift = std::nullopt;
    if (!problem_.lagrangian->structure().autonomous) return;
    const std::vector<double>& times = smooth_.trajectory.times;
    BesideLevel beside(*problem_.lagrangian, x_.coordinate, x_.level, x_.side);
    double least = INFINITY, most = -INFINITY, last = 0;
    for (std::size_t k = 0; k + 1 < times.size(); ++k) {
      const double s = 0.5 * (times[k] + times[k + 1]);
      read(s);
      beside.at(distance_, q_, v_, x_.precise_time(s), Order::gradient);
      last = beside.energy();
      least = std::min(least, last);
      most = std::max(most, last);
    }
    if (!std::isfinite(least) || !std::isfinite(most)) return;
    solution.energy = last;
    solution.energy_drift = most - least;
  }

 private:
  /// Of the part beside a singular end at T.
  bool from_end(const Instant& at) const { return x_.singular(true) && at.s >= 0.5 * x_.duration; }

  /// The nodes of w, and others so near to each other towards singular ends that powers of t are polynomials
  /// between them.
  std::vector<Instant> instants() const {
    const double T = x_.duration;
    std::vector<double> all = smooth_.trajectory.times;
    all.back() = T;
    if (x_.singular(false)) {
      const double ratio = std::pow(shrinking, 1 / x_.start), least = std::pow(nearest, 1 / x_.start);
      for (double s = ratio; s > least; s *= ratio) all.push_back(s * T);
    }
    if (x_.singular(true)) {
      const double ratio = std::pow(shrinking, 1 / x_.end), least = std::pow(nearest_to_end, 1 / x_.end);
      for (double s = ratio; s > least; s *= ratio) all.push_back(T - s * T);
    }
    std::ranges::sort(all);
    std::vector<Instant> result{{0, T}};
    for (const double s : all) {
      const double gap = s - result.back().s, room = std::min(s, T - s);
      const bool apart = gap > least_gap * std::max(room, 0.0) && x_.time(s) > x_.time(result.back().s);
      if (s > 0 && s < T && apart && T - x_.time(s) > nearest_to_end * T) result.push_back({s, T - s});
    }
    result.push_back({T, 0});
    return result;
  }

  /// q and q' at s; q' may be infinite.
  void read(double s) {
    smooth_.trajectory.at(s, q_, v_);
    const double rate = x_.rate(s);
    for (double& v : v_) v /= rate;
    if (!x_.has_level()) return;
    const std::size_t a = x_.coordinate;
    v_[a] *= x_.side * x_.power * std::pow(q_[a], x_.power - 1);
    distance_ = std::pow(q_[a], x_.power);
    q_[a] = x_.coordinate_at(q_[a]);
  }

  /// Infinite velocities become those of the chord, so that polynomials stay finite.
  void bound_slopes(Trajectory& result) const {
    const std::size_t row = n_, last = result.slopes.size() - row;
    for (std::size_t a = 0; a < n_; ++a) {
      if (!std::isfinite(result.slopes[a])) result.slopes[a] = result.slopes[row + a];
      if (!std::isfinite(result.slopes[last + a])) result.slopes[last + a] = result.slopes[last - row + a];
    }
  }

  const Problem& problem_;
  const EndVariables& x_;
  const Solution& smooth_;
  std::size_t n_;
  std::vector<double> q_, v_;
  double distance_ = 0;  ///< from the level
};

/// A function of the duration that vanishes at the one wanted.
class Closing {
 public:
  Closing(const Problem& problem, const FixedSolve& solve)
      : problem_(problem), fixed_(problem), solve_(solve) {
    fixed_.duration.free = false;
    fixed_.duration.energy.reset();
    fixed_.duration.where = nullptr;
  }

  /// NaN where no extremal is found.
  double operator()(double duration) {
    fixed_.duration.value = duration;
    Solution found = solve_(fixed_);
    found.iterations += solution.iterations;
    found.seconds_solve += solution.seconds_solve;
    solution = std::move(found);
    if (!solution.converged()) return NAN;
    if (const std::optional<double>& energy = problem_.duration.energy) {
      scale = std::max(std::abs(*energy), std::abs(solution.action) / duration);
      return solution.energy.value_or(NAN) - *energy;
    }
    const std::size_t n = problem_.coordinates();
    const std::vector<double>& q = solution.trajectory.nodes;
    std::vector<double> gradient(2 * n);
    const double value = problem_.duration.where({q.data(), n}, {q.data() + q.size() - n, n}, gradient);
    scale = 0;
    for (const double slope : gradient) scale += std::abs(slope) * largest_range(q, n);
    return value;
  }

  Solution solution;  ///< the last one
  double scale = 0;   ///< of the function there

 private:
  const Problem& problem_;
  Problem fixed_;
  const FixedSolve& solve_;
};

Solution without_duration(double duration, const Solution& last) {
  Solution none;
  none.iterations = last.iterations;
  none.seconds_solve = last.seconds_solve;
  none.message = fmt::format(
      "no duration found that closes the problem, where L is infinite at an end: the last one tried is "
      "{:.6g}",
      duration);
  none.message += last.converged() ? "; try another 'guess.duration', or another 'energy' or 'where'"
                                   : ", for which " + last.message;
  return none;
}

}  // namespace

Solution solve_for_duration(const Problem& problem, const SolveOptions& options, const FixedSolve& solve) {
  Closing closing(problem, solve);
  double a = problem.duration.value, b = a * first_change;
  double at_a = closing(a), at_b = at_a == 0 ? 0 : closing(b);
  if (at_a == 0) b = a;
  double low = 0, high = INFINITY, at_low = 0;  // a bracket, once signs have differed
  for (int k = 0; k < most_durations; ++k) {
    if (!std::isfinite(at_a) || !std::isfinite(at_b) || options.deadline.passed()) break;
    if (std::isfinite(high)) {
      ((at_b < 0) == (at_low < 0) ? low : high) = b;
    } else if ((at_a < 0) != (at_b < 0)) {
      low = std::min(a, b);
      high = std::max(a, b);
      at_low = a < b ? at_a : at_b;
    }
    const double slope = (at_b - at_a) / (b - a);
    double next = b == a || at_b == 0 ? b : b - at_b / slope;
    // Where the extremal jumps to another one, signs differ without a zero between.
    const bool closed = std::abs(at_b) <= closing_tolerances * options.tolerance * closing.scale;
    if (closed && std::abs(next - b) <= same_duration * options.tolerance * b) {
      Solution solution = std::move(closing.solution);
      const double off = std::abs(next - b) + (b != a && slope != 0 && problem.duration.energy
                                                   ? solution.energy_drift.value_or(0) / std::abs(slope)
                                                   : 0);
      solution.error_estimate += off / b * largest_range(solution.trajectory.nodes, problem.coordinates());
      return solution;
    }
    const bool bracketed = std::isfinite(high);
    if (!std::isfinite(next) || (bracketed && !(next > low && next < high)))
      next = bracketed ? 0.5 * (low + high) : at_b / slope > 0 ? b / largest_change : b * largest_change;
    next = std::clamp(next, b / largest_change, b * largest_change);
    a = std::exchange(b, next);
    at_a = std::exchange(at_b, closing(b));
  }
  return without_duration(b, closing.solution);
}

std::string infinite_action(bool at_end) {
  const char* const end = at_end ? "end" : "start";
  return fmt::format(
      "the integral of L is infinite towards the {}; leave out of L what depends on t alone, or give the {} "
      "a "
      "value at which the rest vanishes",
      end, end);
}

Solution in_time(const Problem& problem, const EndVariables& variables, const Solution& smooth) {
  Solution solution = smooth;
  const std::size_t a = variables.coordinate;
  if (!solution.converged()) {
    solution.trajectory = {};
    solution.message += "; in variables in which the ends, where L is infinite, are regular";
    return solution;
  }
  InTime in(problem, variables, smooth);
  for (const bool at_end : {false, true})
    if (!variables.has_level() && variables.singular(at_end) && !in.integrable(at_end)) {
      Solution refused;
      refused.iterations = smooth.iterations;
      refused.seconds_solve = smooth.seconds_solve;
      refused.message = infinite_action(at_end);
      return refused;
    }
  solution.trajectory = in.trajectory();
  in.read_energy(solution);
  // Of q = level + side w^m.
  double widest = 0;
  for (std::size_t k = a; variables.has_level() && k < smooth.trajectory.nodes.size();
       k += problem.coordinates())
    widest = std::max(widest, std::abs(smooth.trajectory.nodes[k]));
  if (variables.has_level())
    solution.error_estimate *= std::max(1.0, variables.power * std::pow(widest, variables.power - 1));
  for (std::array<double, 2>& window : solution.windows)
    for (double& t : window) t = variables.time(t);
  for (double& t : solution.conjugate_times) t = variables.time(t);
  if (variables.fades()) {
    solution.morse_index = solution.nullity = std::nullopt;
    solution.minimizing = false;
    solution.message += ", nor is the index, as the second variation vanishes there";
  }
  const auto in_q = [&](std::vector<double>& momentum, bool at_end) {
    if (variables.infinite_momentum(at_end)) return momentum.clear();
    if (!variables.has_level()) return;  // ∂L̃/∂(dq/ds) = ∂L/∂q'
    const double w = at_end
                         ? smooth.trajectory.nodes[smooth.trajectory.nodes.size() - problem.coordinates() + a]
                         : smooth.trajectory.nodes[a];
    momentum[a] /= variables.side * variables.power * std::pow(w, variables.power - 1);
  };
  in_q(solution.momentum_start, false);
  in_q(solution.momentum_end, true);
  const char* const ends =
      variables.singular(false) ? variables.singular(true) ? "start and the end" : "start" : "end";
  solution.message +=
      variables.has_level()
          ? fmt::format("; L is infinite at the {}, though not its integral, and so is {}' there", ends,
                        problem.names.empty() ? fmt::format("q[{}]", a + 1) : problem.names[a])
          : fmt::format("; L is singular in t at the {}, and elements are polynomials in a power of t", ends);
  return solution;
}

}  // namespace extremal
