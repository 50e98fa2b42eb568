#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "analysis/motion_spectrum.hpp"
#include "common.hpp"
#include "system/tape.hpp"

namespace extremal::papers {

namespace {

using std::numbers::pi;

struct MarchedScheme {
  std::string name;
  std::function<double(double z)> angle;  ///< θ = ω_h h of z = ω₀ h
};

const std::vector<MarchedScheme>& marched_schemes() {
  static const std::vector<MarchedScheme> all = {
      {"trapezoid", [](double z) { return std::acos(1 - z * z / 2); }},
      {"midpoint", [](double z) { return 2 * std::atan(z / 2); }},
      {"linear", [](double z) { return std::acos((1 - z * z / 3) / (1 + z * z / 6)); }},
      // Diagonal Padé approximants of e^{iz}.
      {"gauss(2)", [](double z) { return 2 * std::atan(z / 2 / (1 - z * z / 12)); }},
      {"gauss(3)", [](double z) { return 2 * std::atan2(z / 2 - z * z * z / 120, 1 - z * z / 10); }}};
  return all;
}

/// Of the oscillator from its initial data, by the line of the nodes.
double measured_angle(const std::string& name, double z) {
  const int elements = 20000;
  const Problem problem =
      initial_problem(trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2; }),
                      {{0.7}, {0.2}}, z * elements);
  const Solution solution = solved(problem, name, elements);
  return z * motion_spectrum(problem, solution.trajectory, Sampling::nodes, 1, 1e-9)
                 .coordinates[0]
                 .lines.at(0)
                 .frequency;
}

/// Largest error of q at the ends of elements up to times that grow.
Series growth(const std::string& name, const Problem& problem, const Solution& solution,
              const Trajectory& exact) {
  Series series{.name = name, .x = {}, .measured = {}, .formula = {}};
  const Trajectory& path = solution.trajectory;
  const std::size_t n = problem.coordinates();
  std::vector<double> q(n), r(n), v(n);
  double worst = 0, next = 10;
  for (int k = 1; k <= path.elements(); ++k) {
    path.at(path.times[k], q, v);
    exact.at(path.times[k], r, v);
    for (std::size_t a = 0; a < n; ++a) worst = std::max(worst, std::abs(q[a] - r[a]));
    if (path.times[k] < next && k < path.elements()) continue;
    series.x.push_back(path.times[k]);
    series.measured.push_back(worst);
    next *= 2;
  }
  return series;
}

}  // namespace

Figure wave_trains() {
  std::vector<Series> angles, errors;
  std::vector<std::string> names;
  const Problem problem =
      initial_problem(trace(2,
                            [](auto q, auto v, auto) {
                              return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - q[1] * q[1]) / 2 -
                                     q[0] * q[0] * q[1] + q[1] * q[1] * q[1] / 3;
                            }),
                      {{0, 0.1}, {0.35, 0.1}}, 20480);
  Solver solver;
  const Solution exact = solver.solve(problem, {.tolerance = 1e-10});
  for (const MarchedScheme& scheme : marched_schemes()) {
    names.push_back(scheme.name);
    Series angle{.name = scheme.name, .x = {}, .measured = {}, .formula = {}};
    for (const double z : {0.2, 0.3, 0.45, 0.7, 1.0, 1.4, 1.9}) {
      angle.x.push_back(z);
      angle.measured.push_back(std::abs(measured_angle(scheme.name, z) / z - 1));
      angle.formula.push_back(std::abs(scheme.angle(z) / z - 1));
    }
    angles.push_back(std::move(angle));
    errors.push_back(growth(scheme.name, problem, solved(problem, scheme.name, 81920), exact.trajectory));
  }
  Figure figure = side_by_side(
      "Marched from initial data: discrete frequencies with their formulas; errors over 3000 periods", names);
  figure.panels.push_back(decades("h ω₀", "|ω_h/ω₀ − 1|", angles, left_box));
  figure.panels.push_back(decades("t, Hénon-Heiles, h = 0.25", "largest error of q", errors, right_box));
  return figure;
}

}  // namespace extremal::papers
