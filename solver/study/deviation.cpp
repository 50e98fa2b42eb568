#include "study/deviation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace extremal {

namespace {

constexpr int intervals = 400;
constexpr int most_shifts = 8;
/// Of the duration: beyond, the phases are no longer near each other.
constexpr double longest_shift = 0.25;

/// The differences at the times that both have, and the shift that would reduce them.
struct Difference {
  double largest = 0, shift = 0;
};

Difference difference(const Motion& motion, const Motion& reference, std::size_t n, double delay,
                      bool shifts) {
  std::vector<double> here, there, beyond;
  for (int k = 0; k <= intervals; ++k) {
    const double t = k == intervals ? reference.duration : reference.duration * k / intervals;
    const double wanted = t + delay, own = std::clamp(wanted, 0.0, motion.duration);
    if (shifts && delay != 0 && own != wanted) continue;
    here.push_back(t);
    there.push_back(own);
    beyond.push_back(wanted - own);
  }
  const MotionSamples a = motion.at(there), b = reference.at(here);
  Difference result;
  if (a.q.size() < b.q.size()) result.largest = std::numeric_limits<double>::infinity();
  double product = 0, square = 0;
  for (std::size_t i = 0; i < a.q.size(); ++i) {
    const double apart = a.q[i] + beyond[i / n] * a.v[i] - b.q[i];
    result.largest = std::max(result.largest, std::abs(apart));
    product += apart * a.v[i];
    square += a.v[i] * a.v[i];
  }
  if (square > 0) result.shift = -product / square;
  return result;
}

}  // namespace

Motion motion_of(const Trajectory& trajectory) {
  return {
      trajectory.duration(), [&trajectory](const std::vector<double>& times) {
        const std::size_t n = trajectory.coordinates;
        MotionSamples samples{std::vector<double>(times.size() * n), std::vector<double>(times.size() * n)};
        for (std::size_t k = 0; k < times.size(); ++k)
          trajectory.at(times[k], {samples.q.data() + k * n, n}, {samples.v.data() + k * n, n});
        return samples;
      }};
}

double deviation(const Motion& motion, const Motion& reference, int coordinates, bool shifts) {
  double delay = 0;
  Difference now = difference(motion, reference, coordinates, delay, shifts);
  for (int k = 0; k < most_shifts && shifts; ++k) {
    const double next = delay + now.shift;
    if (!(std::abs(next) <= longest_shift * reference.duration)) break;
    const Difference shifted = difference(motion, reference, coordinates, next, shifts);
    if (!(shifted.largest < now.largest)) break;
    delay = next;
    now = shifted;
  }
  return now.largest;
}

}  // namespace extremal
