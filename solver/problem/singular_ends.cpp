#include "problem/singular_ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "machine/bisect.hpp"
#include "problem/limits.hpp"
#include "problem/singular_times.hpp"

namespace extremal {

using namespace limits::singular_ends;

namespace {

bool finite_at(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v, double t) {
  Scratch scratch;
  return std::isfinite(evaluate_at(lagrangian, q, v, t, Order::value, scratch).value);
}

/// One end of a problem, with the mean velocity between the ends.
struct End {
  bool at_end = false;
  std::vector<double> q, mean;
  std::vector<char> fixed;
  double time = 0;
};

End end_of(const Problem& problem, bool at_end) {
  const std::size_t n = problem.coordinates();
  const double T = problem.duration.value;
  End end{.at_end = at_end, .q = {}, .mean = {}, .fixed = {}, .time = at_end ? T : 0};
  const std::vector<double>& offset = problem.ends.offset;
  const std::vector<char>& fixed = problem.ends.fixed;
  for (std::size_t a = 0; a < n; ++a) {
    const bool both = fixed[a] && fixed[n + a];
    end.q.push_back(offset[at_end ? n + a : a]);
    end.fixed.push_back(fixed[at_end ? n + a : a]);
    end.mean.push_back(both ? (offset[n + a] - offset[a]) / T : 0);
    // A coordinate that is free here is where its other end is.
    if (!end.fixed.back()) end.q.back() = offset[at_end ? a : n + a];
  }
  return end;
}

/// Coordinates that are free at an end may be elsewhere.
bool infinite_at(const Lagrangian& lagrangian, const End& end, double way) {
  const std::vector<double> rest(end.q.size(), 0);
  if (finite_at(lagrangian, end.q, rest, end.time) || finite_at(lagrangian, end.q, end.mean, end.time))
    return false;
  if (std::ranges::all_of(end.fixed, [](char fixed) { return fixed != 0; })) return true;
  std::vector<double> q(end.q.size());
  for (const double side : {-1.0, 1.0}) {
    for (std::size_t a = 0; a < q.size(); ++a) q[a] = end.q[a] + (end.fixed[a] ? 0 : side * way);
    if (finite_at(lagrangian, q, rest, end.time)) return false;
  }
  return true;
}

/// p·q' − L with q_a at a distance from its level and its velocity v, that of the others the mean one.
class EnergyBeside {
 public:
  EnergyBeside(const Lagrangian& lagrangian, const End& end, std::size_t a, double side)
      : end_(end),
        a_(a),
        side_(side),
        v_(end.mean),
        beside_(lagrangian, static_cast<int>(a), end.q[a], side) {}

  double operator()(double distance, double speed) {
    v_[a_] = speed * (end_.at_end ? -side_ : side_);
    values_ = &beside_.at(distance, end_.q, v_, end_.time, Order::gradient);
    return beside_.energy();
  }

  /// ∂L/∂d' at the point evaluated last.
  DoubleDouble momentum() const { return side_ * values_->v[a_]; }

  double rounded(double distance) const { return beside_.rounded(distance); }

  /// Distances below have few digits.
  double nearest() const {
    return std::abs(end_.q[a_]) * (beside_.extended() ? extended_roundoff : roundoff);
  }

  /// The speed at which the energy is the given one, which rises with the speed; 0 if there is none.
  double speed(double distance, double energy, double guess) {
    double low = guess, high = guess;
    for (int k = 0; k < most_quadruplings && !((*this)(distance, low) < energy); ++k) low /= 4;
    for (int k = 0; k < most_quadruplings && !((*this)(distance, high) > energy); ++k) high *= 4;
    if (!((*this)(distance, low) < energy && (*this)(distance, high) > energy)) return 0;
    for (int k = 0; k < bisections; ++k) {
      const double middle = std::sqrt(low * high);
      ((*this)(distance, middle) < energy ? low : high) = middle;
    }
    return std::sqrt(low * high);
  }

 private:
  const End& end_;
  std::size_t a_;
  double side_;
  std::vector<double> v_;
  BesideLevel beside_;
  const BesideLevel::Values* values_ = nullptr;
};

/// What a sequence tends to whose distance from that falls like a power: Aitken's extrapolation.
double extrapolated(double before, double middle, double last) {
  const double first = middle - before, change = last - middle;
  return std::abs(change) < 0.9 * std::abs(first) ? last + change * change / (first - change) : last;
}

/// Motions that leave the level with one energy.
class Departure {
 public:
  Departure(const Lagrangian& lagrangian, const End& end, std::size_t a, double side, double way,
            double duration)
      : energy_(lagrangian, end, a, side),
        speed_(way / duration),
        distance_(energy_.rounded(first_distance * way)),
        level_(energy_(distance_, speed_)) {}

  /// γ of d' ~ d^−γ; 0 if no motion leaves the level, or not by a power. The slopes at pairs of distances
  /// differ from γ by a power of the distance, until the energy has lost its digits: of their limits that
  /// which moves least to the next.
  double exponent() {
    if (!std::isfinite(level_)) return 0;
    std::vector<double> slopes;
    double found = 0, least = exponent_change, limit = NAN;
    for (int k = 0; k < distances && least > roundoff; ++k) {
      const double next = energy_.rounded(nearer * distance_);
      if (!(next > energy_.nearest())) break;
      const double faster = energy_.speed(next, level_, speed_);
      if (!(faster > 0) || !std::isfinite(faster)) break;
      slopes.push_back(std::log(faster / speed_) / std::log(distance_ / next));
      speed_ = faster;
      distance_ = next;
      const std::size_t known = slopes.size();
      if (known < 3) continue;
      const double before = limit;
      limit = extrapolated(slopes[known - 3], slopes[known - 2], slopes[known - 1]);
      if (!(std::abs(limit - before) <= least)) continue;
      least = std::abs(limit - before);
      found = limit;
    }
    return found;
  }

  /// The limit of ∂L/∂d' d^γ, from which it differs by d^2γ.
  DoubleDouble strength(double gamma) {
    const double near = energy_.rounded(std::max(gauge_distance * distance_, energy_.nearest() / nearer)),
                 far = energy_.rounded(near / nearer);
    const DoubleDouble fall = power(DoubleDouble(near) / far, 2 * gamma);
    return (strength_at(near, gamma) - fall * strength_at(far, gamma)) / (1.0 - fall);
  }

 private:
  DoubleDouble strength_at(double distance, double gamma) {
    energy_(distance, energy_.speed(distance, level_, speed_ * std::pow(distance_ / distance, gamma)));
    return energy_.momentum() * power(distance, gamma);
  }

  EnergyBeside energy_;
  double speed_, distance_;  ///< at the nearest distance so far
  double level_;             ///< the energy
};

struct Powers {
  double gamma = 0, m = 0, time = 0;
};

/// The simple fraction that an exponent is but for its error, as far as it is measured; else the exponent.
double simplified(double gamma) {
  for (int denominator = 2; denominator <= most_denominator; ++denominator)
    if (const double p = std::round(gamma * denominator);
        p >= 1 && std::abs(gamma - p / denominator) <= (denominator <= small_denominator ? whole : exact))
      return p / denominator;
  return gamma;
}

/// γ, m and k = m (1 + γ). Beside the end L̃ is s^(k−1) times powers of w^2γm. Gauss's rule integrates the
/// former if k is whole, and the less it is, the more digits has w. The latter are smooth if 2γm is whole,
/// and hardly disturb if it is large. Weak powers do not become so.
std::optional<Powers> powers_of(double measured) {
  const double gamma = simplified(measured);
  if (!(gamma > least_exponent && gamma < largest_exponent)) return std::nullopt;
  const auto by_time = [gamma](double k) { return Powers{gamma, k / (1 + gamma), k}; };
  const auto left = [gamma](double k) { return 2 * gamma * k / (1 + gamma); };
  for (int k = 2; k <= small_time; ++k)
    if (std::abs(left(k) - std::round(left(k))) < roundoff) return by_time(k);
  for (int k = least_time; k <= largest_time; ++k)
    if (left(k) > smooth_power) return by_time(k);
  return by_time(2 * (1 + gamma) / (1 - gamma));
}

/// The way between the ends; where there is none, that in which the action is least against it.
double way_of(const Problem& problem, std::size_t a) {
  const std::size_t n = problem.coordinates();
  const std::vector<double>& x = problem.ends.offset;
  if (problem.ends.fixed[a] && problem.ends.fixed[n + a] && x[a] != x[n + a])
    return std::abs(x[n + a] - x[a]);
  return problem.duration.value;
}

/// To which side of its level L is finite: that of the guess, of the other end, or the only one.
double side_of(const Problem& problem, const End& end, std::size_t a) {
  const std::size_t n = problem.coordinates();
  const double way = way_of(problem, a) * first_distance;
  const auto allowed = [&](double side) {
    std::vector<double> q = end.q, v(n, 0);
    q[a] += side * way;
    return finite_at(*problem.lagrangian, q, v, end.time);
  };
  double towards = 0;
  if (problem.guess.given()) {
    std::vector<double> q(n);
    problem.guess.at(0.5, q);
    towards = q[a] - end.q[a];
  } else if (problem.ends.fixed[a] && problem.ends.fixed[n + a]) {
    towards = problem.ends.offset[end.at_end ? a : n + a] - end.q[a];
  }
  if (towards != 0) return allowed(std::copysign(1, towards)) ? std::copysign(1, towards) : 0;
  return allowed(1) ? 1 : allowed(-1) ? -1 : 0;
}

/// Whether a row of the relation has more than one end value.
bool coupled(const BoundaryRelation& relation) {
  std::vector<int> entries(relation.rows, 0);
  for (const Triplet& entry : relation.matrix) ++entries[entry.row];
  return std::ranges::any_of(entries, [](int count) { return count != 1; });
}

bool supported(const Problem& problem) {
  if (!problem.has_ends() || problem.initial || problem.paired || problem.copies || problem.pair ||
      problem.manifold || problem.phase || problem.extension || problem.inequalities)
    return false;
  const std::size_t n = problem.coordinates();
  if (n > most_coordinates || !problem.boundary.momenta.empty() || !problem.boundary.costs.empty())
    return false;
  return !coupled(problem.boundary);
}

/// The one coordinate of an end that is at a level, and the side of it on which L is finite; −1 where there
/// is none, or more than one.
std::pair<int, double> level_of(const Problem& problem, const End& end) {
  int coordinate = -1;
  double side = 0;
  for (std::size_t a = 0; a < end.q.size(); ++a) {
    const double towards = end.fixed[a] ? side_of(problem, end, a) : 0;
    if (towards == 0) continue;
    if (coordinate >= 0) return {-1, 0};
    coordinate = static_cast<int>(a);
    side = towards;
  }
  return {coordinate, side};
}

}  // namespace

std::optional<InfiniteLagrangian> infinite_lagrangian(const Problem& problem) {
  if (!problem.has_ends() || problem.initial || problem.paired || problem.manifold || problem.phase ||
      coupled(problem.boundary))
    return std::nullopt;
  for (const bool at_end : {false, true}) {
    const End end = end_of(problem, at_end);
    if (!infinite_at(*problem.lagrangian, end, problem.duration.value)) continue;
    InfiniteLagrangian found{.at_end = at_end, .q = end.q};
    const std::vector<SingularTime> times = singular_times(problem);
    found.by_time = std::ranges::count(times, at_end, &SingularTime::at_end) > 0;
    if (found.by_time) return found;
    const auto [coordinate, side] = level_of(problem, end);
    found.coordinate = coordinate;
    // Where free coordinates are is not known.
    if (coordinate < 0 && std::ranges::count(end.fixed, 0) > 0) continue;
    if (coordinate >= 0)
      found.beside = end.q[coordinate] + side * first_distance * way_of(problem, coordinate);
    return found;
  }
  return std::nullopt;
}

double EndVariables::time(double s) const {
  const double x = std::clamp(s / duration, 0.0, 1.0);
  if (!singular(true)) return duration * std::pow(x, start);
  if (!singular(false)) return duration - remaining(s);
  const double a = std::pow(x, start);
  return duration * a / (a + std::pow(1 - x, end));
}

DoubleDouble EndVariables::precise_time(double s) const {
  return s < 0.5 * duration ? DoubleDouble(time(s)) : DoubleDouble(duration) - remaining(s);
}

double EndVariables::remaining(double s) const {
  const double x = std::clamp(s / duration, 0.0, 1.0), y = 1 - x;
  if (!singular(true)) return duration * (1 - std::pow(x, start));
  const double b = std::pow(y, end);
  return singular(false) ? duration * b / (std::pow(x, start) + b) : duration * b;
}

double EndVariables::rate(double s) const {
  const double x = std::clamp(s / duration, 0.0, 1.0), y = 1 - x;
  if (!singular(true)) return start * std::pow(x, start - 1);
  if (!singular(false)) return end * std::pow(y, end - 1);
  const double sum = std::pow(x, start) + std::pow(y, end);
  return std::pow(x, start - 1) * std::pow(y, end - 1) * (start * y + end * x) / (sum * sum);
}

double EndVariables::time_inverse(double t) const {
  if (!singular(true)) return duration * std::pow(std::clamp(t / duration, 0.0, 1.0), 1 / start);
  if (!singular(false)) return duration - remaining_inverse(duration - t);
  const auto earlier = [&](double s) {
    const double x = s / duration, a = std::pow(x, start), b = std::pow(1 - x, end);
    return duration * a / (a + b) < t;
  };
  return bisect(0, duration, bisections, earlier).middle();
}

double EndVariables::remaining_inverse(double rest) const {
  if (!singular(false)) return duration * std::pow(std::clamp(rest / duration, 0.0, 1.0), 1 / end);
  EndVariables mirrored = *this;
  std::swap(mirrored.start, mirrored.end);
  return mirrored.time_inverse(rest);
}

double EndVariables::coordinate_at(double w) const { return level + side * std::pow(w, power); }

double EndVariables::variable_at(double q) const {
  return std::pow(std::max(0.0, side * (q - level)), 1.0 / power);
}

namespace {

/// The variable of the time alone, where that makes an end singular.
std::optional<EndVariables> variables_of(const std::vector<SingularTime>& times, double duration) {
  EndVariables variables{.duration = duration};
  for (const SingularTime& time : times) {
    if (time.kind != SingularTime::Kind::powers) return std::nullopt;
    (time.at_end ? variables.end : variables.start) = time.power;
    (time.at_end ? variables.no_momentum_at_end : variables.no_momentum_at_start) = time.unknown_momentum;
    variables.unknown_index = variables.unknown_index || time.unknown_index;
  }
  return times.empty() ? std::nullopt : std::optional(variables);
}

}  // namespace

std::optional<EndVariables> singular_ends(const Problem& problem) {
  if (!supported(problem)) return std::nullopt;
  return singular_ends(problem, singular_times(problem));
}

std::optional<EndVariables> singular_ends(const Problem& problem, const std::vector<SingularTime>& times) {
  if (!supported(problem)) return std::nullopt;
  const Lagrangian& lagrangian = *problem.lagrangian;
  const End ends[] = {end_of(problem, false), end_of(problem, true)};
  std::optional<EndVariables> found = variables_of(times, problem.duration.value);
  for (const End& end : ends) {
    if (found && !found->has_level() && found->singular(end.at_end)) continue;
    if (!infinite_at(lagrangian, end, problem.duration.value)) continue;
    const auto [coordinate, side] = level_of(problem, end);
    if (coordinate < 0 || (found && !found->has_level())) return std::nullopt;
    const auto a = static_cast<std::size_t>(coordinate);
    Departure departure(lagrangian, end, a, side, way_of(problem, a), problem.duration.value);
    const auto powers = powers_of(departure.exponent());
    if (!powers) return std::nullopt;
    EndVariables variables{.coordinate = coordinate,
                           .level = end.q[a],
                           .side = side,
                           .power = powers->m,
                           .duration = problem.duration.value,
                           .speed = powers->gamma};
    if (found && (found->coordinate != variables.coordinate || found->level != variables.level ||
                  found->side != variables.side || found->power != variables.power))
      return std::nullopt;
    if (!found) found = variables;
    (end.at_end ? found->end : found->start) = powers->time;
    (end.at_end ? found->of_end : found->of_start) = departure.strength(powers->gamma);
  }
  return found;
}

namespace {

/// A guess given by the user, with a distance from the level that rises as that of motions does.
class ShapedGuess {
 public:
  ShapedGuess(const Problem& problem, const EndVariables& variables)
      : problem_(problem), x_(variables), q_(problem.coordinates()) {
    for (int k = 0; k <= guess_samples; ++k)
      most_ = std::max(most_, distance(static_cast<double>(k) / guess_samples));
    if (x_.singular(false)) start_ = factor(rise(beside, 2 * beside), x_.power / x_.start);
    if (x_.singular(true)) end_ = factor(rise(1 - beside, 1 - 2 * beside), x_.power / x_.end);
  }

  double variable(double tau) {
    const double power = start_ + tau * (end_ - start_);
    return most_ > 0 ? std::pow(most_ * std::pow(distance(tau) / most_, power), 1.0 / x_.power) : 0;
  }

 private:
  double distance(double tau) {
    problem_.guess.at(tau, q_);
    return std::max(0.0, x_.side * (q_[x_.coordinate] - x_.level));
  }
  double rise(double near, double far) { return std::log2(distance(far) / distance(near)); }
  /// Only slower rises are made faster.
  static double factor(double rise, double wanted) { return rise > wanted ? wanted / rise : 1; }

  const Problem& problem_;
  const EndVariables& x_;
  std::vector<double> q_;
  double most_ = 0, start_ = 1, end_ = 1;
};

/// The guess in w and s, the coordinate of the level `size` times as far from it.
Guess guess_of(const Problem& problem, const EndVariables& variables, double size) {
  const std::size_t n = problem.coordinates(), a = variables.coordinate;
  const double T = variables.duration;
  const std::vector<double>& x = problem.ends.offset;
  const std::vector<char>& fixed = problem.ends.fixed;
  Guess guess;
  std::vector<double> q(n);
  std::optional<ShapedGuess> shaped;
  if (problem.guess.given() && variables.has_level()) shaped.emplace(problem, variables);
  for (int k = 0; k <= guess_samples; ++k) {
    const double tau = static_cast<double>(k) / guess_samples, t = variables.time(tau * T) / T;
    if (problem.guess.given()) {
      problem.guess.at(t, q);
      if (shaped) q[a] = shaped->variable(t);
    } else {
      for (std::size_t b = 0; b < n; ++b) {
        const double from = fixed[b]       ? x[b]
                            : fixed[n + b] ? x[n + b]
                                           : 0,
                     to = fixed[n + b] ? x[n + b] : from;
        q[b] = from + t * (to - from);
      }
    }
    if (!problem.guess.given() && variables.has_level()) {
      const double far = std::pow(size, 1.0 / variables.power);
      const double ends[] = {fixed[a] ? variables.variable_at(x[a]) : far,
                             fixed[n + a] ? variables.variable_at(x[n + a]) : far};
      q[a] = ends[0] + tau * (ends[1] - ends[0]);
      const bool both = variables.singular(false) && variables.singular(true);
      // An arch whose height is a power of 4 t (T − t)/T².
      if (both)
        q[a] = far * std::pow(4 * t * (1 - t), 1 / variables.start);
      else if (fixed[a] && fixed[n + a])
        q[a] += far * 4 * tau * (1 - tau);
    }
    guess.tau.push_back(tau);
    guess.q.insert(guess.q.end(), q.begin(), q.end());
  }
  return guess;
}

/// ∫ L̃ ds of a guess by the midpoint rule.
double action_of(const Lagrangian& lagrangian, const Guess& guess, double duration) {
  const std::size_t n = lagrangian.structure().coordinates;
  std::vector<double> q(n), v(n);
  Scratch scratch;
  double sum = 0;
  for (std::size_t k = 0; k + 1 < guess.tau.size(); ++k) {
    const double step = (guess.tau[k + 1] - guess.tau[k]) * duration;
    for (std::size_t a = 0; a < n; ++a) {
      const double before = guess.q[k * n + a], after = guess.q[(k + 1) * n + a];
      q[a] = 0.5 * (before + after);
      v[a] = (after - before) / step;
    }
    const double t = 0.5 * (guess.tau[k] + guess.tau[k + 1]) * duration;
    sum += step * evaluate_at(lagrangian, q, v, t, Order::value, scratch).value;
  }
  return sum;
}

/// How far the path leaves its level between the ends, or where it is free: with that the action is least.
Guess best_guess(const Problem& problem, const EndVariables& variables, const Lagrangian& lagrangian) {
  if (problem.guess.given() || !variables.has_level()) return guess_of(problem, variables, 0);
  const std::size_t n = problem.coordinates(), a = variables.coordinate;
  const bool both = variables.singular(false) && variables.singular(true);
  const bool between = !both && problem.ends.fixed[a] && problem.ends.fixed[n + a];
  const double T = problem.duration.value;
  Guess best = guess_of(problem, variables, between ? 0 : T);
  double least = between ? action_of(lagrangian, best, T) : INFINITY;
  const Guess straight = best;
  for (int k = -scanned_sizes; k <= scanned_sizes; ++k) {
    Guess guess = guess_of(problem, variables, T * std::pow(2.0, k));
    const double action = action_of(lagrangian, guess, T);
    if (!(action < least)) continue;
    // It may fall without bound.
    if (k == scanned_sizes) return straight;
    least = action;
    best = std::move(guess);
  }
  return best;
}

}  // namespace

Problem smoothed(const Problem& problem, const EndVariables& variables) {
  Problem result = problem;
  const auto lagrangian = std::make_shared<SmoothedLagrangian>(problem.lagrangian, variables);
  const int n = problem.coordinates();
  for (const Triplet& entry : problem.boundary.matrix)
    if (entry.column % n == variables.coordinate)
      result.boundary.value[entry.row] =
          entry.value * variables.variable_at(problem.boundary.value[entry.row] / entry.value);
  result.ends = solve_relation(result.boundary);
  result.guess = best_guess(problem, variables, *lagrangian);
  result.lagrangian = lagrangian;
  result.symmetries.clear();
  result.reduction = nullptr;
  result.curvature.reset();
  result.duration.free = false;
  result.duration.energy.reset();
  result.duration.where = nullptr;
  return result;
}

}  // namespace extremal
