#include <Eigen/Dense>

#include "solve/laws.hpp"

/// \file Schemes on few elements: their equations have solutions that are near no extremal, and a second
/// variation of their own.

namespace extremal::laws {
namespace {

/// L = |q'|²/2 + w (x y' − y x') − (a x² + b y²)/2 − c cos(x + 2y) − d sin(xy).
struct Coupled {
  double w, a, b, c, d;

  std::shared_ptr<const Lagrangian> lagrangian() const {
    return trace(2, [*this](auto q, auto v, auto) {
      return (v[0] * v[0] + v[1] * v[1]) / 2 + w * (q[0] * v[1] - q[1] * v[0]) -
             ((a * q[0] * q[0] + b * q[1] * q[1]) / 2 + c * cos(q[0] + 2 * q[1]) + d * sin(q[0] * q[1]));
    });
  }
  Eigen::Vector2d slope(const Eigen::Vector2d& q) const {  // of the potential
    const double s = c * std::sin(q[0] + 2 * q[1]), k = d * std::cos(q[0] * q[1]);
    return {a * q[0] - s + k * q[1], b * q[1] - 2 * s + k * q[0]};
  }
  Eigen::Matrix2d stiffness(const Eigen::Vector2d& q) const {
    const double s = c * std::cos(q[0] + 2 * q[1]), k = d * std::cos(q[0] * q[1]),
                 l = d * std::sin(q[0] * q[1]);
    Eigen::Matrix2d m;
    m << a - s - l * q[1] * q[1], -2 * s + k - l * q[0] * q[1], -2 * s + k - l * q[0] * q[1],
        b - 4 * s - l * q[0] * q[0];
    return m;
  }
};

Eigen::Vector2d at_node(const Trajectory& path, int k) {
  const Values q = node(path, k);
  return {q[0], q[1]};
}

/// Largest ∂S_h/∂q_k at the nodes between: of `midpoint`, or of `rectangle` with the potential at the left
/// end.
double residual(const Coupled& system, const Trajectory& path, bool midpoint) {
  double most = 0;
  for (int k = 1; k < path.elements(); ++k) {
    const Eigen::Vector2d before = at_node(path, k - 1), here = at_node(path, k),
                          after = at_node(path, k + 1);
    const double h = path.length(k);
    const Eigen::Vector2d slope =
        midpoint
            ? Eigen::Vector2d(system.slope((before + here) / 2) / 2 + system.slope((here + after) / 2) / 2)
            : system.slope(here);
    const Eigen::Vector2d across = after - before;
    const Eigen::Vector2d turned = system.w * Eigen::Vector2d(across[1], -across[0]);
    most = std::max(most, ((2 * here - before - after) / h + turned - h * slope).cwiseAbs().maxCoeff());
  }
  return most;
}

/// Newton's method alone finds none of these, from the line or from the extremal.
TEST(CoarseSchemes, SolutionsThatNewtonsMethodMisses) {
  struct Case {
    Coupled system;
    Values start, end;
    double duration;
    const char* scheme;
  };
  const Case cases[] = {
      {{-0.289, 1.424, 2.094, 0.276, 0.158}, {-0.711, -0.674}, {0.910, 0.3}, 4.7283, "midpoint"},
      {{-0.147, 1.284, 2.786, -0.918, -0.030}, {-0.424, 0.754}, {0.933, 0.3}, 3.0286, "rectangle"},
  };
  for (const Case& given : cases) {
    const Problem problem = fixed_ends(given.system.lagrangian(), given.start, given.end, given.duration);
    const Solution s = solve(problem, pinned(scheme(given.scheme), 10));
    EXPECT_LT(residual(given.system, s.trajectory, std::string(given.scheme) == "midpoint"), 1e-13);
    EXPECT_NE(s.strategy.find("homotopy in the residual"), std::string::npos) << s.strategy;
  }
}

/// By the midpoint rule extremals of L = x'²/2 − x²/2 turn by θ = 2 atan(h/2) an element. A field that
/// vanishes at t = 0 is sin kθ at node k, and linear between.
TEST(CoarseSchemes, ConjugateTimesOfAnOscillator) {
  const auto oscillator = trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2; });
  const int elements = 9;
  const double T = 10, h = T / elements, theta = 2 * std::atan(h / 2);
  Values expected;
  for (int k = 1; k < elements; ++k) {
    const double a = std::sin(k * theta), b = std::sin((k + 1) * theta);
    if (a * b < 0) expected.push_back(h * (k + a / (a - b)));
  }
  const Solution s = solve(fixed_ends(oscillator, {1}, {0.3}, T), pinned(scheme("midpoint"), elements));
  ASSERT_EQ(s.conjugate_times.size(), expected.size());
  EXPECT_EQ(s.morse_index, static_cast<int>(expected.size()));
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(s.conjugate_times[k], expected[k], 1e-10);
}

/// Morse's theorem holds for the second variation of the scheme itself.
TEST(CoarseSchemes, AsManyConjugateTimesAsTheIndex) {
  const Coupled system{0.18, 1.891, 2.909, 0.694, 0.129};
  const Problem problem = fixed_ends(system.lagrangian(), {-0.979, 0.657}, {-0.243, 0.3}, 6.6632);
  for (const int elements : {6, 7, 8, 10}) {
    const Solution s = solve(problem, pinned(scheme("midpoint"), elements));
    const Trajectory& path = s.trajectory;
    const double h = 6.6632 / elements;
    Eigen::MatrixXd second = Eigen::MatrixXd::Zero(2 * elements + 2, 2 * elements + 2);
    for (int k = 0; k < elements; ++k) {
      const Eigen::Matrix2d v = h / 4 * system.stiffness((at_node(path, k) + at_node(path, k + 1)) / 2);
      const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity() / h;
      Eigen::Matrix2d turned;  // of w (x_k y_{k+1} − y_k x_{k+1})
      turned << 0, system.w, -system.w, 0;
      second.block<2, 2>(2 * k, 2 * k) += unit - v;
      second.block<2, 2>(2 * k + 2, 2 * k + 2) += unit - v;
      second.block<2, 2>(2 * k, 2 * k + 2) += turned - unit - v;
      second.block<2, 2>(2 * k + 2, 2 * k) += turned.transpose() - unit - v;
    }
    const int inner = 2 * elements - 2;
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(second.block(2, 2, inner, inner)).eigenvalues();
    const auto index = (eigenvalues.array() < 0).count();
    EXPECT_EQ(s.morse_index, index) << elements;
    EXPECT_EQ(std::ssize(s.conjugate_times), index) << elements;
  }
}

}  // namespace
}  // namespace extremal::laws
