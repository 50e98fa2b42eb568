#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>

#include "scenes.hpp"
#include "solution/extension_values.hpp"

/// \file Orbits on pinned elements: their multipliers are those of the map from node to node, which has the
/// symmetries of L, and the shift in time not.

namespace extremal::test {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

class SchemeMultipliers : public Scenes {
 protected:
  Solution orbit(const std::string& scene) {
    Solution solution = run(study(scene));
    EXPECT_TRUE(solution.converged()) << solution.message;
    EXPECT_TRUE(solution.floquet) << solution.message;
    return solution;
  }
};

/// The mean of the state at both nodes of an element.
Eigen::VectorXd middle(const Trajectory& path, int element) {
  const Eigen::Index n = path.coordinates;
  Eigen::VectorXd a(n), b(n), slope(n);
  const auto at = [&](int node, Eigen::VectorXd& q) {
    path.at(path.times[node], {q.data(), std::size_t(n)}, {slope.data(), std::size_t(n)});
  };
  at(element, a);
  at(element + 1, b);
  return (a + b) / 2;
}

/// Σ λ and Σ λ² are smooth functions of a matrix, also where its eigenvalues meet.
void expect_eigenvalues(const Solution& solution, const MatrixXd& flow) {
  std::complex<double> sum = 0, squares = 0;
  for (const auto& value : solution.floquet->multipliers) sum += value, squares += value * value;
  const double size = flow.norm();
  EXPECT_NEAR(sum.real(), flow.trace(), 1e-10 * size);
  EXPECT_NEAR(squares.real(), (flow * flow).trace(), 1e-10 * size * size);
  EXPECT_NEAR(sum.imag(), 0, 1e-12);
}

/// Of L = |q'|²/2 − V: p₀ = (q₁ − q₀)/h + (h/2) V'(q), p₁ = (q₁ − q₀)/h − (h/2) V'(q), q = (q₀ + q₁)/2.
Matrix4d midpoint_flow(const Trajectory& path, const std::function<Matrix2d(const Vector2d&)>& stiffness) {
  Matrix4d flow = Matrix4d::Identity();
  for (int k = 0; k < path.elements(); ++k) {
    const double h = path.length(k);
    const Matrix2d unit = Matrix2d::Identity() / h, quarter = h / 4 * stiffness(middle(path, k));
    Matrix4d element;
    const Matrix2d inverse = (unit + quarter).inverse(), from_q = inverse * (unit - quarter);
    element << from_q, inverse, (unit - quarter) * from_q - (unit + quarter), (unit - quarter) * inverse;
    flow = (element * flow).eval();
  }
  return flow;
}

/// V = cosh(x − y) + y⁴/4 + x²/2, on so many elements; `rest` belongs to [boundary].
std::string in_two_coordinates(int elements, const std::string& rest = "") {
  return fmt::format(
      "[system]\ncoordinates = [\"x\", \"y\"]\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - cosh(x - y) - y^4/4 - x^2/2\"\n"
      "[boundary]\nperiodic = true\nduration = 5\n{}[guess]\nx = \"cos(2*pi*t/T)\"\n"
      "y = \"sin(2*pi*t/T)\"\n[solve]\nscheme = \"midpoint\"\nelements = {}\n",
      rest, elements);
}

Matrix2d stiffness(const Vector2d& q) {
  const double c = std::cosh(q[0] - q[1]);
  return (Matrix2d() << 1 + c, -c, -c, c + 3 * q[1] * q[1]).finished();
}

TEST_F(SchemeMultipliers, AreThoseOfTheMapFromNodeToNode) {
  for (const int elements : {24, 32}) {
    const Solution solution = orbit(in_two_coordinates(elements));
    expect_eigenvalues(solution, midpoint_flow(solution.trajectory, stiffness));
    EXPECT_EQ(solution.nullity, 1);
    EXPECT_EQ(solution.message.find("continuum"), std::string::npos) << solution.message;
  }
}

/// Those of L + ν x².
TEST_F(SchemeMultipliers, WithAnIntegral) {
  const Solution solution = orbit(in_two_coordinates(24, "integrals = [\"x^2 = 3\"]\n"));
  const double multiplier = solution.extension->integral_multipliers.at(0);
  expect_eigenvalues(solution, midpoint_flow(solution.trajectory, [&](const Vector2d& q) -> Matrix2d {
                       Matrix2d second = stiffness(q);
                       second(0, 0) -= 2 * multiplier;
                       return second;
                     }));
}

/// A rotation moves a polygon to itself with another phase: that pair is exactly 1.
TEST_F(SchemeMultipliers, HaveTheSymmetriesOfTheScheme) {
  const Solution solution = orbit(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - (x^2 + y^2)^2/4\"\n"
      "[boundary]\nperiodic = true\nduration = 5\n[guess]\nx = \"1.2*cos(2*pi*t/T)\"\n"
      "y = \"1.2*sin(2*pi*t/T)\"\n[solve]\nscheme = \"midpoint\"\nelements = 12\n");
  expect_eigenvalues(solution, midpoint_flow(solution.trajectory, [](const Vector2d& q) -> Matrix2d {
                       return q.squaredNorm() * Matrix2d::Identity() + 2 * q * q.transpose();
                     }));
  EXPECT_EQ(std::ranges::count(solution.floquet->multipliers, std::complex<double>(1)), 2);
}

/// z₁ − z₀ = h J ∇H((z₀ + z₁)/2) for H = cos x cos p, of which H_pp is singular at p = π/2.
TEST_F(SchemeMultipliers, InPhaseSpace) {
  const Solution solution = orbit(
      "[system]\ncoordinates = [\"x\"]\nhamiltonian = \"cos(x)*cos(p_x)\"\n"
      "[boundary]\nperiodic = true\nduration = 7\n[guess]\nx = \"0.9*sin(2*pi*t/T)\"\n"
      "p_x = \"-0.9*cos(2*pi*t/T)\"\n[solve]\nscheme = \"midpoint\"\nelements = 12\n");
  MatrixXd flow = MatrixXd::Identity(2, 2);
  for (int k = 0; k < solution.trajectory.elements(); ++k) {
    const Eigen::VectorXd z = middle(solution.trajectory, k);
    const double cc = std::cos(z[0]) * std::cos(z[1]), ss = std::sin(z[0]) * std::sin(z[1]);
    const Matrix2d slope = solution.trajectory.length(k) / 2 * (Matrix2d() << ss, -cc, cc, -ss).finished();
    flow = ((Matrix2d::Identity() - slope).inverse() * (Matrix2d::Identity() + slope) * flow).eval();
  }
  expect_eigenvalues(solution, flow);
}

/// With a force F: p₀ = (q₁ − q₀)/h + (h/2)(V' − F), p₁ = (q₁ − q₀)/h − (h/2)(V' − F) at the midpoint.
TEST_F(SchemeMultipliers, WithForces) {
  const Solution solution = orbit(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2\"\nforce = { x = \"(1 - x^2)*x'\" }\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nx = \"2*cos(2*pi*t/T)\"\nduration = 6.6\n"
      "[solve]\nscheme = \"midpoint\"\nelements = 40\n");
  const Trajectory& path = solution.trajectory;
  MatrixXd flow = MatrixXd::Identity(2, 2);
  double x, v;
  for (int k = 0; k < path.elements(); ++k) {
    const double h = path.length(k);
    path.in_element(k, 0.5, {&x, 1}, {&v, 1});
    const double by_q = h / 4 * (1 + 2 * x * v),
                 by_v = (1 - x * x) / 2;  // of (h/2)(V' − F), by q₁ and by h q'
    const double from_start = by_q - 1 / h + by_v, from_end = by_q + 1 / h - by_v;  // of p₀
    Matrix2d element;
    element << -from_start / from_end, 1 / from_end, 0, 0;
    const double by_start = -1 / h - by_q - by_v, by_end = 1 / h - by_q + by_v;  // of p₁
    element.row(1) = by_end * element.row(0);
    element(1, 0) += by_start;
    flow = (element * flow).eval();
  }
  expect_eigenvalues(solution, flow);
}

}  // namespace
}  // namespace extremal::test
