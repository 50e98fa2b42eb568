#include <cmath>

#include "scenes.hpp"
#include "study/derivatives.hpp"
#include "study/memory.hpp"

using namespace extremal;
using namespace extremal::test;

TEST_F(Scenes, SolveOptions) {
  const Study s = study(masses + ends + "[solve]\ntolerance = 1e-5\nscheme = \"gauss(3)\"\n");
  EXPECT_EQ(s.options.tolerance, 1e-5);
  EXPECT_EQ(s.options.scheme->name, "gauss(3)");
  EXPECT_EQ(s.options.elements, 0);
  EXPECT_EQ(study(masses + ends + "[solve]\nelements = 7\nscheme = \"midpoint\"\n").options.elements, 7);
  EXPECT_EQ(s.options.method, Method::newton);
  for (const Method method : {Method::ceres, Method::ipopt})
    if (available(method)) {
      EXPECT_EQ(study(masses + ends + "[solve]\nmethod = \"" + name(method) + "\"\n").options.method, method);
    }
  EXPECT_GT(s.seconds_read, 0.0);
  EXPECT_EQ(message(masses + ends + "[solve]\nscheme = \"midpiont\"\n").rfind("scene.toml:11:11: ", 0), 0u);
}

TEST_F(Scenes, UnknownNamesGetASuggestion) {
  std::string misspelt = masses + ends;
  misspelt.replace(misspelt.find("lagrangian"), 10, "lagrangain");
  EXPECT_EQ(message(misspelt),
            "scene.toml:5:1: unknown key 'lagrangain' in [system]; did you mean 'lagrangian'?");
  EXPECT_EQ(message(masses + ends + "[xyzzy]\n"), "scene.toml:10:2: unknown key 'xyzzy'");
}

TEST_F(Scenes, LagrangiansThatAreNotRegular) {
  const auto with = [&](const std::string& lagrangian) {
    return message("[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"" + lagrangian +
                   "\"\n[boundary]\nstart = { x = 0, y = 1 }\nend = { x = 1, y = 2 }\nduration = 2\n");
  };
  const std::string refusal =
      "scene.toml:3:14: the Lagrangian is not regular: its second derivative by the velocities is singular, "
      "so ";
  EXPECT_EQ(with("x'^2/2 - y^2"), refusal + "the momenta do not determine y'");
  EXPECT_EQ(with("(x' + y')^2/2 - y^2").rfind(refusal, 0), 0u);
  EXPECT_EQ(with("sqrt(x'^2 + y'^2)").rfind(refusal, 0), 0u);  // homogeneous: any time law is as good
  EXPECT_EQ(with("x'*y' - y^2"), "");                          // indefinite, but regular
  EXPECT_EQ(with("1e-9*x'^2 + 1e9*y'^2 - y^2"), "");           // units are the user's own
  EXPECT_EQ(with("sqrt(1 + x'^2) + y'^4/12 - y^2"), "");
}

TEST_F(Scenes, DerivativesAgreeWithDifferences) {
  const Study s = study(
      "[system]\ncoordinates = [\"a\", \"b\"]\nparameters = { g = 9.81 }\n"
      "lagrangian = \"a'^2 + b'^2/2 + a'*b'*cos(a - b) + 2*g*cos(a) + g*cos(b)\"\n"
      "[boundary]\nstart = { a = 0, b = 0 }\nend = { a = 1, b = 2 }\nduration = 1\n");
  const DerivativeCheck check = check_derivatives(s.problem);
  EXPECT_EQ(check.points, 5);
  EXPECT_EQ(check.columns, 4);
  EXPECT_TRUE(check.agree());
  EXPECT_LT(check.gradient.error, 1e-10);
  EXPECT_LT(check.hessian.error, 1e-10);
  EXPECT_FALSE(check.hessian.name.empty());
}

namespace {

/// L = q'^2/2 + q^4/4 whose second derivative is wrong by a factor.
class Faulty : public Lagrangian {
 public:
  Faulty() {
    structure_.coordinates = 1;
    structure_.quadratic = structure_.velocity_free = true;
    structure_.mass = {{0, 0, 1.0}};
    structure_.gradient = {0};
    structure_.hessian = {{0, 0}};
  }
  void evaluate(const Points& points, Order order, double* out, Scratch&) const override {
    for (int i = 0; i < points.count; ++i) {
      const double q = points.q[i];
      out[i] = q * q * q * q / 4;
      if (order != Order::value) out[points.stride + i] = q * q * q;
      if (order == Order::hessian) out[2 * points.stride + i] = 3.003 * q * q;
    }
  }
  void sensitivity(const Points&, int, double*, Scratch&) const override {}
};

}  // namespace

TEST(Derivatives, AFaultIsFoundAndNamed) {
  Problem problem;
  problem.lagrangian = std::make_shared<Faulty>();
  problem.names = {"q"};
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 1);
  problem.boundary.fix(0, true, 2);
  problem.duration.value = 1;
  const DerivativeCheck check = check_derivatives(make_problem(problem));
  EXPECT_FALSE(check.agree());
  EXPECT_LT(check.gradient.error, 1e-10);
  EXPECT_EQ(check.hessian.name, "∂²L/∂q∂q");
  EXPECT_NEAR(check.hessian.derivative / check.hessian.difference, 1.001, 1e-8);
}

TEST_F(Scenes, RepeatsReportTheMedianOfTheSameSolution) {
  const Study s = study(masses + ends);
  EXPECT_THROW(run(s, 0), std::invalid_argument);
  const Solution once = run(s), often = run(s, 3);
  EXPECT_TRUE(once.converged());
  EXPECT_EQ(once.action, often.action);
  EXPECT_GT(often.seconds_solve, 0.0);
}

TEST(Memory, SolveIsLinearInElementsAndRefusedBeyondWhatThereIs) {
  Structure few, many;
  few.coordinates = 10;
  many.coordinates = 10000;
  many.mass.resize(10000);
  many.hessian.resize(20000);
  EXPECT_GT(solve_bytes(few, 80, 4), 80 * 50 * 50 * 8.0);
  EXPECT_NEAR(solve_bytes(few, 160000, 2) / solve_bytes(few, 80000, 2), 2.0, 1e-3);
  EXPECT_LT(solve_bytes(many, 8, 4), 2e9);  // sparse: far from (50,000)² entries an element
  EXPECT_GT(available_bytes(), 1e6);
  EXPECT_EQ(byte_text(3.25e9), "3.25 GB");
  EXPECT_EQ(byte_text(12), "12 B");
}

TEST_F(Scenes, WhatDoesNotFitIntoMemoryIsRefused) {
  const Study s = study(
      "[system]\ncoordinates = [\"q[1000]\"]\nlagrangian = \"sum(i, 1, 1000, q[i]'^2/2 - "
      "q[i]^2/2)\"\n[boundary]\nduration = 1\n"
      "[solve]\nscheme = \"lobatto(8)\"\nelements = 100000000\n");
  try {
    run(s);
    FAIL();
  } catch (const std::length_error& e) {
    const double needed = solve_bytes(s.system.lagrangian->structure(), 100000000, 8);
    EXPECT_GT(needed, 1e15);
    EXPECT_EQ(e.what(), s.scene + ": 1000 coordinates and 100000000 elements of degree 8 need " +
                            byte_text(needed) + " of memory; " + byte_text(available_bytes()) +
                            " are available");
  }
}
