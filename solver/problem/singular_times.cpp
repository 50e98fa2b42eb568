#include "problem/singular_times.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "linear/dense.hpp"
#include "machine/largest.hpp"
#include "problem/limits.hpp"

namespace extremal {

namespace limit = limits::singular_times;

namespace {

bool is_whole(double e, double error) { return std::abs(e - std::round(e)) < error; }

/// A power of motions by Euler's equation, and whether ∂²L/∂q² is negative.
struct Euler {
  double power;
  bool attractive;
};

/// What L does beside an end, at shorter and shorter times from it.
class Beside {
 public:
  Beside(const Problem& problem, bool at_end)
      : lagrangian_(*problem.lagrangian),
        at_end_(at_end),
        duration_(problem.duration.value),
        nearest_(at_end ? limit::nearest_to_end : limit::nearest) {
    const std::size_t n = problem.coordinates(), first = at_end ? n : 0;
    const std::vector<double>& x = problem.ends.offset;
    double way = 0;
    for (const double value : x) way = std::max(way, std::abs(value));
    for (std::size_t b = 0; b < n; ++b) way = std::max(way, std::abs(x[n + b] - x[b]));
    if (way == 0) way = 1;
    for (std::size_t b = 0; b < n; ++b) {
      const double part = limit::general * (1 + 0.1 * static_cast<double>(b)) * way;
      general_.push_back(x[first + b] + part);
      end_.push_back(problem.ends.fixed[first + b] ? x[first + b] : general_.back());
      v_.push_back(part / duration_);
    }
    rest_.assign(n, 0);
  }

  /// Whether L is infinite at the time of the end itself, at a point in general position.
  bool infinite() { return !std::isfinite(at(general_, v_, 0, Order::value).value); }

  /// e of the largest of a part of L ~ c τ^e; nothing where that is zero, by what it is in general, or not by
  /// a power.
  template <class Size>
  std::optional<double> exponent(const std::vector<double>& q, const std::vector<double>& v,
                                 const Size& size) {
    std::vector<double> slopes;
    double before = 0, time = 0;
    for (int k = limit::times - 1; k >= 0; --k) {
      const double away = time_from_end(nearest_ * std::pow(limit::shorter, k));
      const double now = size(at(q, v, away, Order::hessian));
      if (!(now > limit::roundoff * size(at(general_, v_, away, Order::hessian))) || !std::isfinite(now))
        return std::nullopt;
      if (time > 0) slopes.push_back(std::log(before / now) / std::log(time / away));
      before = now;
      time = away;
    }
    // Aitken's extrapolation, as the next power decides how slopes tend to e.
    const std::size_t last = slopes.size() - 1;
    const double first = slopes[last - 1] - slopes[last - 2], change = slopes[last] - slopes[last - 1];
    return std::abs(change) < 0.9 * std::abs(first) ? slopes[last] + change * change / (first - change)
                                                    : slopes[last];
  }

  std::optional<double> mass() {
    return exponent(general_, v_, [](const PointValues& l) { return largest_if_finite(l.vv); });
  }
  std::optional<double> force() {
    return exponent(end_, v_, [](const PointValues& l) { return largest_if_finite(l.dq); });
  }
  std::optional<double> stiffness() {
    return exponent(end_, v_, [](const PointValues& l) { return largest_if_finite(l.qq); });
  }
  /// Of L at rest there.
  std::optional<double> value() {
    return exponent(end_, rest_, [](const PointValues& l) { return std::abs(l.value); });
  }

  /// The larger roots r of Euler's equation, 0 where there is none.
  std::vector<Euler> euler(double a) {
    const double away = time_from_end(nearest_);
    const PointValues values = at(end_, v_, away, Order::hessian);
    const auto n = static_cast<Eigen::Index>(end_.size());
    const Eigen::Map<const Eigen::MatrixXd> mass(values.vv.data(), n, n), stiffness(values.qq.data(), n, n);
    const Eigen::LLT<Eigen::MatrixXd> factors(mass);
    if (factors.info() != Eigen::Success) return {};
    Eigen::MatrixXd reduced = factors.matrixL().solve(stiffness);
    reduced = factors.matrixL().solve(reduced.transpose()).eval();
    std::vector<Euler> found;
    for (const double ratio : symmetric_eigenvalues(reduced)) {
      const double part = 4 * ratio * away * away, root = (1 - a) * (1 - a) + part;
      found.push_back({root >= 0 ? (1 - a + std::sqrt(root)) / 2 : 0, part < -limit::exact});
    }
    return found;
  }

 private:
  double time_from_end(double part) const {
    const double away = part * duration_;
    return at_end_ ? duration_ - (duration_ - away) : away;
  }
  PointValues at(const std::vector<double>& q, const std::vector<double>& v, double away, Order order) {
    return evaluate_at(lagrangian_, q, v, at_end_ ? duration_ - away : away, order, scratch_);
  }

  const Lagrangian& lagrangian_;
  bool at_end_;
  double duration_, nearest_;
  std::vector<double> general_, end_, v_, rest_;
  Scratch scratch_;
};

/// Numbers k that are tried in turn. Elements have the mass s^(1 − k (1 − a)), which larger k make more
/// uneven; but from the usual one on other terms are smoother as well. Small k make a weight even.
std::vector<int> candidates(double a) {
  std::vector<int> result;
  const bool weight = a > limit::least_exponent && a < 1 - limit::exact;
  const int most = static_cast<int>(
      std::min(limit::largest_power / std::max(std::abs(1 - a), limit::exact), limit::most_power));
  for (int k = limit::usual_power; !weight && k >= limit::least_power; --k) result.push_back(k);
  for (int k = weight ? limit::least_power : limit::usual_power + 1; k <= most; ++k) result.push_back(k);
  return result;
}

/// Whether the power k e of s is one that elements resolve, from `enough` on if it is not whole.
bool resolved(double k, double e, double enough) {
  return k * e >= enough || (e > limit::exact && is_whole(k * e, k * limit::exact));
}

/// Of what is a sum of powers of the time from an end.
struct PowersOfTime {
  std::vector<double> path, momentum, action;
  std::vector<double> held_momentum;  ///< of motions by Euler's equation
  bool held = false;                  ///< ∂²L/∂q² grows like τ^(a−2) or faster
  bool essential = false;             ///< or faster
  bool attractive = false;            ///< like τ^(a−2), and is negative

  std::vector<double> positive() const {
    std::vector<double> all;
    for (const std::vector<double>* part : {&path, &momentum, &action, &held_momentum})
      std::ranges::copy_if(*part, std::back_inserter(all), [](double e) { return e >= limit::exact; });
    return all;
  }
};

PowersOfTime read_powers(Beside& beside, double a, bool infinite) {
  PowersOfTime powers{.path = {}, .momentum = {}, .action = {1 + std::abs(a)}, .held_momentum = {}};
  if (a < 1 - limit::exact) powers.path.push_back(1 - a);
  if (const std::optional<double> b = beside.force()) {
    powers.path.push_back(2 + *b - a);
    powers.momentum.push_back(1 + *b);
    powers.action.push_back(3 + 2 * *b - a);
  }
  if (const std::optional<double> value = beside.value(); value && infinite)
    powers.action.push_back(1 + *value);
  const std::optional<double> stiffness = beside.stiffness();
  powers.held = stiffness && *stiffness < a - 2 + limit::exact;
  powers.essential = stiffness && *stiffness < a - 2 - limit::exact;
  if (!powers.held || powers.essential) return powers;
  for (const Euler& euler : beside.euler(a)) {
    powers.attractive = powers.attractive || euler.attractive;
    powers.path.push_back(euler.power);
    powers.held_momentum.push_back(euler.power + a - 1);
  }
  return powers;
}

/// The first k that makes all powers whole or large; else that of the action.
double smoothing_power(double a, const PowersOfTime& powers) {
  const std::vector<int> tried = candidates(a);
  const auto first = [&](const std::vector<double>& all, double enough) {
    return std::ranges::find_if(tried, [&](int k) {
      return std::ranges::all_of(all, [&](double e) { return resolved(k, e, enough); });
    });
  };
  if (const auto k = first(powers.positive(), limit::smooth); k != tried.end()) return *k;
  if (const auto k = first(powers.action, limit::smooth_enough); k != tried.end()) return *k;
  return limit::usual_power;
}

/// What elements with t ~ s^k make of an end with these powers.
void choose_power(const PowersOfTime& powers, bool fixed, SingularTime& time) {
  const double k = powers.essential ? limit::least_power : smoothing_power(time.mass, powers);
  time.power = k;
  // Where q is free the point at which L was looked at is not that of the path.
  const bool precise =
      std::ranges::all_of(powers.action, [k](double e) { return resolved(k, e, limit::smooth_enough); }) &&
      std::ranges::all_of(powers.momentum, [k](double e) { return k * e > -limit::steepest; });
  if (fixed && !precise) time.kind = SingularTime::Kind::slow;
  const auto known = [k](double e) { return std::abs(e) < limit::exact || resolved(k, e, limit::smooth); };
  time.unknown_momentum =
      !std::ranges::all_of(powers.momentum, known) || !std::ranges::all_of(powers.held_momentum, known);
  time.unknown_index = powers.essential || powers.attractive;
}

std::optional<SingularTime> singular_time(const Problem& problem, bool at_end) {
  const Structure& structure = problem.lagrangian->structure();
  Beside beside(problem, at_end);
  const bool infinite = beside.infinite();
  // What depends on t is no mass, and finite.
  if (!infinite && structure.quadratic) return std::nullopt;
  const std::optional<double> mass = beside.mass();
  if (!mass || (!infinite && !(*mass > limit::least_exponent))) return std::nullopt;
  SingularTime found{.at_end = at_end, .mass = *mass};
  const PowersOfTime powers = read_powers(beside, *mass, infinite);
  const std::vector<double> positive = powers.positive();
  const bool fixed = problem.ends.fixes(at_end);
  if (fixed && std::ranges::any_of(powers.action, [](double e) { return e < limit::exact; }))
    found.kind = SingularTime::Kind::divergent;
  else if (fixed && !infinite && !powers.held && *mass > 1 - limit::exact)
    found.kind = SingularTime::Kind::loose;
  else if (!infinite && std::ranges::all_of(positive, [](double e) { return is_whole(e, limit::exact); }))
    return std::nullopt;
  else
    choose_power(powers, fixed, found);
  return found;
}

}  // namespace

std::vector<SingularTime> singular_times(const Problem& problem) {
  std::vector<SingularTime> found;
  if (problem.lagrangian->structure().autonomous) return found;
  for (const bool at_end : {false, true})
    if (const std::optional<SingularTime> time = singular_time(problem, at_end)) found.push_back(*time);
  return found;
}

}  // namespace extremal
