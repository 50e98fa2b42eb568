#include "problem/singular_times.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "problem/limits.hpp"

namespace extremal {

namespace limit = limits::singular_times;

namespace {

/// A point beside an end in general position, and how large mass and force are there.
class Beside {
 public:
  Beside(const Problem& problem, bool at_end)
      : lagrangian_(*problem.lagrangian), at_end_(at_end), duration_(problem.duration.value) {
    const std::size_t n = problem.coordinates();
    const std::vector<double>& x = problem.ends.offset;
    double way = 0;
    for (std::size_t b = 0; b < n; ++b)
      way = std::max({way, std::abs(x[n + b] - x[b]), std::abs(x[b]), std::abs(x[n + b])});
    if (way == 0) way = 1;
    for (std::size_t b = 0; b < n; ++b) {
      const double part = limit::general + 0.1 * limit::general * static_cast<double>(b);
      q_.push_back(x[at_end ? n + b : b] + part * way);
      v_.push_back(part * way / duration_);
    }
  }

  /// Whether L is finite at the time of the end itself.
  bool finite() { return std::isfinite(at(0, Order::value).value); }

  struct Sizes {
    double mass = 0, force = 0;
  };
  Sizes operator()(double part) {
    const PointValues values = at(part * duration_, Order::hessian);
    Sizes sizes;
    for (const double x : values.vv) sizes.mass = std::max(sizes.mass, std::abs(x));
    for (const double x : values.dq) sizes.force = std::max(sizes.force, std::abs(x));
    return std::isfinite(values.value) ? sizes : Sizes{NAN, NAN};
  }

 private:
  PointValues at(double away, Order order) {
    return evaluate_at(lagrangian_, q_, v_, at_end_ ? duration_ - away : away, order, scratch_);
  }

  const Lagrangian& lagrangian_;
  bool at_end_;
  double duration_;
  std::vector<double> q_, v_;
  Scratch scratch_;
};

/// e of what is c τ^e + … at times that become shorter by one factor, from its last values.
std::optional<double> exponent_of(const std::vector<double>& values) {
  std::vector<double> slopes;
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (!(values[k] > 0) || !std::isfinite(values[k])) return std::nullopt;
    slopes.push_back(std::log(values[k - 1] / values[k]) / std::log(limit::shorter));
  }
  // Aitken's extrapolation, as the next power decides how slopes tend to e.
  const std::size_t last = slopes.size() - 1;
  const double first = slopes[last - 1] - slopes[last - 2], change = slopes[last] - slopes[last - 1];
  const bool falls = std::abs(change) < 0.9 * std::abs(first);
  return falls ? slopes[last] + change * change / (first - change) : slopes[last];
}

}  // namespace

std::optional<PowersOfTime> powers_of_time(const Problem& problem, bool at_end) {
  if (problem.lagrangian->structure().autonomous) return std::nullopt;
  Beside beside(problem, at_end);
  const bool infinite = !beside.finite();
  // What depends on t is elsewhere.
  if (!infinite && problem.lagrangian->structure().quadratic) return std::nullopt;
  std::vector<double> masses, forces;
  double part = limit::nearest * std::pow(limit::shorter, limit::times - 1);
  for (int k = 0; k < limit::times; ++k, part /= limit::shorter) {
    const Beside::Sizes sizes = beside(part);
    masses.push_back(sizes.mass);
    forces.push_back(sizes.force);
  }
  const std::optional<double> mass = exponent_of(masses);
  if (!mass || (!infinite && !(*mass > limit::least_exponent))) return std::nullopt;
  const bool forced = std::ranges::any_of(forces, [](double force) { return force > 0; });
  const std::optional<double> force = forced ? exponent_of(forces) : std::nullopt;
  if (forced && !force) return std::nullopt;
  return PowersOfTime{.mass = *mass, .force = force, .infinite = infinite};
}

std::optional<LooseEnd> loose_end(const Problem& problem) {
  for (const bool at_end : {false, true}) {
    if (!problem.ends.fixes(at_end)) continue;
    const std::optional<PowersOfTime> powers = powers_of_time(problem, at_end);
    if (powers && !powers->infinite && powers->mass > 1 - limit::exact) return LooseEnd{at_end, powers->mass};
  }
  return std::nullopt;
}

double smoothing_power(const PowersOfTime& powers) {
  std::vector<double> exponents;
  if (powers.mass < 1) exponents.push_back(1 - powers.mass);
  if (powers.force) exponents.push_back(2 + *powers.force - powers.mass);
  for (int k = 2; k <= limit::largest_power; ++k)
    if (std::ranges::all_of(exponents,
                            [k](double e) { return std::abs(k * e - std::round(k * e)) < k * limit::exact; }))
      return k;
  return limit::otherwise;
}

}  // namespace extremal
