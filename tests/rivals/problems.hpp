#pragma once

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "action/rule.hpp"
#include "problem/problem.hpp"
#include "rivals/shooting.hpp"
#include "solution/solution.hpp"
#include "system/tape.hpp"

/// \file Systems, problems and trajectories for the rivals.

namespace extremal {

inline std::shared_ptr<const Lagrangian> kepler() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2.0 + 1.0 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
}

inline std::shared_ptr<const Lagrangian> pendulum() {
  return trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + cos(q[0]); });
}

inline std::shared_ptr<const Lagrangian> double_pendulum() {
  return trace(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[1] * v[1] / 2.0 + v[0] * v[1] * cos(q[0] - q[1]) + 2 * 9.81 * cos(q[0]) +
           9.81 * cos(q[1]);
  });
}

inline std::shared_ptr<const Lagrangian> henon_heiles() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - q[1] * q[1]) / 2.0 - q[0] * q[0] * q[1] +
           q[1] * q[1] * q[1] / 3.0;
  });
}

inline std::shared_ptr<const Lagrangian> oscillator() {
  return trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2.0; });
}

inline Problem fixed_ends(std::shared_ptr<const Lagrangian> lagrangian, std::vector<double> start,
                          std::vector<double> end, double duration) {
  Problem problem;
  problem.lagrangian = std::move(lagrangian);
  problem.boundary.coordinates = static_cast<int>(start.size());
  for (int a = 0; a < problem.boundary.coordinates; ++a) {
    problem.boundary.fix(a, false, start[a]);
    problem.boundary.fix(a, true, end[a]);
  }
  problem.duration.value = duration;
  return make_problem(std::move(problem));
}

/// Rows t, coordinates, velocities of a reference solution.
inline std::vector<std::vector<double>> reference(const std::string& name) {
  std::ifstream file(std::string(EXTREMAL_SOURCE_DIR) + "/bench/data/" + name + ".csv");
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(file, line)) {
    rows.emplace_back();
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      rows.back().push_back(std::stod(line.substr(begin, end - begin)));
      begin = end + 1;
    }
  }
  return rows;
}

/// Elements of degree 12 that carry f(t), n entries, at their nodes.
template <class Function>
Trajectory sampled(int n, int elements, double duration, Function f) {
  Trajectory trajectory{n, 12, {}, {}};
  for (int k = 0; k <= elements; ++k) trajectory.times.push_back(duration * k / elements);
  for (int k = 0; k < elements; ++k)
    for (const double node : lobatto_rule(13).nodes) {
      const double start = trajectory.times[k];
      const std::vector<double> q =
          f(node == 1 ? trajectory.times[k + 1] : start + (trajectory.times[k + 1] - start) * node);
      trajectory.nodes.insert(trajectory.nodes.end(), q.begin(), q.end());
    }
  return trajectory;
}

/// The motion between the rows of a reference solution, each element from the state in its row.
inline Trajectory reference_trajectory(const Lagrangian& lagrangian, const std::string& name) {
  const auto rows = reference(name);
  const int n = lagrangian.structure().coordinates;
  Trajectory trajectory{n, 12, {}, {}};
  for (const auto& row : rows) trajectory.times.push_back(row[0]);
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    const std::vector<double> q(rows[k].begin() + 1, rows[k].begin() + 1 + n);
    const std::vector<double> v(rows[k].begin() + 1 + n, rows[k].begin() + 1 + 2 * n);
    std::vector<double> times;
    for (const double node : lobatto_rule(13).nodes) times.push_back(node * (rows[k + 1][0] - rows[k][0]));
    const Flight flight = fly(lagrangian, q, v, times, 1e-15);
    trajectory.nodes.insert(trajectory.nodes.end(), flight.q.begin(), flight.q.end() - n);
    trajectory.nodes.insert(trajectory.nodes.end(), rows[k + 1].begin() + 1, rows[k + 1].begin() + 1 + n);
  }
  return trajectory;
}

}  // namespace extremal
