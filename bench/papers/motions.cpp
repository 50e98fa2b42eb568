#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "analysis/bounds.hpp"
#include "common.hpp"
#include "report/layout.hpp"
#include "system/tape.hpp"

namespace extremal::papers {

namespace {

using std::numbers::pi;

std::shared_ptr<const Lagrangian> pendulum() {
  return trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); });
}

/// sup |q − q_exact| and sup |q' − q'_exact| over points inside the elements.
std::pair<double, double> errors(const Trajectory& trajectory, const Trajectory& exact) {
  double position = 0, velocity = 0;
  double q[1], v[1], other[1], other_v[1];
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int j = 0; j <= 8; ++j) {
      const double tau = (j == 0 ? 1e-9 : j == 8 ? 1 - 1e-9 : j / 8.0);
      const double t = trajectory.times[k] + tau * trajectory.length(k);
      trajectory.in_element(k, tau, q, v);
      exact.at(t, other, other_v);
      position = std::max(position, std::abs(q[0] - other[0]));
      velocity = std::max(velocity, std::abs(v[0] - other_v[0]));
    }
  return {position, velocity};
}

Axis linear_axis(const std::string& label, double low, double high) {
  return make_axis({label}, low, high, 7);
}

}  // namespace

Figure convergence_of_velocities() {
  const double duration = 20;
  const Problem problem = on_motion(
      pendulum(), [](double t) { return std::vector<double>{1.4 * std::cos(0.8667 * t)}; }, duration);
  SolveOptions tight;
  tight.tolerance = 1e-13;
  const Trajectory exact = Solver().solve(problem, tight).trajectory;
  std::vector<Series> position, velocity;
  std::vector<std::string> names;
  for (const char* name : {"midpoint", "trapezoid", "linear", "quadratic", "lobatto(3)"}) {
    Series q{.name = name, .x = {}, .measured = {}, .formula = {}}, v = q;
    for (int elements = 64; elements <= 1024; elements *= 2) {
      const auto [dq, dv] = errors(solved(problem, name, elements).trajectory, exact);
      q.x.push_back(duration / elements);
      q.measured.push_back(dq);
      v.x.push_back(duration / elements);
      v.measured.push_back(dv);
    }
    names.push_back(fmt::format("{}: {:.2f}, {:.2f}", name, slope(q), slope(v)));
    position.push_back(std::move(q));
    velocity.push_back(std::move(v));
  }
  Figure figure =
      side_by_side("Swing of a pendulum: convergence in W^{1,∞}, Theorem 4.7, with slopes", names);
  figure.panels.push_back(decades("h", "sup |q_h − q|", position, left_box));
  figure.panels.push_back(decades("h", "sup |q_h' − q'|", velocity, right_box));
  return figure;
}

Figure windows() {
  const int elements = 12;
  Panel index{.box = left_box, .x = linear_axis("ω₀T/π", 0.5, 3.3), .y = linear_axis("Morse index", -0.2, 4)};
  Panel size{
      .box = right_box, .x = linear_axis("ω₀T/π", 0.9, 1.12), .y = linear_axis("log10 max |q_h|", 0, 6)};
  const std::vector<std::string> names = {"midpoint", "trapezoid", "linear"};
  std::vector<std::string> legend;
  const std::vector<Colour> colours = distinct_colours(names.size());
  const auto oscillator = trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2; });
  const auto solve = [&](const std::string& name, double duration) {
    Problem problem;
    problem.lagrangian = oscillator;
    problem.names = {"q"};
    problem.boundary.coordinates = 1;
    problem.boundary.fix(0, false, 1);
    problem.boundary.fix(0, true, 0.2);
    problem.duration.value = duration;
    SolveOptions options;
    options.scheme = scheme(name);
    options.elements = elements;
    return Solver().solve(make_problem(problem), options);
  };
  for (std::size_t s = 0; s < names.size(); ++s) {
    const double bound = window_bound(scheme(names[s]), elements);
    Curve steps{{}, {}, colours[s], 1.4}, growth = steps;
    for (double x = 0.5; x <= 3.3; x += 0.004) {
      const Solution solution = solve(names[s], x * pi);
      if (!solution.converged() || !solution.morse_index) continue;
      steps.x.push_back(x);
      steps.y.push_back(*solution.morse_index + 0.06 * (static_cast<double>(s) - 1));
    }
    for (double x = 0.9; x <= 1.12; x += 0.0005) {
      const Solution solution = solve(names[s], x * pi);
      if (!solution.converged()) continue;
      double most = 0;
      for (const double q : solution.trajectory.nodes) most = std::max(most, std::abs(q));
      growth.x.push_back(x);
      growth.y.push_back(std::log10(most));
    }
    index.curves.push_back(steps);
    size.curves.push_back(growth);
    index.marks.push_back({bound / pi, 0.5, colours[s], Shape::ring});
    size.curves.push_back({{bound / pi, bound / pi}, {0, 6}, colours[s], 0.6});
    legend.push_back(fmt::format("{}: bound {:.4f} π", names[s], bound / pi));
  }
  index.curves.push_back({{2 / pi, 2 / pi}, {-0.2, 4}, 0x888888, 1});
  index.notes.push_back({2 / pi + 0.4, 3.8, "2/ω₀, Lemma 5.3"});
  Figure figure = side_by_side(
      fmt::format("Oscillator with fixed ends, {} elements: conjugate points", elements), legend);
  figure.panels = {std::move(index), std::move(size)};
  return figure;
}

}  // namespace extremal::papers
