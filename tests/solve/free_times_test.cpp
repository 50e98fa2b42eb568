#include "machine/long_test.hpp"
#include "solve/laws.hpp"

/// \file The times of the nodes as unknowns: one discrete energy, the extended symplectic form, and where
/// there are no such times.

namespace extremal::laws {
namespace {

SolveOptions free_steps(const Scheme& scheme, int elements) {
  SolveOptions options = pinned(scheme, elements);
  options.free_steps = true;
  return options;
}

double spread(std::span<const double> values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

std::shared_ptr<const Lagrangian> unit_pendulum() {
  return trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); });
}

/// L = |q'|²/2 − x²/2 − y⁴/4 − xy.
std::shared_ptr<const Lagrangian> quartic_and_coupled() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 - q[0] * q[0] / 2 - q[1] * q[1] * q[1] * q[1] / 4 - q[0] * q[1];
  });
}

std::vector<Scheme> schemes_with_free_steps() {
  std::vector<Scheme> list;
  for (const char* name : {"rectangle", "midpoint", "trapezoid", "simpson", "linear", "quadratic",
                           "lobatto(2)", "lobatto(3)", "gauss(2)", "gauss(3)"})
    list.push_back(scheme(name));
  return list;
}

/// Chen-Guo-Wu (3.3). The same for steps that are equal holds to the order of the scheme only.
TEST(FreeTimes, AllElementsHaveOneEnergy) {
  const Problem problem = fixed_ends(unit_pendulum(), {0.3}, {1.5}, 1.2);
  for (const Scheme& scheme : schemes_with_free_steps()) {
    const Solution equal = solve(problem, pinned(scheme, 12)), free = solve(problem, free_steps(scheme, 12));
    ASSERT_EQ(free.element_energies.size(), 12u) << scheme.name;
    EXPECT_LT(spread(free.element_energies), 1e-12) << scheme.name;
    EXPECT_GT(spread(equal.element_energies), 20 * spread(free.element_energies)) << scheme.name;
    EXPECT_TRUE(std::is_sorted(free.trajectory.times.begin(), free.trajectory.times.end())) << scheme.name;
    EXPECT_EQ(free.trajectory.times.back(), 1.2);
  }
}

/// Fine elements have almost one energy at equal times, and these are no solution yet.
TEST(FreeTimes, EnergiesThatDifferLittleAreNotEqual) {
  LONG_TEST();
  const Problem problem = fixed_ends(unit_pendulum(), {-2.0}, {2.9}, 3.0);
  for (const int elements : {6, 24, 28}) {
    Solver solver;
    const Solution free = solver.solve(problem, free_steps(scheme("gauss(4)"), elements));
    if (free.converged())
      EXPECT_LT(spread(free.element_energies), 5e-14) << elements;
    else
      EXPECT_NE(free.message.find("node times"), std::string::npos) << free.message;
  }
}

/// For V the potential, one element of the midpoint rule has the modified energy
/// H − h²/24 (q'ᵀV''q' + |V'|²), and E_k = −∂L_d/∂h is H + 3 h² H₂ with H₂ = −(q'ᵀV''q' + |V'|²)/24 (backward
/// error analysis). One energy in all elements asks for h ∝ |H₂|^(−1/3).
TEST(FreeTimes, StepsFollowTheModifiedEnergy) {
  const int elements = 200;
  const Solution s =
      solve(fixed_ends(unit_pendulum(), {0.3}, {1.5}, 1.2), free_steps(scheme("midpoint"), elements));
  Values products;
  for (int k = 0; k < elements; ++k) {
    const double h = s.trajectory.times[k + 1] - s.trajectory.times[k];
    const State state = at(s.trajectory, s.trajectory.times[k] + h / 2);
    const double v = state.v[0], sine = std::sin(state.q[0]), cosine = std::cos(state.q[0]);
    products.push_back(h * std::cbrt(v * v * cosine + sine * sine));
  }
  EXPECT_LT(spread(products), 2e-3 * products.front());
}

/// From the lowest point to near the upper one, nodes move by many of the elements: where the pendulum is
/// slow they are far apart.
TEST(FreeTimes, NearASeparatrix) {
  const double energy = 1 + 1e-4;
  const Trajectory motion =
      solve(initial_problem(unit_pendulum(), {{0}, {std::sqrt(2 * (energy + 1))}}, 5), within(1e-12))
          .trajectory;
  const Problem problem = fixed_ends(unit_pendulum(), {0}, {at(motion, 5).q[0]}, 5);
  for (const int elements : {50, 200}) {
    const Solution s = solve(problem, free_steps(scheme("trapezoid"), elements));
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_LT(spread(s.element_energies), 1e-12);
    double farthest = 0;
    for (int k = 0; k <= elements; ++k)
      farthest = std::max(farthest, std::abs(s.trajectory.times[k] * elements / 5 - k));
    EXPECT_GT(farthest, 0.05 * elements);
  }
}

TEST(FreeTimes, OrderIsThatOfTheScheme) {
  const Problem problem = fixed_ends(systems::kepler(), {1, 0}, {0.3, 0.8}, 1.1);
  const Trajectory truth = solve(problem, within(1e-13)).trajectory;
  for (const char* name : {"midpoint", "trapezoid", "gauss(2)"}) {
    Refinement nodes;
    for (const int elements : {8, 12, 16, 24, 32})
      nodes.add(1.0 / elements,
                node_distance(solve(problem, free_steps(scheme(name), elements)).trajectory, truth));
    EXPECT_NEAR(nodes.slope(1e-14), scheme(name).order, 0.1 * scheme(name).order) << name;
  }
}

/// On equal steps the midpoint rule conserves the energy of an oscillator: its times are free already.
TEST(FreeTimes, TimesThatAreRightStay) {
  const auto oscillator = trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2; });
  const Solution s = solve(fixed_ends(oscillator, {1}, {0.2}, 1), free_steps(scheme("midpoint"), 10));
  for (int k = 0; k <= 10; ++k) EXPECT_NEAR(s.trajectory.times[k], k / 10.0, 1e-14);
}

/// A free duration is closed by the energy of every element, also by zero.
TEST(FreeTimes, TheEnergyOfAFreeDuration) {
  for (const double energy : {0.0, 0.05}) {
    Problem problem = fixed_ends(unit_pendulum(), {0.3}, {1.5}, 1.2);
    problem.duration = {.value = 1.2, .free = true, .energy = energy, .where = {}};
    const Solution s = solve(make_problem(problem), free_steps(scheme("midpoint"), 20));
    for (const double found : s.element_energies) EXPECT_NEAR(found, energy, 1e-12);
  }
}

/// dθ⁺ of one element, extended to times (Chen-Guo-Wu (3.4), (3.5)), is carried on: with the first node of
/// the first element and its energy as start, the discrete map (t, q, −E, p)_k → (t, q, −E, p)_{k+1} is
/// symplectic. S itself generates it: the matrix of second derivatives of S by both ends, T and t_0 = 0
/// shifted, is that of finite differences of momenta and energies, so it is symmetric.
TEST(FreeTimes, EnergyAndMomentaAreDerivativesOfTheAction) {
  const auto lagrangian = unit_pendulum();
  const auto solved = [&](double a, double b, double T) {
    return solve(fixed_ends(lagrangian, {a}, {b}, T), free_steps(scheme("midpoint"), 12));
  };
  const double a = 0.3, b = 1.5, T = 1.2, d = 1e-4;
  const Solution s = solved(a, b, T);
  const auto slope = [&](double da, double db, double dT) {
    return (solved(a + da, b + db, T + dT).action - solved(a - da, b - db, T - dT).action) / (2 * d);
  };
  EXPECT_NEAR(slope(d, 0, 0), -s.momentum_start[0], 1e-7);
  EXPECT_NEAR(slope(0, d, 0), s.momentum_end[0], 1e-7);
  EXPECT_NEAR(slope(0, 0, d), -s.element_energies[0], 1e-7);
}

/// On the way to these times μ turns back, or an element stretches over the place where the energy error
/// changes its sign.
TEST(FreeTimes, BehindFolds) {
  LONG_TEST();
  const Problem problem = fixed_ends(quartic_and_coupled(), {0, 1}, {2, 0.1}, 1.5);
  const std::pair<const char*, int> cases[] = {{"midpoint", 8},  {"midpoint", 12},  {"trapezoid", 3},
                                               {"trapezoid", 8}, {"trapezoid", 12}, {"simpson", 8},
                                               {"gauss(2)", 8}};
  for (const auto& [name, elements] : cases) {
    const Solution s = solve(problem, free_steps(scheme(name), elements));
    ASSERT_EQ(s.element_energies.size(), static_cast<std::size_t>(elements));
    EXPECT_LT(spread(s.element_energies), 1e-11) << name << elements;
    EXPECT_TRUE(std::is_sorted(s.trajectory.times.begin(), s.trajectory.times.end()));
    EXPECT_LT(s.residual, 1e-12) << name << elements;
  }
}

/// Where H₂ changes its sign an element stretches over the place: the Kepler ellipse between 0.22 and 1.28 of
/// a.
TEST(FreeTimes, WhereTheEnergyErrorChangesItsSign) {
  const double y = std::sqrt(0.19);
  const Problem problem = fixed_ends(systems::kepler(), {0.1, 0}, {-1, y}, 1.5);
  const Solution s = solve(problem, free_steps(scheme("midpoint"), 64));
  EXPECT_LT(spread(s.element_energies), 1e-10 * std::abs(s.element_energies[0]));
  EXPECT_LT(s.residual, 1e-12);
  EXPECT_TRUE(std::is_sorted(s.trajectory.times.begin(), s.trajectory.times.end()));
}

/// A search that has not found them when its steps are spent names the node at which it ends.
TEST(FreeTimes, WhereNoneAreFound) {
  LONG_TEST();
  SolveOptions options = free_steps(scheme("gauss(3)"), 12);
  options.max_iterations = 6000;
  Solver solver;
  const Solution s = solver.solve(fixed_ends(quartic_and_coupled(), {0, 1}, {2, 0.1}, 1.5), options);
  EXPECT_EQ(s.status, Status::not_converged);
  EXPECT_NE(s.message.find("at node"), std::string::npos) << s.message;
  EXPECT_NE(s.message.find("no solution"), std::string::npos) << s.message;
  EXPECT_TRUE(s.element_energies.empty());
}

}  // namespace
}  // namespace extremal::laws
