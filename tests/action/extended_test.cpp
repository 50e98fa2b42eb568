#include "action/extended.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "action/discrete_action.hpp"
#include "action/systems.hpp"

namespace extremal {
namespace {

constexpr int elements = 11;

/// Two bodies on a line.
std::shared_ptr<const Lagrangian> two_bodies() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt((q[0] - q[1]) * (q[0] - q[1]));
  });
}

/// A path on elements of a scheme. Ends of elements are multiples of 2^-30, so that they may be shifted
/// exactly.
struct Discretised {
  SchemeTables scheme;
  ElementTables tables;
  Path path;

  Discretised(const Scheme& name, const Lagrangian& lagrangian, double size = 1) : scheme(name) {
    tables.bind(scheme, lagrangian);
    std::vector<double> mesh{0};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.7, 1.3);
    for (int k = 0; k < elements; ++k) mesh.push_back(mesh.back() + uniform(random));
    for (double& tau : mesh) tau /= mesh.back();
    path.reset(tables, mesh, 0.7);
    const int n = tables.coordinates();
    std::vector<double> q((scheme.degree + 1) * n);
    for (int k = 0; k < elements; ++k) {
      for (int j = 0; j <= scheme.degree; ++j)
        for (int a = 0; a < n; ++a) {
          const double tau = mesh[k] + scheme.lobatto[j] * (mesh[k + 1] - mesh[k]);
          const double value = size * (a + 1 + 0.3 * std::sin(3 * tau + a));
          q[j * n + a] = j % scheme.degree == 0 ? std::round(0x1p30 * value) * 0x1p-30 : value;
        }
      path.set_element(k, q.data());
    }
    path.load_ends();
  }
};

std::vector<Scheme> rules() {
  Scheme finer = gauss(4);
  finer.points = 9;  // the middle point is a node
  return {lobatto(1), lobatto(4), lobatto(9), gauss(5), finer};
}

TEST(Extended, IsTheGradientToRoundoff) {
  for (const auto& lagrangian : {systems::kepler(), systems::double_pendulum(), systems::magnetic(),
                                 systems::restricted_three_body(), systems::driven()})
    for (const Scheme& rule : rules()) {
      Discretised d(rule, *lagrangian);
      const int n = d.tables.coordinates(), inner = d.tables.inner();
      ExtendedGradient extended;
      ASSERT_TRUE(extended.evaluate(*lagrangian, d.tables, d.path));
      DiscreteAction action;
      action.reset(*lagrangian, d.tables, elements, true, Condense::nothing);
      action.evaluate_plain(d.path);
      const double scale = action.momentum_scale();
      EXPECT_NEAR(to_double(extended.values().action), action.action(), 1e-12 * scale);
      EXPECT_NEAR(to_double(extended.values().slope_duration), action.slope_duration(), 1e-12 * scale);
      EXPECT_NEAR(extended.values().momentum_scale, scale, 1e-12 * scale);
      for (int a = 0; a < n; ++a) {
        EXPECT_NEAR(to_double(extended.values().nodes[a]), action.start_gradient()[a], 1e-12 * scale);
        EXPECT_NEAR(to_double(extended.values().nodes[elements * n + a]), action.end_gradient()[a],
                    1e-12 * scale);
      }
      action.visit(d.path, false, [&](int batch, const BatchValues& values) {
        for (int k = simd_lanes() * batch; k < std::min(simd_lanes() * (batch + 1), elements); ++k)
          for (int u = 0; u < inner; ++u)
            EXPECT_NEAR(to_double(extended.values().inner[k * inner + u]),
                        values.gradient[u * simd_lanes() + k % simd_lanes()], 1e-11 * scale);
      });
    }
}

TEST(Extended, RefusesOtherRules) {
  const auto lagrangian = systems::kepler();
  Discretised d(scheme("simpson"), *lagrangian);
  EXPECT_FALSE(ExtendedGradient().evaluate(*lagrangian, d.tables, d.path));
}

/// Bodies that are close together far from the origin: the gradient is the same as near to it.
TEST(Extended, FeelsForcesThatAreDifferences) {
  const auto lagrangian = two_bodies();
  Discretised d(lobatto(6), *lagrangian, 0x1p-10);
  Path shifted = d.path;
  for (int k = 0; k <= elements; ++k)
    for (int a = 0; a < 2; ++a) shifted.set_node(k, a, d.path.node(k)[a] + 4);
  shifted.load_ends();
  ExtendedGradient here, there;
  ASSERT_TRUE(here.evaluate(*lagrangian, d.tables, d.path) && there.evaluate(*lagrangian, d.tables, shifted));
  DiscreteAction action;
  action.reset(*lagrangian, d.tables, elements, false, Condense::nothing);
  std::vector<double> plain;
  double plain_change = 0;
  for (const Path* path : {&d.path, &shifted})
    action.visit(*path, false, [&](int batch, const BatchValues& values) {
      for (int u = 0; u < d.tables.inner(); ++u) {
        const double g = values.gradient[u * simd_lanes()],
                     before = path == &d.path ? g : plain[batch * 10 + u];
        if (path == &d.path) plain.push_back(g);
        plain_change = std::max(plain_change, std::abs(g - before));
      }
    });
  double change = 0;
  for (int k = 0; k < elements; k += simd_lanes())
    for (int u = 0; u < d.tables.inner(); ++u)
      change = std::max(change, std::abs(to_double(here.values().inner[k * d.tables.inner() + u] -
                                                   there.values().inner[k * d.tables.inner() + u])));
  EXPECT_GT(plain_change, 1e-13 * action.momentum_scale());
  EXPECT_LT(change, 1e-12 * plain_change);
}

/// What the gradient changes by along a step is the second variation of it, T included.
TEST(Extended, ChangesByTheSecondVariation) {
  for (const auto& lagrangian :
       {systems::kepler(), systems::double_pendulum(), systems::restricted_three_body()})
    for (const Scheme& rule : {lobatto(5), gauss(4)}) {
      Discretised d(rule, *lagrangian);
      const int n = d.tables.coordinates(), inner = d.tables.inner(), m = inner + 2 * n;
      std::mt19937 random(5);
      std::uniform_real_distribution<double> uniform(-1, 1);
      std::vector<double> nodes((elements + 1) * n);
      AlignedDoubles step(static_cast<std::size_t>(d.path.batches()) * m * simd_lanes());
      for (double& x : nodes) x = uniform(random);
      for (double& x : step) x = uniform(random);
      ExtendedGradient extended;
      ASSERT_TRUE(extended.evaluate(*lagrangian, d.tables, d.path));
      extended.evaluate_change(*lagrangian, d.path, {nodes, step, 0});
      DiscreteAction action;
      action.reset(*lagrangian, d.tables, elements, false, Condense::nothing);
      std::vector<double> hessian(m * m), gradient(m), at_nodes(nodes.size());
      double scale = 0;
      for (int k = 0; k < elements; ++k) {
        action.element_hessian(d.path, k, hessian, gradient);
        const auto change = [&](int u) {
          return u < inner ? step[(k / simd_lanes() * m + u) * simd_lanes() + k % simd_lanes()]
                           : nodes[k * n + u - inner];
        };
        for (int i = 0; i < m; ++i) {
          double sum = 0;
          for (int j = 0; j < m; ++j) sum += hessian[std::max(i, j) * m + std::min(i, j)] * change(j);
          scale = std::max(scale, std::abs(sum));
          if (i < inner)
            EXPECT_NEAR(to_double(extended.change().inner[k * inner + i]), sum, 1e-10 * scale);
          else
            at_nodes[k * n + i - inner] += sum;
        }
      }
      for (std::size_t a = 0; a < nodes.size(); ++a)
        EXPECT_NEAR(to_double(extended.change().nodes[a]), at_nodes[a], 1e-10 * scale);
    }
}

TEST(Extended, ChangesWithTheDuration) {
  const auto lagrangian = systems::restricted_three_body();
  Discretised d(lobatto(5), *lagrangian);
  const double by = 1e-5;
  const std::vector<double> nodes((elements + 1) * d.tables.coordinates());
  const AlignedDoubles step(static_cast<std::size_t>(d.path.batches()) * d.tables.unknowns() * simd_lanes());
  ExtendedGradient extended, longer;
  ASSERT_TRUE(extended.evaluate(*lagrangian, d.tables, d.path));
  extended.evaluate_change(*lagrangian, d.path, {nodes, step, by});
  d.path.set_duration(d.path.duration() + by);
  ASSERT_TRUE(longer.evaluate(*lagrangian, d.tables, d.path));
  const double slope = to_double(longer.values().slope_duration - extended.values().slope_duration),
               scale = longer.values().momentum_scale;
  EXPECT_NEAR(to_double(extended.change().slope_duration), slope, 1e3 * by * std::abs(slope));
  for (std::size_t a = 0; a < nodes.size(); ++a)
    EXPECT_NEAR(to_double(extended.change().nodes[a]),
                to_double(longer.values().nodes[a] - extended.values().nodes[a]), 1e3 * by * by * scale);
}

/// Condensed as always, but for digits of momenta at the ends, which stand apart.
TEST(Extended, CondensesTheSame) {
  const auto lagrangian = systems::restricted_three_body();
  Discretised d(lobatto(5), *lagrangian);
  DiscreteAction plain, extended;
  for (auto* action : {&plain, &extended}) action->reset(*lagrangian, d.tables, elements, true);
  extended.extend(true);
  const auto expect_same = [&] {
    const NodeEquations &a = plain.nodes, &b = extended.nodes;
    const std::size_t last = a.gradient.size() - 3;
    const double scale = plain.momentum_scale();
    ASSERT_EQ(b.end_parts.size(), 6u);
    for (std::size_t k = 0; k < a.gradient.size(); ++k) {
      const double part = k < 3 ? b.end_parts[k] : k >= last ? b.end_parts[k - last + 3] : 0;
      EXPECT_NEAR(a.gradient[k], b.gradient[k] + part, 1e-12 * (1 + scale)) << k;
    }
    EXPECT_NEAR(a.border_gradient, b.border_gradient + b.border_part, 1e-12 * (1 + scale));
    EXPECT_NEAR(plain.residual(), extended.residual(), 1e-12 * (1 + scale));
  };
  plain.evaluate(d.path);
  extended.evaluate(d.path);
  expect_same();
  plain.evaluate_gradient(d.path);
  extended.evaluate_gradient(d.path);
  expect_same();
  extended.extend(false);
  extended.evaluate_gradient(d.path);
  EXPECT_TRUE(extended.nodes.end_parts.empty());
  EXPECT_EQ(extended.nodes.gradient, plain.nodes.gradient);
}

}  // namespace
}  // namespace extremal
