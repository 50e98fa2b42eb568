#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common.hpp"
#include "report/layout.hpp"
#include "system/tape.hpp"

namespace extremal::papers {

namespace {

/// A motion from its initial data, and its energy.
struct Motion {
  std::shared_ptr<const Lagrangian> lagrangian;
  std::vector<double> q, p;
  double duration, energy;
  std::size_t schemes;  ///< of those in the legend
};

/// Half a revolution of eccentricity 0.9 less its last part, from the apoapsis.
Motion kepler() {
  const double e = 0.9, far = 1 + e, speed = std::sqrt((1 - e) / (1 + e));
  return {
      trace(2, [](auto q, auto v,
                  auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]); }),
      {-far, 0},
      {0, -speed},
      3.0,
      -0.5,
      2};
}

/// From the lowest point to near the upper one, which it passes slowly. With the other schemes no node times
/// give all elements of this way the same energy.
Motion pendulum_motion() {
  const double energy = 1 + 1e-4;
  return {trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); }),
          {0},
          {std::sqrt(2 * (energy + 1))},
          5,
          energy,
          1};
}

Solution between_ends(const Motion& motion, const std::string& name, bool free, int elements) {
  const Solution exact = Solver().solve(
      initial_problem(motion.lagrangian, {motion.q, motion.p}, motion.duration), {.tolerance = 1e-12});
  if (!exact.converged()) throw std::runtime_error(exact.message);
  const State state = [&](double t) {
    std::vector<double> q(motion.q.size()), v(q.size());
    exact.trajectory.at(std::min(t, motion.duration), q, v);
    return q;
  };
  SolveOptions options;
  options.scheme = scheme(name);
  options.elements = elements;
  options.free_steps = free;
  Solution found = Solver().solve(on_motion(motion.lagrangian, state, motion.duration), options);
  if (!found.converged())
    throw std::runtime_error(fmt::format("{}, {} elements: {}", name, elements, found.message));
  return found;
}

/// The difference of the energies of elements from that of the motion, each in the middle of its element.
Curve energy_error(const Motion& motion, const Solution& solution, Colour colour, double width) {
  Curve curve{{}, {}, colour, width};
  const std::vector<double>& times = solution.trajectory.times;
  for (std::size_t k = 0; k < solution.element_energies.size(); ++k) {
    curve.x.push_back((times[k] + times[k + 1]) / 2);
    curve.y.push_back(std::log10(std::max(std::abs(solution.element_energies[k] - motion.energy), 1e-16)));
  }
  return curve;
}

}  // namespace

Figure free_times() {
  const int elements = 200;
  std::vector<std::string> names;
  for (const char* name : {"trapezoid", "gauss(2)"})
    for (const char* steps : {"equal steps", "free steps"})
      names.push_back(fmt::format("{}, {}", name, steps));
  Figure figure = side_by_side(
      fmt::format("Times as unknowns, {} elements: the energy error over time", elements), names);
  const std::vector<Colour> colours = distinct_colours(names.size());
  for (const auto& [motion, title, box] :
       {std::tuple{kepler(), "t, Kepler, e = 0.9, to near the periapsis", left_box},
        {pendulum_motion(), "t, pendulum near its separatrix", right_box}}) {
    Panel panel;
    panel.box = box;
    panel.x = make_axis({title}, 0, motion.duration, 7);
    double low = 0, high = -16;
    for (std::size_t k = 0; k < 2 * motion.schemes; ++k) {
      const Solution found = between_ends(motion, k < 2 ? "trapezoid" : "gauss(2)", k % 2 == 1, elements);
      panel.curves.push_back(energy_error(motion, found, colours[k], k % 2 == 1 ? 2.2 : 1.2));
      const auto [least, most] = std::ranges::minmax(panel.curves.back().y);
      low = std::min(low, least);
      high = std::max(high, most);
    }
    panel.y = make_axis({"log10 |E_h − E| of elements"}, std::floor(low), std::ceil(high), 8);
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace extremal::papers
