#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rivals/dop853.hpp"
#include "rivals/flow.hpp"
#include "rivals/shooting.hpp"

namespace extremal {

namespace {

RightHandSide motion(Flow& flow) {
  return [&flow](double t, std::span<const double> y, std::span<double> slope) {
    return flow.slope(t, y, slope);
  };
}

}  // namespace

Flight fly(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
           std::span<const double> times, double tolerance) {
  const std::size_t n = lagrangian.structure().coordinates;
  if (q.size() != n || v.size() != n)
    throw std::invalid_argument(fmt::format(
        "a state of {} coordinates and {} velocities for a Lagrangian of {}", q.size(), v.size(), n));
  if (!std::is_sorted(times.begin(), times.end()) || (!times.empty() && !(times.front() >= 0)))
    throw std::invalid_argument("the times of an integration must ascend from 0");
  Flow flow(lagrangian);
  std::vector<double> y(2 * n), velocity(n);
  std::copy(q.begin(), q.end(), y.begin());
  const std::span<double> now(y);
  Flight flight;
  if (!flow.momentum(q, v, 0, now.subspan(n))) return flight;
  Dop853 integrator(motion(flow), static_cast<int>(2 * n));
  for (const double time : times) {
    if (integrator.advance(flight.reached, y, time, {.tolerance = tolerance, .block = static_cast<int>(n)}) !=
        Integrated::done)
      return flight;
    if (!flow.velocity(now.first(n), now.subspan(n), time, velocity)) return flight;
    flight.q.insert(flight.q.end(), y.begin(), y.begin() + n);
    flight.v.insert(flight.v.end(), velocity.begin(), velocity.end());
  }
  flight.complete = true;
  return flight;
}

}  // namespace extremal
