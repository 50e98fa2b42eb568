#include "action/extended_variation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "action/systems.hpp"

namespace extremal {
namespace {

/// Two bodies on a line, a distance of 1e-5 apart.
std::shared_ptr<const Lagrangian> near_collision() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt((q[0] - q[1]) * (q[0] - q[1]));
  });
}

/// Coordinates a · spread + 0.1 + small oscillations, on four elements.
struct Condensed {
  SchemeTables scheme;
  ElementTables tables;
  Path path;
  DiscreteAction action;
  ExtendedVariation variation;

  Condensed(const Scheme& name, const Lagrangian& lagrangian, double spread, double duration) : scheme(name) {
    tables.bind(scheme, lagrangian);
    const std::vector<double> mesh{0, 0.2, 0.5, 0.7, 1};
    path.reset(tables, mesh, duration);
    const int n = tables.coordinates();
    std::vector<double> q((scheme.degree + 1) * n);
    for (int k = 0; k < path.elements(); ++k) {
      for (int j = 0; j <= scheme.degree; ++j)
        for (int a = 0; a < n; ++a) {
          const double tau = mesh[k] + scheme.lobatto[j] * (mesh[k + 1] - mesh[k]);
          q[j * n + a] = 0.1 + spread * (a + 1 + 0.2 * std::sin(2 * tau + a));
        }
      path.set_element(k, q.data());
    }
    path.load_ends();
    action.reset(lagrangian, tables, path.elements(), false);
    action.evaluate(path);
    variation.evaluate(lagrangian, tables, path, action);
  }
};

TEST(ExtendedVariation, IsThatOfDoublesToRoundoff) {
  for (const auto& lagrangian :
       {systems::kepler(), systems::double_pendulum(), systems::magnetic(), systems::restricted_three_body()})
    for (const Scheme& scheme : {lobatto(1), lobatto(5), lobatto(9), gauss(4)}) {
      ASSERT_TRUE(ExtendedVariation::suits(*lagrangian, SchemeTables(scheme)));
      const Condensed c(scheme, *lagrangian, 1, 0.9);
      const int n = c.tables.coordinates();
      const ExtendedRows& s = c.variation.condensed();
      for (int k = 0; k < c.path.elements(); ++k)
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            const auto at = [&](int row, int column) { return s.at(2 * n * k + row, column).high; };
            const double below = at(n + i, j) - at(n + i, n + j), scale = 10 + std::abs(at(n + i, n + i));
            EXPECT_NEAR(c.action.condensed(k, n + i, j), below, 1e-13 * scale);
            EXPECT_NEAR(at(i, n + j), at(n + j, i), 1e-13 * scale);
            if (j <= i) {
              EXPECT_NEAR(c.action.condensed(k, n + i, n + j), at(n + i, n + j), 1e-13 * scale);
            }
          }
    }
}

/// Both bodies moved alike change nothing: of entries of 1e8 nothing is left but 1e-20.
TEST(ExtendedVariation, HasNoForceOnBodiesMovedAlike) {
  const auto lagrangian = near_collision();
  const Condensed c(lobatto(7), *lagrangian, 1e-5, 1e-8);
  const ExtendedRows& s = c.variation.condensed();
  for (std::size_t row = 0; row < s.rows(); ++row) {
    EXPECT_GT(std::abs(s.at(row, 0).high), row % 4 < 2 ? 1e5 : 1e4) << row;
    const double high = s.at(row, 0).high + s.at(row, 1).high, low = s.at(row, 0).low + s.at(row, 1).low;
    EXPECT_LT(std::abs(high + low), 1e-18) << row;
  }
}

}  // namespace
}  // namespace extremal
