#include "problem/own_symmetries.hpp"

#include <cmath>

#include "problem/copies.hpp"
#include "problem/extension.hpp"
#include "problem/phase_space.hpp"

namespace extremal {

namespace {

/// Those that leave both equilibria where they are.
std::vector<Generator> symmetries_about_rest(const Problem& problem, const SymmetrySearch& search) {
  std::vector<Generator> found = continuous_symmetries(problem, search);
  const std::size_t n = problem.coordinates();
  std::erase_if(found, [&](const Generator& generator) {
    constexpr double roundoff = 1e-9;
    for (const std::vector<double>* q : {&problem.infinite->start, &problem.infinite->end})
      for (std::size_t a = 0; a < n; ++a) {
        double moved = generator.shift[a], size = std::abs(moved);
        for (std::size_t b = 0; b < n; ++b) {
          moved += generator.matrix[a * n + b] * (*q)[b];
          size += std::abs(generator.matrix[a * n + b] * (*q)[b]);
        }
        if (std::abs(moved) > roundoff * std::max(size, 1.0)) return true;
      }
    return false;
  });
  return found;
}

/// Those that leave what waypoints fix as it is, wherever their other coordinates are.
std::vector<Generator> keeping_waypoints(const Extension& extension, const std::vector<Generator>& found) {
  if (found.empty() || extension.waypoints.empty()) return found;
  const auto n = static_cast<int>(found.front().shift.size()), count = static_cast<int>(found.size());
  std::vector<Eigen::RowVectorXd> rows;
  for (const WaypointCondition& waypoint : extension.waypoints)
    for (const auto& [a, value] : waypoint.fixed) {
      const auto by = [&, a = a](int s, int b) {
        return found[s].matrix[static_cast<std::size_t>(a) * n + b];
      };
      std::vector<char> free(n, 1);
      Eigen::RowVectorXd moved(count);
      for (int s = 0; s < count; ++s) moved[s] = found[s].shift[a];
      for (const auto& [b, x] : waypoint.fixed) {
        free[b] = 0;
        for (int s = 0; s < count; ++s) moved[s] += by(s, b) * x;
      }
      rows.push_back(moved);
      for (int b = 0; b < n; ++b) {
        if (!free[b]) continue;
        for (int s = 0; s < count; ++s) moved[s] = by(s, b);
        rows.push_back(moved);
      }
    }
  Eigen::MatrixXd values(std::ssize(rows), count);
  for (Eigen::Index r = 0; r < values.rows(); ++r) values.row(r) = rows[r];
  return symmetries_that_keep(values, found);
}

}  // namespace

std::vector<Generator> own_symmetries(const Problem& problem, const SymmetrySearch& search) {
  std::vector<Generator> found;
  if (problem.periodic)
    found = problem.phase ? phase_symmetries(problem, search) : continuous_symmetries(problem, search);
  else if (problem.infinite && problem.infinite->both())
    found = symmetries_about_rest(problem, search);
  if (problem.extension) found = keeping_waypoints(*problem.extension, found);
  return problem.paired ? symmetries_of_copies(found) : found;
}

}  // namespace extremal
