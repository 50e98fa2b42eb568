#include "solve/accept/symmetries.hpp"

#include "problem/symmetry.hpp"
#include "solve/accept/limits.hpp"

namespace extremal {

std::vector<Generator> symmetries_about(const Problem& problem, const Trajectory& found) {
  constexpr int points = limits::quadrature_check::guess_points;
  const std::size_t n = problem.coordinates();
  Problem about = problem;
  about.guess = {};
  about.guess.q.resize((points + 1) * n);
  std::vector<double> v(n);
  for (int i = 0; i <= points; ++i) {
    about.guess.tau.push_back(static_cast<double>(i) / points);
    found.at(about.guess.tau.back() * found.duration(), {about.guess.q.data() + i * n, n}, v);
  }
  const SymmetrySearch search{limits::quadrature_check::most_coordinates,
                              {1, 0.25, 0.0625, 1 / 64.0, 1 / 256.0, 1 / 1024.0, 1 / 4096.0}};
  return continuous_symmetries(about, search);
}

}  // namespace extremal
