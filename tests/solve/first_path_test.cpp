#include "solve/guess/first_path.hpp"

#include <cmath>
#include <numbers>

#include "solve/guess/starting_ends.hpp"
#include "solve/laws.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/mesh.hpp"
#include "solve/newton/ends.hpp"

/// \file Guesses as paths.

namespace extremal::laws {
namespace {

constexpr int elements = 5, degree = 4, modes = 3;
constexpr double size = 0.3;

Problem flight() {
  return fixed_ends(trace(2, [](auto, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2; }), {0.0, 1.0},
                    {1.0, 3.0}, 2.0);
}

/// The guess of a problem on some elements, with the tables that belong to it.
struct Guess {
  Levels levels;
  Path path;

  explicit Guess(const Problem& problem) {
    levels.bind(problem.lagrangian);
    path.reset(tables(), uniform_mesh(elements), problem.duration.value);
    start_path(problem, starting_ends(problem), tables(), path);
  }
  const ElementTables& tables() { return levels.at(degree); }
  Values element(int k) const {
    Values q(2 * (degree + 1));
    path.element(k, q.data());
    return q;
  }
};

TEST(FirstPath, AddsToAllNodesWhatIsAdded) {
  Guess guess(flight());
  Path& path = guess.path;
  std::vector<Values> before;
  for (int k = 0; k < elements; ++k) before.push_back(guess.element(k));
  const auto added = [](double tau, int a) { return (a + 1) * std::sin(std::numbers::pi * tau); };
  fill_path(ends_of(path), guess.tables(), path, [&](double tau, double* q) {
    for (int a = 0; a < 2; ++a) q[a] += added(tau, a);
  });
  for (int k = 0; k < elements; ++k) {
    const Values after = guess.element(k);
    for (int j = 0; j <= degree; ++j) {
      const double tau = (k + guess.tables().scheme().lobatto[j]) / elements;
      for (int a = 0; a < 2; ++a)
        EXPECT_NEAR(after[2 * j + a], before[k][2 * j + a] + added(tau, a), 1e-14) << k << ", " << j;
    }
  }
}

TEST(FirstPath, NoiseIsASumOfWavesAtEveryNode) {
  const Problem problem = flight();
  const Guess straight(problem);
  Guess bent(problem);
  constexpr Bend bend{.size = size, .seed = 4, .modes = modes};
  const std::vector<double> extent = extents(bent.path, negligible_extent[bend.seed % 2]);
  bend_path(problem, bend, bent.tables(), bent.path);
  Noise noise(bend.seed);
  double amplitude[modes][2];
  for (auto& row : amplitude)
    for (double& x : row) x = noise();
  for (int k = 0; k < elements; ++k) {
    const Values line = straight.element(k), path = bent.element(k);
    for (int j = 0; j <= degree; ++j) {
      const double tau = (k + bent.tables().scheme().lobatto[j]) / elements;
      for (int a = 0; a < 2; ++a) {
        double wave = 0;
        for (int m = 1; m <= modes; ++m)
          wave += size * extent[a] / m * amplitude[m - 1][a] * std::sin(m * std::numbers::pi * tau);
        EXPECT_NEAR(path[2 * j + a], line[2 * j + a] + wave, 1e-14) << k << ", " << j << ", " << a;
      }
    }
  }
}

}  // namespace
}  // namespace extremal::laws
