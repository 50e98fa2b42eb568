#include "common.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "report/layout.hpp"

namespace extremal::papers {

Problem on_motion(std::shared_ptr<const Lagrangian> lagrangian, const State& motion, double duration) {
  Problem problem;
  const std::vector<double> start = motion(0), end = motion(duration);
  problem.lagrangian = std::move(lagrangian);
  problem.boundary.coordinates = static_cast<int>(start.size());
  for (std::size_t a = 0; a < start.size(); ++a) {
    problem.names.push_back(fmt::format("q[{}]", a + 1));
    problem.boundary.fix(static_cast<int>(a), false, start[a]);
    problem.boundary.fix(static_cast<int>(a), true, end[a]);
  }
  problem.duration.value = duration;
  const int steps = std::max(200, static_cast<int>(40 * duration));
  for (int k = 0; k <= steps; ++k) {
    problem.guess.tau.push_back(static_cast<double>(k) / steps);
    for (const double q : motion(duration * k / steps)) problem.guess.q.push_back(q);
  }
  return make_problem(std::move(problem));
}

Solution solved(const Problem& problem, const std::string& name_of_scheme, int elements) {
  SolveOptions options;
  options.scheme = scheme(name_of_scheme);
  options.elements = elements;
  Solution solution = Solver().solve(problem, options);
  if (!solution.converged())
    throw std::runtime_error(fmt::format("{}, {} elements: {}", name_of_scheme, elements, solution.message));
  return solution;
}

namespace {

Axis axis_of(const std::string& label, double low, double high) {
  Axis axis{.label = label, .low = std::floor(low), .high = std::ceil(high), .ticks = {}};
  if (axis.high <= axis.low) axis.high = axis.low + 1;
  const int first = static_cast<int>(axis.low), last = static_cast<int>(axis.high),
            step = (last - first + 7) / 8;
  for (int k = first; k <= last; k += step) axis.ticks.push_back({double(k), fmt::format("1e{}", k)});
  return axis;
}

std::vector<double> logs(const std::vector<double>& values) {
  std::vector<double> result;
  for (const double value : values) result.push_back(std::log10(std::max(value, 1e-16)));
  return result;
}

}  // namespace

Figure side_by_side(const std::string& title, const std::vector<std::string>& names) {
  Figure figure{.width = 980, .height = 490, .title = title};
  const std::vector<Colour> colours = distinct_colours(names.size());
  for (std::size_t k = 0; k < names.size(); ++k) figure.legend.push_back({names[k], colours[k], Shape::line});
  return figure;
}

Panel decades(const std::string& x, const std::string& y, const std::vector<Series>& series, Box box) {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY;
  for (const Series& s : series)
    for (const auto& [values, from, to] : {std::tuple{&s.x, &left, &right}, {&s.measured, &low, &high}})
      for (const double value : logs(*values)) {
        *from = std::min(*from, value);
        *to = std::max(*to, value);
      }
  Panel panel;
  panel.box = box;
  panel.x = axis_of(x, left, right);
  panel.y = axis_of(y, low, high);
  const std::vector<Colour> colours = distinct_colours(series.size());
  for (std::size_t k = 0; k < series.size(); ++k) {
    const Series& s = series[k];
    const std::vector<double> at = logs(s.x), measured = logs(s.measured);
    panel.curves.push_back({at, s.formula.empty() ? measured : logs(s.formula), colours[k], 1.2});
    for (std::size_t i = 0; i < at.size(); ++i)
      panel.marks.push_back({at[i], measured[i], colours[k], Shape::disc});
  }
  return panel;
}

double slope(const Series& series) {
  const std::vector<double> x = logs(series.x), y = logs(series.measured);
  const double n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    sx += x[k];
    sy += y[k];
    sxx += x[k] * x[k];
    sxy += x[k] * y[k];
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace extremal::papers
