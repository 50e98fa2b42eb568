#include "analysis/motion_spectrum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "problem/closing.hpp"

namespace extremal {

namespace {

/// So many times a map is applied at most before it is taken to have no finite order; then lines are as far
/// apart as that many periods make them.
constexpr int most_copies = 64;
/// Samples a degree of freedom of an element: its polynomial of degree s has frequencies of about s/h at
/// most.
constexpr int samples_a_degree = 2, least_samples = 512;
/// A mean velocity is one if without it the range is less than this part.
constexpr double most_beside_drift = 0.5;

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

double range_of(const std::vector<double>& column) {
  const auto [least, most] = std::minmax_element(column.begin(), column.end());
  return *most - *least;
}

double largest_range(std::span<const std::vector<double>> columns) {
  double range = 0;
  for (const std::vector<double>& column : columns) range = std::max(range, range_of(column));
  return range;
}

void take_away(double velocity, double step, std::vector<double>& column) {
  for (std::size_t j = 0; j < column.size(); ++j) column[j] -= velocity * step * static_cast<double>(j);
}

/// By weights exp(−1/(u (1 − u))), which vanish at both ends with all derivatives: those of lines average out
/// faster than any power of their number of periods (Das, Sander, Saiki, Yorke, Nonlinearity 30 (2017) 4111).
double mean_velocity(const std::vector<double>& column, double step) {
  double sum = 0, weights = 0;
  const std::size_t last = column.size() - 1;
  for (std::size_t j = 0; j < last; ++j) {
    const double u = (static_cast<double>(j) + 0.5) / static_cast<double>(last),
                 weight = std::exp(-1 / (u * (1 - u)));
    sum += weight * (column[j + 1] - column[j]);
    weights += weight;
  }
  return sum / (weights * step);
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
  const auto goal = [&] {
    return SpectrumGoal{lines, tolerance * largest_range(std::span(columns).first(shown))};
  };
  const double step = trajectory.duration() / static_cast<double>(columns.front().size() - 1);
  MotionSpectrum result{{}, std::vector<double>(shown, 0.0)};
  if (!problem.periodic) {
    for (std::size_t a = 0; a < shown; ++a) {
      const double drift = mean_velocity(columns[a], step);
      std::vector<double> left = columns[a];
      take_away(drift, step, left);
      if (range_of(left) < most_beside_drift * range_of(columns[a])) {
        result.drift[a] = drift;
        columns[a] = std::move(left);
      }
    }
    for (std::size_t a = 0; a < shown; ++a)
      result.coordinates.push_back(line_spectrum(columns[a], step, goal()));
    return result;
  }
  const SpectrumGoal wanted = goal();
  const ClosingMap map = closing_map(problem);
  const std::optional<Return> back = first_return(map);
  columns = continued(columns, map, back ? back->copies : most_copies);
  for (std::size_t a = 0; a < shown; ++a) {
    std::vector<double>& column = columns[a];
    if (!back) {
      result.coordinates.push_back(line_spectrum(column, step, wanted));
      continue;
    }
    const double period = step * static_cast<double>(column.size());
    result.drift[a] = back->shift[static_cast<Eigen::Index>(a)] / period;
    take_away(result.drift[a], step, column);
    result.coordinates.push_back(fourier_spectrum(column, period, wanted));
  }
  return result;
}

}  // namespace extremal
