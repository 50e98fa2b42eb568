#include "app/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/commands.hpp"
#include "study/phase.hpp"

namespace extremal::app {

std::vector<double> parse_times(const std::string& text) {
  std::vector<double> times;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string cell = text.substr(begin, end - begin);
    double t = 0;
    const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), t);
    if (error != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(t))
      throw OptionError(fmt::format("--at: '{}' is not a time; write T1,T2,…", cell));
    if (t < 0) throw OptionError(fmt::format("--at: {} is before the start; times run from 0", t));
    times.push_back(t);
    begin = end + 1;
  }
  return times;
}

void check_times(const std::vector<double>& times, double duration) {
  for (const double t : times)
    if (t > duration) throw OptionError(fmt::format("--at: {} is beyond the duration {}", t, duration));
}

std::vector<double> equal_times(int count, double duration) {
  std::vector<double> times(count);
  for (int k = 0; k < count; ++k) times[k] = k + 1 == count ? duration : duration * k / (count - 1);
  return times;
}

Samples sample(const Problem& problem, const Trajectory& trajectory, const std::vector<double>& times) {
  const std::size_t n = problem.coordinates();
  const std::vector<Column> columns(n, Column(times.size()));
  Samples samples{times, columns, columns, columns, {}};
  std::vector<double> q(n), v(n), p(n);
  Scratch scratch;
  for (std::size_t k = 0; k < times.size(); ++k) {
    phase_point(problem, trajectory, times[k], q, v, p, scratch);
    for (std::size_t a = 0; a < n; ++a) {
      samples.q[a][k] = q[a];
      samples.v[a][k] = v[a];
      samples.p[a][k] = p[a];
    }
    const std::vector<double> forces = constraint_forces(problem, q, v, times[k]);
    samples.constraint_forces.resize(forces.size(), Column(times.size()));
    for (std::size_t i = 0; i < forces.size(); ++i) samples.constraint_forces[i][k] = forces[i];
  }
  return samples;
}

}  // namespace extremal::app
