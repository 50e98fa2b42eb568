#include "analysis/orbit_form.hpp"

#include <numbers>

#include "analysis/independent.hpp"
#include "analysis/node_form.hpp"
#include "solve/periodic/stability.hpp"
#include "solve/scenes.hpp"

/// \file Indices of iterates and eigenvectors of multipliers.

namespace extremal::laws {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// At rest: 2⌊Tω/2π⌋ + 1 for each frequency ω, T that of all rounds together.
TEST(OrbitForm, IteratesOfRest) {
  const double frequencies[] = {1, std::sqrt(3.0)};
  const auto lagrangian = trace(2, [&](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (int a = 0; a < 2; ++a) l = l + (v[a] * v[a] - frequencies[a] * frequencies[a] * q[a] * q[a]) / 2;
    return l;
  });
  for (const double T : {0.7, 2.0, 5.1, 11.0}) {
    const Problem problem = guessed(periodic(lagrangian, T), [](double) { return Values{0, 0}; });
    const std::vector<int> found = iterate_indices(problem, solve(problem, within(1e-9)), 12);
    ASSERT_EQ(found.size(), 12u);
    for (int times = 1; times <= 12; ++times) {
      int expected = 0;
      for (const double omega : frequencies)
        expected += 2 * static_cast<int>(times * T * omega / (2 * pi)) + 1;
      EXPECT_EQ(found[times - 1], expected) << T << " " << times;
    }
  }
}

/// Negative squares on fields with η(T) = −R η(0).
int antiperiodic_index(SecondVariation& variation, const Eigen::MatrixXd& map) {
  const auto n = map.rows();
  Eigen::MatrixXd ends(2 * n, n);
  ends << Eigen::MatrixXd::Identity(n, n), -map;
  return NodeForm(variation, ends).below(0).value();
}

/// Fields that turn their sign after T at rest: cos and sin of (2k + 1)πt/T, slower than ω. The map turns the
/// plane by an angle φ, so that they turn by φ + (2k + 1)π.
TEST(OrbitForm, FieldsThatTurnTheirSign) {
  const auto lagrangian = trace(
      2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - q[1] * q[1]) / 2; });
  for (const double T : {0.7, 2.0, 5.1, 11.0})
    for (const double angle : {0.0, 0.6}) {
      const Problem problem = guessed(periodic(lagrangian, T), [](double) { return Values{0, 0}; });
      const Solution rest = solve(problem, within(1e-9));
      SecondVariation variation;
      ASSERT_TRUE(variation.assemble(lagrangian, rest.trajectory));
      Eigen::MatrixXd map(2, 2);
      map << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
      int expected = 0;
      for (int k = -10; k < 10; ++k) expected += 2 * (std::abs(angle + (2 * k + 1) * pi) < T);
      EXPECT_EQ(antiperiodic_index(variation, map), expected) << T << " " << angle;
    }
}

/// The trajectory of a periodic orbit run through several times.
Trajectory repeated(const Trajectory& once, int times) {
  Trajectory result = once;
  for (int k = 1; k < times; ++k) {
    for (std::size_t i = 1; i < once.times.size(); ++i)
      result.times.push_back(k * once.duration() + once.times[i]);
    result.nodes.insert(result.nodes.end(), once.nodes.begin(), once.nodes.end());
    result.slopes.insert(result.slopes.end(), once.slopes.begin(), once.slopes.end());
    result.lengths.insert(result.lengths.end(), once.lengths.begin(), once.lengths.end());
  }
  return result;
}

/// Librations of a pendulum have periods that grow with the energy: k of them, with 2k zeros of q', have
/// 2k − 1 negative squares. So says the form of the whole as well. Those of 2k are those of k and of the
/// fields that turn their sign after k.
TEST(OrbitForm, IteratesOfLibrations) {
  for (const double T : {6.5, 8.0, 12.0}) {
    const Problem once = guessed(periodic(systems::pendulum(), T),
                                 [](double tau) { return Values{2 * std::sin(2 * pi * tau)}; });
    const Solution solution = solve(once, within(1e-10));
    const std::vector<int> found = iterate_indices(once, solution, 5);
    ASSERT_EQ(found.size(), 5u);
    EXPECT_EQ(found[0], *solution.morse_index);
    for (int times = 1; times <= 5; ++times) {
      EXPECT_EQ(found[times - 1], 2 * times - 1) << T;
      SecondVariation variation;
      const Trajectory whole = repeated(solution.trajectory, times);
      ASSERT_TRUE(variation.assemble(systems::pendulum(), whole));
      EXPECT_EQ(OrbitForm::make(variation, {})->index(0), 2 * times - 1) << T;
      EXPECT_EQ(antiperiodic_index(variation, Eigen::MatrixXd::Identity(1, 1)), 2 * times) << T;
    }
  }
}

/// M v = λ v with the linearised flow, integrated; a multiplier of a thousand and its inverse as well.
TEST(OrbitForm, EigenvectorsOfAHaloOrbit) {
  Study study = load(std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/lyapunov-family.toml");
  study.options.tolerance = 1e-12;
  const Solution s = run(study);
  ASSERT_TRUE(s.converged() && s.floquet) << s.message;
  ASSERT_EQ(s.floquet->vectors.size(), 6u);
  EXPECT_GT(std::abs(s.floquet->multipliers[0]), 1000);
  const Eigen::MatrixXd flow = linearised_flow(*study.problem.lagrangian, s);
  for (std::size_t k = 0; k < 6; ++k) {
    const Eigen::Map<const Eigen::VectorXcd> v(s.floquet->vectors[k].data(), 6);
    const Complex lambda = s.floquet->multipliers[k];
    EXPECT_NEAR(v.norm(), 1, 1e-14);
    EXPECT_LT((flow * v - lambda * v).norm(), 1e-9 * flow.norm()) << lambda;
  }
  // The small one, told apart from the roundoff of the large one, runs backwards like the large one onwards.
  const Eigen::Map<const Eigen::VectorXcd> small(s.floquet->vectors[5].data(), 6);
  EXPECT_LT((flow.partialPivLu().solve(small.eval()) * s.floquet->multipliers[5] - small).norm(), 1e-6);
}

}  // namespace
}  // namespace extremal::laws
