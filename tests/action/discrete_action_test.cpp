#include "action/discrete_action.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <random>

#include "action/systems.hpp"
#include "system/formula.hpp"

namespace extremal {
namespace {

struct Case {
  const char* name;
  std::shared_ptr<const Lagrangian> lagrangian;
};

std::vector<Case> cases() {
  return {{"kepler", systems::kepler()},
          {"double pendulum", systems::double_pendulum()},
          {"restricted three-body", systems::restricted_three_body()},
          {"magnetic", systems::magnetic()},
          {"driven", systems::driven()}};
}

std::vector<Scheme> all_schemes() {
  std::vector<Scheme> list = schemes();
  for (int s : {1, 2, 5, 8}) list.push_back(lobatto(s));
  for (int s : {1, 2, 5}) list.push_back(gauss(s));
  return list;
}

/// A path on a non-uniform mesh of `elements`, away from singularities, with random inner values.
class Discretisation {
 public:
  Discretisation(std::shared_ptr<const Lagrangian> lagrangian, const Scheme& scheme, int elements,
                 bool border = false)
      : lagrangian_(std::move(lagrangian)), tables_scheme_(scheme, scheme.points) {
    tables.bind(tables_scheme_, *lagrangian_);
    action.reset(*lagrangian_, tables, elements, border);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> noise(-0.05, 0.05);
    std::vector<double> mesh{0};
    for (int k = 0; k < elements; ++k) mesh.push_back(mesh.back() + 1 + 10 * noise(random));
    for (double& tau : mesh) tau /= mesh.back();
    path.reset(tables, mesh, 1.7);
    const int n = tables.coordinates(), s = scheme.degree;
    std::vector<double> q((s + 1) * n), last(n);
    for (int k = 0; k < elements; ++k) {
      for (int j = 0; j <= s; ++j)
        for (int a = 0; a < n; ++a) {
          const double tau = mesh[k] + tables_scheme_.lobatto[j] * (mesh[k + 1] - mesh[k]);
          q[j * n + a] = 1.0 - 0.3 * a + 0.4 * tau * (a + 1) + (j == 0 && k > 0 ? 0 : noise(random));
          if (j == 0 && k > 0) q[a] = last[a];
        }
      for (int a = 0; a < n; ++a) last[a] = q[s * n + a];
      path.set_element(k, q.data());
    }
    path.load_ends();
  }

  double value(const Path& at) {
    action.evaluate_plain(at);
    return action.action();
  }

  /// Moves local unknown `u` of element k by `step`: inner ones, then the element's two ends.
  Path moved(int k, int u, double step) const {
    Path p = path;
    const int n = tables.coordinates(), inner = tables.inner();
    if (u < inner) {
      p.x(k / simd_lanes())[u * simd_lanes() + k % simd_lanes()] += step;
    } else {
      const int node = k + (u - inner) / n, a = (u - inner) % n;
      p.set_node(node, a, p.node(node)[a] + step);
    }
    p.load_ends();
    return p;
  }

 private:
  std::shared_ptr<const Lagrangian> lagrangian_;
  SchemeTables tables_scheme_;

 public:
  ElementTables tables;
  DiscreteAction action;
  Path path;
};

/// Fourth-order central difference.
template <class F>
double difference(F f, double h) {
  return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}

TEST(DiscreteAction, GradientIsTheDerivativeOfTheAction) {
  for (const Case& c : cases())
    for (const Scheme& scheme : all_schemes()) {
      Discretisation d(c.lagrangian, scheme, 1);
      const int m = d.tables.unknowns();
      std::vector<double> hessian(m * m), gradient(m);
      d.action.element_hessian(d.path, 0, hessian, gradient);
      double scale = 1;
      for (double g : gradient) scale = std::max(scale, std::abs(g));
      for (int u = 0; u < m; ++u) {
        const double slope = difference([&](double h) { return d.value(d.moved(0, u, h)); }, 1e-3);
        EXPECT_NEAR(gradient[u], slope, 1e-8 * scale) << c.name << ' ' << scheme.name << " unknown " << u;
      }
    }
}

TEST(DiscreteAction, HessianIsTheDerivativeOfTheGradient) {
  for (const Case& c : cases())
    for (const Scheme& scheme : all_schemes()) {
      Discretisation d(c.lagrangian, scheme, 3);
      const int m = d.tables.unknowns(), k = 1;
      std::vector<double> hessian(m * m), gradient(m), ignored(m * m);
      d.action.element_hessian(d.path, k, hessian, gradient);
      double scale = 1;
      for (double h : hessian) scale = std::max(scale, std::abs(h));
      for (int u = 0; u < m; ++u)
        for (int w = u; w < m; ++w) {
          const double slope = difference(
              [&](double h) {
                d.action.element_hessian(d.moved(k, u, h), k, ignored, gradient);
                return gradient[w];
              },
              1e-3);
          ASSERT_NEAR(hessian[w * m + u], slope, 1e-8 * scale)
              << c.name << ' ' << scheme.name << " unknowns " << w << ", " << u;
        }
    }
}

TEST(DiscreteAction, DerivativesWithRespectToTheDuration) {
  for (const Case& c : cases()) {
    if (!c.lagrangian->structure().autonomous) continue;
    for (const Scheme& scheme : {lobatto(4), gauss(3), lobatto(1)}) {
      Discretisation d(c.lagrangian, scheme, 10, true);
      const auto at = [&](double h) {
        Path p = d.path;
        p.set_duration(p.duration() + h);
        return p;
      };
      d.action.evaluate_plain(d.path);
      const double slope = d.action.slope_duration();
      EXPECT_NEAR(slope, difference([&](double h) { return d.value(at(h)); }, 1e-3), 1e-8)
          << c.name << ' ' << scheme.name;
    }
  }
}

/// Mixed second derivatives with T, condensed, against differences of the full gradient eliminated densely.
TEST(DiscreteAction, BorderOfTheDurationIsCondensed) {
  for (const Case& c : cases()) {
    if (!c.lagrangian->structure().autonomous) continue;
    for (const Scheme& scheme : {lobatto(5), gauss(3), lobatto(1)}) {
      Discretisation d(c.lagrangian, scheme, 1, true);
      const int m = d.tables.unknowns(), inner = d.tables.inner(), n = d.tables.coordinates();
      const auto gradient_at = [&](double h) {
        Path p = d.path;
        p.set_duration(p.duration() + h);
        std::vector<double> hessian(m * m), gradient(m);
        d.action.element_hessian(p, 0, hessian, gradient);
        d.action.evaluate_plain(p);
        gradient.push_back(d.action.slope_duration());
        return gradient;
      };
      Eigen::VectorXd mixed(m);
      for (int u = 0; u < m; ++u) mixed[u] = difference([&](double h) { return gradient_at(h)[u]; }, 1e-3);
      double corner = difference([&](double h) { return gradient_at(h)[m]; }, 1e-3);
      std::vector<double> hessian(m * m), gradient(m);
      d.action.element_hessian(d.path, 0, hessian, gradient);
      Eigen::MatrixXd full(m, m);
      for (int i = 0; i < m; ++i)
        for (int j = 0; j <= i; ++j) full(i, j) = full(j, i) = hessian[i * m + j];
      Eigen::VectorXd reduced = mixed.tail(2 * n);
      if (inner > 0) {
        const Eigen::VectorXd x = full.topLeftCorner(inner, inner).fullPivLu().solve(mixed.head(inner));
        reduced -= full.bottomLeftCorner(2 * n, inner) * x;
        corner -= mixed.head(inner).dot(x);
      }
      d.action.evaluate(d.path);
      const double scale = std::max(1.0, mixed.cwiseAbs().maxCoeff());
      for (int a = 0; a < 2 * n; ++a)
        EXPECT_NEAR(d.action.nodes.border[a], reduced[a], 1e-7 * scale) << c.name << ' ' << scheme.name;
      EXPECT_NEAR(d.action.nodes.corner, corner, 1e-7 * scale) << c.name << ' ' << scheme.name;
    }
  }
}

/// Two parameters, one in front of a velocity term, against systems compiled with other values.
TEST(DiscreteAction, DerivativesWithRespectToParameters) {
  const auto with = [](double a, double b) {
    SystemText text{.coordinates = {"x", "y"},
                    .parameters = {{"a", {{a}}}, {"b", {{b}}}},
                    .lagrangian = "(x'^2 + y'^2)/2 + a^2*cos(x)*y + sin(b*x)*x'*y'",
                    .active = {"a", "b"}};
    return compile(text).lagrangian;
  };
  for (const Scheme& scheme : {lobatto(4), gauss(3), lobatto(1)}) {
    Discretisation d(with(0.7, 1.3), scheme, 10);
    const int m = d.tables.unknowns();
    for (int p : {0, 1}) {
      const auto moved = [&](double h) { return with(0.7 + (p == 0 ? h : 0), 1.3 + (p == 1 ? h : 0)); };
      const auto action_at = [&](double h) {
        Discretisation e(moved(h), scheme, 10);
        return e.value(d.path);
      };
      AlignedDoubles mixed;
      const double slope = d.action.parameter_slope(d.path, p, mixed);
      EXPECT_NEAR(slope, difference(action_at, 1e-3), 1e-10) << scheme.name;
      for (int k : {0, 9})
        for (int u = 0; u < m; ++u) {
          const auto gradient_at = [&](double h) {
            Discretisation e(moved(h), scheme, 10);
            std::vector<double> hessian(m * m), gradient(m);
            e.action.element_hessian(d.path, k, hessian, gradient);
            return gradient[u];
          };
          EXPECT_NEAR(mixed[(k / simd_lanes() * m + u) * simd_lanes() + k % simd_lanes()],
                      difference(gradient_at, 1e-3), 1e-10)
              << scheme.name;
        }
    }
  }
}

/// Condensed equations against the full Hessian eliminated densely.
TEST(DiscreteAction, CondensationIsTheSchurComplement) {
  for (const Case& c : cases())
    for (const Scheme& scheme : {lobatto(6), lobatto(3), gauss(3), lobatto(1)}) {
      Discretisation d(c.lagrangian, scheme, 1, c.lagrangian->structure().autonomous);
      const int m = d.tables.unknowns(), inner = d.tables.inner(), n = d.tables.coordinates();
      std::vector<double> hessian(m * m), gradient(m);
      d.action.element_hessian(d.path, 0, hessian, gradient);
      Eigen::MatrixXd full(m, m);
      Eigen::VectorXd g(m);
      for (int i = 0; i < m; ++i) {
        g[i] = gradient[i];
        for (int j = 0; j <= i; ++j) full(i, j) = full(j, i) = hessian[i * m + j];
      }
      d.action.evaluate(d.path);
      Eigen::MatrixXd schur = full.bottomRightCorner(2 * n, 2 * n);
      Eigen::VectorXd reduced = g.tail(2 * n);
      if (inner > 0) {
        const Eigen::MatrixXd lower = full.bottomLeftCorner(2 * n, inner);
        const auto lu = full.topLeftCorner(inner, inner).fullPivLu();
        schur -= lower * lu.solve(lower.transpose());
        reduced -= lower * lu.solve(g.head(inner));
      }
      const double scale = full.cwiseAbs().maxCoeff();
      for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(d.action.nodes.gradient[i], reduced[i], 1e-12 * scale) << c.name << ' ' << scheme.name;
        EXPECT_NEAR(d.action.nodes.gradient[n + i], reduced[n + i], 1e-12 * scale);
        for (int j = 0; j < n; ++j) {
          EXPECT_NEAR(d.action.nodes.first[i * n + j], schur(i, j), 1e-12 * scale);
          EXPECT_NEAR(d.action.nodes.last[i * n + j], schur(n + i, n + j), 1e-12 * scale);
          EXPECT_NEAR(d.action.nodes.first_lower[i * n + j], schur(n + i, j), 1e-12 * scale);
        }
      }
    }
}

/// θ = ω_h h with z = ω h, from S = ½ (q_a, q_b) [[α, β], [β, α']] (q_a, q_b)ᵀ: cos θ = −(α + α')/(2β).
double discrete_cosine(const Scheme& scheme, double z) {
  Discretisation d(systems::oscillator(z), scheme, 1);
  const std::vector<double> mesh{0, 1};
  d.path.reset(d.tables, mesh, 1.0);
  d.path.load_ends();
  d.action.evaluate(d.path);
  return -(d.action.nodes.first[0] + d.action.nodes.last[0]) / (2 * d.action.nodes.first_lower[0]);
}

TEST(DiscreteFrequency, IsExactlyThatOfTheScheme) {
  for (double z : {0.05, 0.3, 0.9, 1.4}) {
    for (const char* name : {"rectangle", "rectangle-right", "trapezoid"})
      EXPECT_NEAR(discrete_cosine(scheme(name), z), 1 - z * z / 2, 1e-15) << name;
    EXPECT_NEAR(std::tan(std::acos(discrete_cosine(scheme("midpoint"), z)) / 2), z / 2, 1e-14);
    for (const char* name : {"linear", "simpson"})
      EXPECT_NEAR(discrete_cosine(scheme(name), z), (1 - z * z / 3) / (1 + z * z / 6), 1e-15) << name;
  }
}

TEST(DiscreteFrequency, ApproachesTheExactOneWithTwiceTheDegree) {
  for (int s : {2, 3, 4})
    for (const Scheme& scheme : {lobatto(s), gauss(s)}) {
      const auto error = [&](double z) { return std::abs(std::acos(discrete_cosine(scheme, z)) / z - 1); };
      const double slope = std::log2(error(0.8) / error(0.4));
      EXPECT_NEAR(slope, 2 * s, 0.15) << scheme.name;
    }
}

}  // namespace
}  // namespace extremal
