#include "solve/laws.hpp"

/// \file Order of every scheme, as a slope on nonlinear problems, against the adaptive solution.

namespace extremal::laws {
namespace {

struct NonlinearCase {
  const char* name;
  Problem problem;
  bool separable;  ///< L = T(q') − V(q): the one-sided rectangles then are Störmer-Verlet at the nodes
  int fineness;    ///< where the errors begin to fall with the order, relative to the easiest case
};

std::vector<NonlinearCase> nonlinear_cases() {
  return {
      {"pendulum", fixed_ends(systems::pendulum(), {0}, {1.5}, 2), true, 1},
      {"Kepler arc", fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5), true, 1},
      {"double pendulum", fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 0.8), false, 2},
      {"magnetic", fixed_ends(systems::magnetic(), {0.3, -0.2}, {0.9, 0.5}, 1.5), false, 1}};
}

/// Errors at and below this are roundoff: the reference is good to a few times 1e-15.
constexpr double order_plateau = 2e-14;
/// Coarsest meshes in the asymptotic range, by order.
int first_elements(int order) {
  const int by_order[] = {0, 64, 24, 0, 10, 0, 6, 0, 4};
  return by_order[order];
}
constexpr int levels = 6;

class Order : public ::testing::TestWithParam<std::string> {
 protected:
  const Scheme tested = scheme(GetParam());

  int node_order(const NonlinearCase& c) const { return one_sided(tested) && c.separable ? 2 : tested.order; }
  /// Chen-Guo-Wu (2.28): h² with linear elements; (2.53): h³ with quadratic ones.
  int dense_order(const NonlinearCase& c) const { return std::min(node_order(c), tested.degree + 1); }
};

TEST_P(Order, OfNodesAndOfDenseOutput) {
  for (const NonlinearCase& c : nonlinear_cases()) {
    const Trajectory truth = solve(c.problem, within(1e-13)).trajectory;
    Refinement nodes, dense;
    for (int elements : refinements(c.fineness * first_elements(tested.order), levels)) {
      const Trajectory path = solve(c.problem, pinned(tested, elements)).trajectory;
      ASSERT_EQ(path.elements(), elements);
      ASSERT_EQ(path.degree, tested.degree);
      nodes.add(1.0 / elements, node_distance(path, truth));
      dense.add(1.0 / elements, l2_distance(path, truth));
    }
    EXPECT_NEAR(nodes.slope(order_plateau), node_order(c), 0.05 * node_order(c)) << c.name;
    EXPECT_NEAR(dense.slope(order_plateau), dense_order(c), 0.05 * dense_order(c)) << c.name;
  }
}

TEST_P(Order, ErrorEstimateIsHonest) {
  for (const NonlinearCase& c : nonlinear_cases()) {
    const Trajectory truth = solve(c.problem, within(1e-13)).trajectory;
    for (int elements : {4, 12, 40}) {
      const Solution solution = solve(c.problem, pinned(tested, elements));
      const double error = sup_distance(solution.trajectory, truth);
      if (error < order_plateau) continue;
      EXPECT_LT(solution.error_estimate, 10 * error) << c.name << ", " << elements << " elements";
      EXPECT_GT(solution.error_estimate, 0.1 * error) << c.name << ", " << elements << " elements";
    }
  }
}

/// δS_h = 0 to roundoff, as `residual` says.
TEST_P(Order, DiscreteEquationsHoldToRoundoff) {
  for (const NonlinearCase& c : nonlinear_cases())
    for (int elements : {1, 7, 50})
      EXPECT_LT(solve(guided(c.problem), pinned(tested, elements)).residual, 1e-14)
          << c.name << ' ' << elements;
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const Scheme& s : schemes_and_families()) list.push_back(s.name);
  return list;
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
}

INSTANTIATE_TEST_SUITE_P(Schemes, Order, ::testing::ValuesIn(names()), test_name);

/// With a tolerance, N is what the scheme needs: not met by luck, not wasted.
TEST(OrderAdapted, SchemesMeetTheTolerance) {
  for (const NonlinearCase& c : nonlinear_cases()) {
    const Trajectory truth = solve(c.problem, within(1e-13)).trajectory;
    double range = 0;
    for (int a = 0; a < truth.coordinates; ++a) {
      double low = INFINITY, high = -INFINITY;
      for (int i = 0; i <= 1000; ++i) {
        const double q = at(truth, truth.duration() * i / 1000).q[a];
        low = std::min(low, q), high = std::max(high, q);
      }
      range = std::max(range, high - low);
    }
    for (const Scheme& s : schemes_and_families()) {
      const double tolerance = s.order == 1 ? 1e-3 : s.order == 2 ? 1e-5 : 1e-8;
      SolveOptions options = within(tolerance);
      options.scheme = s;
      const Solution solution = solve(c.problem, options);
      const double error = sup_distance(solution.trajectory, truth);
      EXPECT_LE(error, tolerance * range) << c.name << ' ' << s.name;
      EXPECT_GE(error, 1e-4 * tolerance * range) << c.name << ' ' << s.name;
    }
  }
}

/// Velocities and momenta between nodes meet ten times the tolerance, whatever the degree of the elements.
TEST(SchemesToATolerance, VelocitiesMeetIt) {
  for (const NonlinearCase& c : nonlinear_cases()) {
    const Solution exact = Solver().solve(c.problem, within(1e-13));
    ASSERT_TRUE(exact.converged()) << exact.message;
    const std::size_t n = c.problem.coordinates();
    for (const char* name : {"midpoint", "trapezoid", "linear", "quadratic", "gauss(2)", "lobatto(3)"}) {
      SolveOptions options = within(1e-7);
      options.scheme = scheme(name);
      const Solution s = Solver().solve(c.problem, options);
      ASSERT_TRUE(s.converged()) << c.name << ' ' << name << ": " << s.message;
      std::vector<double> q(n), v(n), exact_v(n);
      double off = 0, low = INFINITY, high = -INFINITY;
      for (int k = 0; k <= 500; ++k) {
        const double t = s.duration() * k / 500;
        s.trajectory.at(t, q, v);
        exact.trajectory.at(t, q, exact_v);
        for (std::size_t a = 0; a < n; ++a) {
          off = std::max(off, std::abs(v[a] - exact_v[a]));
          low = std::min(low, exact_v[a]);
          high = std::max(high, exact_v[a]);
        }
      }
      EXPECT_LE(off, 10 * 1e-7 * (high - low)) << c.name << ' ' << name;
    }
  }
}

}  // namespace
}  // namespace extremal::laws
