#include "solve/search/time_law.hpp"

#include <algorithm>
#include <cmath>

#include "machine/bisect.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::time_law;

void TimeLaw::reset(const Problem& problem, const ElementTables& tables, int elements) {
  autonomous_ = problem.lagrangian->structure().autonomous;
  if (autonomous_) action_.reset(*problem.lagrangian, tables, elements, true, Condense::nothing);
}

/// False where L is not convex in q'.
bool TimeLaw::measure(const Path& path) {
  const int elements = path.elements(), lanes = path.lanes();
  const double T = path.duration();
  a_.resize(elements);
  c_.resize(elements);
  action_.visit(path, true, [&](int b, const BatchValues& values) {
    for (int lane = 0; lane < std::min(lanes, elements - b * lanes); ++lane) {
      const int k = b * lanes + lane;
      const double h = path.h(b)[lane];
      a_[k] = 0.5 * values.corner[lane] * T * T * h;
      c_[k] = values.slope[lane] + a_[k] / (h * h);
    }
  });
  const double most = *std::ranges::max_element(a_), least = *std::ranges::min_element(c_);
  bool convex = most > 0;
  for (int k = 0; k < elements; ++k) {
    convex = convex && std::isfinite(a_[k]) && std::isfinite(c_[k]) && a_[k] > -roundoff * most;
    a_[k] = std::max(a_[k], standing * most);
    c_[k] -= least;
  }
  return convex;
}

/// Of all elements, with that energy above the least possible one.
double TimeLaw::duration(double energy) const {
  double sum = 0;
  for (std::size_t k = 0; k < a_.size(); ++k) sum += std::sqrt(a_[k] / (energy + c_[k]));
  return sum;
}

/// Above the least possible one, by bisection of its logarithm.
std::optional<double> TimeLaw::energy_for(double T) const {
  double sum = 0;
  for (const double a : a_) sum += std::sqrt(a);
  const double high = 2 * std::log(sum / T);  // the lengths add up to less than T
  double low = high;
  for (int k = 0; duration(std::exp(low)) < T; ++k, low -= 2)
    if (k == most_octaves) return std::nullopt;
  const auto below = [&](double logarithm) { return duration(std::exp(logarithm)) > T; };
  return std::exp(bisect(low, high, limits::time_law::halvings, below).middle());
}

bool TimeLaw::apply(Path& path, double T, double least_energy) {
  if (!autonomous_ || !measure(path)) return false;
  std::optional<double> energy = energy_for(T);
  if (!energy) return false;
  const double floor = least_energy / (1 - least_energy) * *std::ranges::max_element(c_);
  if (*energy < floor) {
    energy = floor;
    T = duration(floor);
  }
  const double least = shortest * T / static_cast<double>(a_.size());
  lengths_.resize(a_.size());
  double total = 0, t = 0;
  for (std::size_t k = 0; k < a_.size(); ++k)
    total += lengths_[k] = std::max(least, std::sqrt(a_[k] / (*energy + c_[k])));
  shifts_.assign(lengths_.size() + 1, 0);
  for (std::size_t k = 0; k + 1 < lengths_.size(); ++k)
    shifts_[k + 1] = (t += lengths_[k] / total) - path.mesh()[k + 1];
  if (!path.move_mesh(shifts_, 1, 0)) return false;
  path.set_duration(T);
  path.load_ends();
  return true;
}

}  // namespace extremal
