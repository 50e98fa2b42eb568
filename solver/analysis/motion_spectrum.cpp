#include "analysis/motion_spectrum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <span>

#include "problem/closing.hpp"

namespace extremal {

namespace {

/// So many times a map is applied at most before it is taken to have no finite order; then lines are as far
/// apart as that many periods make them.
constexpr int most_copies = 64;
/// Samples a degree of freedom of an element: its polynomial of degree s has frequencies of about s/h at
/// most.
constexpr int samples_a_degree = 2, least_samples = 512;

/// Column by column, the end included.
std::vector<std::vector<double>> samples_of(const Trajectory& trajectory, Sampling sampling) {
  const int n = trajectory.coordinates;
  std::vector<std::vector<double>> columns(n);
  std::vector<double> q(n), v(n);
  const int count = sampling == Sampling::nodes
                        ? trajectory.elements()
                        : static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(
                              least_samples, samples_a_degree * trajectory.elements() * trajectory.degree))));
  for (int j = 0; j <= count; ++j) {
    const double t = sampling == Sampling::nodes ? trajectory.times[j] : trajectory.duration() * j / count;
    trajectory.at(t, q, v);
    for (int a = 0; a < n; ++a) columns[a].push_back(q[a]);
  }
  return columns;
}

double largest_range(std::span<const std::vector<double>> columns) {
  double range = 0;
  for (const std::vector<double>& column : columns) {
    const auto [least, most] = std::minmax_element(column.begin(), column.end());
    range = std::max(range, *most - *least);
  }
  return range;
}

/// q(kT) = R^k q(0) + shift with R^k = 1; nothing where no k up to most_copies has that.
struct Return {
  int copies;
  Eigen::VectorXd shift;
};
std::optional<Return> first_return(const ClosingMap& map) {
  constexpr double roundoff = 1e-12;
  Eigen::MatrixXd power = map.r;
  Eigen::VectorXd shift = map.c;
  for (int k = 1; k <= most_copies; ++k) {
    if (power.isIdentity(roundoff)) return Return{k, shift};
    power = map.r * power;
    shift = map.r * shift + map.c;
  }
  return std::nullopt;
}

/// Each copy is the map of the one before; the end of the last is left out.
std::vector<std::vector<double>> continued(const std::vector<std::vector<double>>& columns,
                                           const ClosingMap& map, int copies) {
  const std::size_t n = columns.size(), count = columns.front().size() - 1;
  std::vector<std::vector<double>> result(n);
  for (std::size_t a = 0; a < n; ++a) result[a].assign(columns[a].begin(), columns[a].end() - 1);
  Eigen::VectorXd q(n);
  for (std::size_t j = 0; j < (copies - 1) * count; ++j) {
    for (std::size_t a = 0; a < n; ++a) q[a] = result[a][j];
    const Eigen::VectorXd next = map.r * q + map.c;
    for (std::size_t a = 0; a < n; ++a) result[a].push_back(next[a]);
  }
  return result;
}

}  // namespace

MotionSpectrum motion_spectrum(const Problem& problem, const Trajectory& trajectory, Sampling sampling,
                               int lines, double tolerance) {
  std::vector<std::vector<double>> columns = samples_of(trajectory, sampling);
  // In phase space momenta follow.
  const auto shown = static_cast<std::size_t>(problem.degrees_of_freedom());
  const SpectrumGoal goal{lines, tolerance * largest_range(std::span(columns).first(shown))};
  const double step = trajectory.duration() / static_cast<double>(columns.front().size() - 1);
  MotionSpectrum result{{}, std::vector<double>(shown, 0.0)};
  if (!problem.periodic) {
    for (std::size_t a = 0; a < shown; ++a)
      result.coordinates.push_back(line_spectrum(columns[a], step, goal));
    return result;
  }
  const ClosingMap map = closing_map(problem);
  const std::optional<Return> back = first_return(map);
  columns = continued(columns, map, back ? back->copies : most_copies);
  for (std::size_t a = 0; a < shown; ++a) {
    std::vector<double>& column = columns[a];
    if (!back) {
      result.coordinates.push_back(line_spectrum(column, step, goal));
      continue;
    }
    const double period = step * static_cast<double>(column.size());
    result.drift[a] = back->shift[static_cast<Eigen::Index>(a)] / period;
    for (std::size_t j = 0; j < column.size(); ++j)
      column[j] -= result.drift[a] * step * static_cast<double>(j);
    result.coordinates.push_back(fourier_spectrum(column, period, goal));
  }
  return result;
}

}  // namespace extremal
