#include <cmath>

#include "scenes.hpp"
#include "study/checks/derivatives.hpp"
#include "study/checks/memory.hpp"

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
  EXPECT_EQ(message(masses + ends + "[xyzzy]\n"),
            "scene.toml:10:2: unknown key 'xyzzy'; there are 'title', 'system', 'boundary', 'waypoints', "
            "'guess', 'solve', 'search', 'continuation', 'spectrum', 'units', 'fit', 'path'");
}

TEST_F(Scenes, ChoicesAreListedWhereNoneIsNear) {
  const std::string scene = masses + ends;  // 9 lines
  EXPECT_EQ(message(scene + "[solve]\nmethod = \"bfgs\"\n"),
            "scene.toml:11:11: unknown method 'bfgs'; there are 'newton', 'ceres', 'ipopt'");
  EXPECT_EQ(message(scene + "[solve]\nmethod = \"Newton\"\n"),
            "scene.toml:11:11: unknown method 'Newton'; did you mean 'newton'?");
  EXPECT_EQ(message(scene + "[solve]\ntol = 1e-6\n"),
            "scene.toml:11:1: unknown key 'tol' in [solve]; did you mean 'tolerance'?");
  EXPECT_EQ(message(scene + "[fit]\ndata = \"d.csv\"\nloss = \"l1\"\n"),
            "scene.toml:12:9: unknown loss 'l1'; there are 'squared', 'huber', 'cauchy'");
  EXPECT_EQ(message(scene + "[continuation]\nparameter = \"k\"\nfrom = 1\nto = 2\n"),
            "scene.toml:12:1: unknown key 'from' in [continuation]; there are 'parameter', 'to', 'points', "
            "'switch'");
  EXPECT_EQ(message(scene + "[path]\nwithin = []\n"),
            "scene.toml:11:1: unknown key 'within' in [path]; there is 'constraints'");
  std::string begin = scene;
  begin.replace(begin.find("start"), 5, "depart");
  EXPECT_EQ(message(begin),
            "scene.toml:7:1: unknown key 'depart' in [boundary]; there are 'start', 'end', 'duration', "
            "'energy', 'where', 'periodic', 'map', 'conditions', 'integrals', 'unknowns'");
}

TEST_F(Scenes, WordsBesideNumbersAreSuggested) {
  const auto lasting = [&](const std::string& duration) {
    return message(masses + "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = " + duration + "\n");
  };
  EXPECT_EQ(lasting("\"infinity\""), "scene.toml:9:13: unknown name 'infinity'; did you mean 'infinite'?");
  EXPECT_EQ(lasting("\"inf\""), "scene.toml:9:13: unknown name 'inf'; did you mean 'infinite'?");
  EXPECT_EQ(lasting("inf"),
            "scene.toml:9:12: 'duration' in [boundary] must be finite, found inf; did you mean 'infinite'?");
  EXPECT_EQ(lasting("nan"), "scene.toml:9:12: 'duration' in [boundary] must be finite, found nan");
  EXPECT_EQ(lasting("\"Free\""), "scene.toml:9:13: unknown name 'Free'; did you mean 'free'?");
  EXPECT_EQ(lasting("\"1 s\""),
            "scene.toml:9:15: unexpected 's'; write '*' to multiply, and numbers without units");
  EXPECT_EQ(lasting("\"k\""), "");
  EXPECT_EQ(
      message(masses + ends, {"system.parameters.fr=2", "system.parameters.ee=1", "boundary.duration=fr*ee"}),
      "");
  const auto at = [&](const std::string& time) {
    return message(masses + ends + "[[waypoints]]\nat = " + time + "\nx = 0.2\n");
  };
  EXPECT_EQ(at("\"fre\""), "scene.toml:11:7: unknown name 'fre'; did you mean 'free'?");
  EXPECT_EQ(at("\"mid\""),  // min is a function
            "scene.toml:11:7: unknown name 'mid'; is it a parameter that is not declared? Declared: k, m");
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
  EXPECT_EQ(
      with("sqrt(x'^2 + y'^2)"),  // any time law is as good
      "scene.toml:3:14: the Lagrangian is homogeneous of degree one in the velocities: it determines the "
      "path, but not the speed along it; take L^2/2, whose extremals are the same curves");
  EXPECT_EQ(with("x'*y' - y^2"), "");                 // indefinite, but regular
  EXPECT_EQ(with("1e-9*x'^2 + 1e9*y'^2 - y^2"), "");  // units are the user's own
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

TEST_F(Scenes, WhatDoesNotFitIntoMemoryIsRefusedWhenItIsRead) {
  const std::string chain =
      "[system]\ncoordinates = [\"q[1000]\"]\nlagrangian = \"sum(i, 1, 1000, q[i]'^2/2 - "
      "q[i]^2/2)\"\n[boundary]\nduration = 1\n[solve]\nscheme = \"lobatto(8)\"\n";
  const double needed = solve_bytes(study(chain).system.lagrangian->structure(), 100000000, 8);
  EXPECT_GT(needed, 1e15);
  EXPECT_EQ(message(chain + "elements = 100000000\n"),
            "scene.toml:8:12: 1000 coordinates and 100000000 elements of degree 8 need " + byte_text(needed) +
                " of memory; " + byte_text(available_bytes()) + " are available; lower 'elements'");
}

TEST_F(Scenes, DifferencesFollowFunctionsOfAnyScale) {
  const auto product = [](const std::string& factor, int count) {
    std::string text = factor;
    for (int k = 1; k < count; ++k) text += "*" + factor;
    return text;
  };
  const std::string boundary = "[boundary]\nstart = { x = 0.9 }\nend = { x = 1.1 }\nduration = 1\n";
  for (const std::string& potential :
       {product("x", 100), product("x", 1000), product("x", 10000), product("(1 + sin(x)/100)", 10000),
        std::string("sum(k, 1, 10000, sin(k*x))"), std::string("1e20*x^2"),
        std::string("exp(1e4*x - 1e4)")}) {
    const Study s =
        study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - " + potential + "\"\n" + boundary);
    const DerivativeCheck check = check_derivatives(s.problem);
    EXPECT_TRUE(check.agree()) << potential.substr(0, 20) << " " << check.gradient.error << " "
                               << check.hessian.error;
  }
}

TEST_F(Scenes, TheBudgetIsPositiveAndEndsWhatDoesNotConverge) {
  EXPECT_EQ(Study{}.budget, 60);
  EXPECT_EQ(study(masses + ends, {"solve.budget=0.5"}).budget, 0.5);
  EXPECT_EQ(message(masses + ends + "[solve]\nbudget = 0\n"),
            "scene.toml:11:10: budget = 0; need more than 0 seconds");
  Study s = study(
      "[system]\ncoordinates = [\"q\"]\nlagrangian = \"q'^2/2 + cos(q)\"\n[boundary]\n"
      "start = { q = 0 }\nend = { q = 3 }\nduration = 60\n");
  s.options.deadline = Deadline(0);
  while (!s.options.deadline.passed()) {
  }
  const Solution solution = run(s);
  EXPECT_EQ(solution.status, Status::iteration_limit);
  EXPECT_EQ(solution.message.rfind("the budget of 0 s (solve.budget) is spent, in Newton steps: ", 0), 0u)
      << solution.message;
}

/// So many coupled coordinates that the factors are those of one sparse matrix: asked before and within.
TEST_F(Scenes, TheBudgetIsKeptByManyCoupledCoordinates) {
  LONG_TEST();
  Study s = study(
      "[system]\ncoordinates = [\"q[180]\"]\nlagrangian = \"sum(i, 1, 180, q[i]'^2/2) - sum(i, 1, 180, "
      "sum(j, 1, 180, (q[j] - q[i])^2/360))\"\n[boundary]\nstart = { q = \"sin(i)\" }\n"
      "end = { q = \"cos(i)\" }\nduration = 1\n");
  for (int last : {0, 3, 20, 100}) {
    s.options.deadline =
        Deadline().or_stopped([](void* left) { return --*static_cast<int*>(left) < 0; }, &last);
    const Solution solution = run(s);
    EXPECT_EQ(solution.status, Status::iteration_limit) << solution.message;
    EXPECT_NE(solution.message.find("(solve.budget) is spent"), std::string::npos) << solution.message;
  }
  s.options.deadline = {};
  const Solution whole = run(s);
  EXPECT_TRUE(whole.converged()) << whole.message;
}

TEST_F(Scenes, KnowTheFilesThatTheyWereReadFrom) {
  write("used.toml", "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n");
  write("guess.csv", "t,x\n0,0\n2,1\n");
  const Study s = study("[system]\nuse = \"used\"\n" + ends + "[guess]\nfile = \"guess.csv\"\n");
  ASSERT_EQ(s.files.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(fs::path(s.files[k]).filename(),
              (std::vector<fs::path>{"scene.toml", "used.toml", "guess.csv"})[k]);
}
