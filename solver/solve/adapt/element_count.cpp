#include "solve/adapt/element_count.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "solve/adapt/limits.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::pinned;

ElementCount::ElementCount(const Scheme& scheme, double tolerance, int first, int most)
    : scheme_(scheme), tolerance_(tolerance), now_(first), most_(most) {}

/// Elements that bring the error to `goal` if it goes on falling as it did between others, of which the best
/// rate counts.
double ElementCount::needed(const Tried& now, const Tried& before, double goal) const {
  double rate = 0;
  for (const Tried& earlier : {first_, before})
    rate = std::max(rate, std::log(earlier.error / now.error) /
                              std::log(static_cast<double>(now.elements) / earlier.elements));
  return rate > 0 ? now.elements * std::pow(now.error / goal, 1 / rate) : INFINITY;
}

bool ElementCount::grow(double excess, const Scales& size, Trials so_far) {
  const double goal = tolerance_ * size.q, error = excess * goal;
  const double noise = std::max(amplified_roundoff * size.q, at_roundoff * size.magnitude);
  const Tried tried{now_, error}, before = std::exchange(latest_, tried);
  if (first_.elements == 0) first_ = tried;
  if (error < stagnation * least_.error) least_ = tried;
  const bool futile =
      so_far.dear && now_ > futile_growth * least_.elements && least_.error < resolved * size.q;
  if (futile || (error > stagnation * before.error && error < noise)) {
    failure_ = fmt::format("the tolerance {:.1e} is below roundoff with {} elements or more; loosen it",
                           tolerance_, now_);
    return false;
  }
  // The order of q throughout, not that of the nodes alone.
  const int order = std::min(scheme_.order, scheme_.degree + 1);
  const double growth = std::pow(2 * excess, 1.0 / order);
  // An error that falls as expected gives the number of elements needed; else the next number.
  const bool regular = error > regular_fall * expected_ && error < expected_ / regular_fall;
  const bool hopeless = (so_far.dear || so_far.kinked) && before.elements > 0 && error < resolved * size.q &&
                        needed(tried, before, goal) > most_;
  if (hopeless || now_ * (regular ? growth : std::min(growth, most_growth)) > most_) {
    failure_ =
        fmt::format("{} needs more than {} elements for the tolerance {:.0e}; loosen it{}", scheme_.name,
                    most_, tolerance_, tolerance_ < unit_roundoff ? "" : ", or leave the scheme out");
    return false;
  }
  const double factor = std::clamp(growth, 1.1, most_growth);
  expected_ = error * std::pow(factor, -order);
  now_ = std::max(now_ + 1, static_cast<int>(std::ceil(now_ * factor)));
  return true;
}

std::string no_companion(int elements) {
  return fmt::format(
      "elements of higher degree give no extremal that conserves its energy near that of {} elements; "
      "try another tolerance or guess, or leave the scheme out",
      elements);
}

}  // namespace extremal
