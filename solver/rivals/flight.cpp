#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "rivals/shooting.hpp"

namespace extremal {

namespace {

/// Appends to a flight the states at ascending times >= t, from (q, q') at t. False where it stopped.
bool carry(Flow& flow, double t, std::span<const double> q, std::span<const double> v,
           std::span<const double> times, double tolerance, const Deadline& deadline, Flight& flight) {
  const std::size_t n = q.size();
  std::vector<double> y(2 * n), velocity(n);
  std::copy(q.begin(), q.end(), y.begin());
  const std::span<double> now(y);
  flight.reached = t;
  if (!flow.momentum(q, v, t, now.subspan(n))) return false;
  Dop853 integrator([&flow](double at, auto state, auto slope) { return flow.slope(at, state, slope); },
                    static_cast<int>(2 * n));
  const IntegrationOptions options{
      .tolerance = tolerance, .block = static_cast<int>(n), .deadline = deadline};
  for (const double time : times) {
    if (integrator.advance(flight.reached, y, time, options) != Integrated::done) return false;
    if (!flow.velocity(now.first(n), now.subspan(n), time, velocity)) return false;
    flight.q.insert(flight.q.end(), y.begin(), y.begin() + n);
    flight.v.insert(flight.v.end(), velocity.begin(), velocity.end());
  }
  return true;
}

void check_times(std::span<const double> times) {
  if (!std::is_sorted(times.begin(), times.end()) || (!times.empty() && !(times.front() >= 0)))
    throw std::invalid_argument("the times of an integration must ascend from 0");
}

}  // namespace

Flight fly(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
           std::span<const double> times, double tolerance, int copies) {
  const std::size_t n = lagrangian.structure().coordinates / copies;
  if (q.size() != n || v.size() != n)
    throw std::invalid_argument(fmt::format(
        "a state of {} coordinates and {} velocities for a Lagrangian of {}", q.size(), v.size(), n));
  check_times(times);
  Flow flow(lagrangian, copies);
  Flight flight;
  flight.complete = carry(flow, 0, q, v, times, tolerance, {}, flight);
  return flight;
}

Flight follow(const Lagrangian& lagrangian, const Shot& shot, std::span<const double> times, double tolerance,
              const Deadline& deadline, int copies) {
  check_times(times);
  const std::size_t n = lagrangian.structure().coordinates / copies;
  if (!shot.converged() || (!times.empty() && times.back() > shot.duration()))
    throw std::invalid_argument(fmt::format("a motion to {} from one of duration {}",
                                            times.empty() ? 0 : times.back(), shot.duration()));
  Flow flow(lagrangian, copies);
  Flight flight;
  auto next = times.begin();
  for (std::size_t k = 0; k + 1 < shot.times.size(); ++k) {
    const bool last = k + 2 == shot.times.size();
    const auto end = last ? times.end() : std::lower_bound(next, times.end(), shot.times[k + 1]);
    const std::span<const double> q(shot.q.data() + k * n, n), v(shot.v.data() + k * n, n);
    if (!carry(flow, shot.times[k], q, v, {next, end}, tolerance, deadline, flight)) return flight;
    next = end;
  }
  flight.complete = true;
  return flight;
}

}  // namespace extremal
