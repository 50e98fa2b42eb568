#include "solve/newton/krylov.hpp"

#include <random>

#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/newton/iteration.hpp"
#include "solve/scenes.hpp"

/// \file Steps of the second variation at one path from factors of another.

namespace extremal::laws {
namespace {

struct Case {
  std::string name, text;
  friend void PrintTo(const Case& test, std::ostream* to) { *to << test.name; }
};

class Krylov : public testing::TestWithParam<Case> {};

double greatest_gap(const Step& a, const Step& b, double sign) {
  double most = std::abs(a.duration - sign * b.duration);
  for (std::size_t k = 0; k < a.nodes.size(); ++k)
    most = std::max(most, std::abs(a.nodes[k] - sign * b.nodes[k]));
  return most;
}

TEST_P(Krylov, FindsTheStepOfAnotherPath) {
  const Problem problem = study_of(GetParam().text).problem;
  Levels levels;
  levels.bind(problem.lagrangian);
  const ElementTables& tables = levels.at(6);
  const Values mesh{0, 0.2, 0.45, 0.7, 1};
  Path path;
  path.reset(tables, mesh, problem.duration.value);
  start_path(problem, starting_ends(problem), tables, path);

  const int elements = path.elements();
  DiscreteAction action;
  action.reset(*problem.lagrangian, tables, elements, problem.duration.free);
  action.extend(true);
  const std::unique_ptr<QuadraticModel> model = make_condensed_model();
  model->reset(problem, tables, elements);
  ClosingEquation equation;
  const ClosingEquation* closing = closing_equation(problem, path, equation);
  ASSERT_TRUE(model->evaluate(action, path, closing));

  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-0.05, 0.05);
  for (int k = 1; k < elements; ++k)
    for (int a = 0; a < path.coordinates(); ++a) path.set_node(k, a, path.node(k)[a] + uniform(random));
  path.load_ends();
  model->evaluate_gradient(action, path);
  const std::vector<double> gradient = action.nodes.gradient;
  Step first, solved, taken_back;
  model->solve(action, closing, first);

  // The change of the gradient along a step, solved for, should take the first step back.
  const auto missed = [&](const Step& step) {
    action.put_change(path, {step.nodes, step.inner, step.duration});
    ClosingEquation change = equation;
    change.value = 0;
    const std::size_t n = problem.coordinates(), last = elements * n;
    for (std::size_t e = 0; e < change.row.size(); ++e)
      change.value += change.row[e] * step.nodes[e < n ? e : last + e - n];
    model->solve(action, closing ? &change : nullptr, taken_back);
    return greatest_gap(taken_back, first, -1) / greatest_gap(first, first, 0);
  };
  EXPECT_GT(missed(first), 0.01);
  action.put_gradient(path);
  solved = first;
  refine_by_krylov(action, *model, path, closing, solved);
  EXPECT_EQ(action.nodes.gradient, gradient);
  EXPECT_LT(missed(solved), 0.005);
}

INSTANTIATE_TEST_SUITE_P(
    Ends, Krylov,
    testing::Values(Case{"FixedEnds",
                         "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1, y = 0 }\n"
                         "end = { x = -0.6, y = 0.9 }\nduration = 2.5\n"},
                    Case{"NaturalEnd",
                         "[system]\nuse = \"pendulum\"\nparameters = { g = 1.0 }\n[boundary]\n"
                         "start = { theta = 1 }\nduration = 4\n"},
                    Case{"Energy",
                         "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1, y = 0 }\n"
                         "end = { x = -0.6, y = 0.9 }\nduration = \"free\"\nenergy = -0.4\n"
                         "[guess]\nduration = 2.4\n"},
                    Case{"Condition",
                         "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1, y = 0 }\n"
                         "duration = \"free\"\nwhere = \"x(T) = -0.5\"\n[guess]\nduration = 2\n"
                         "x = \"cos(t)\"\ny = \"sin(t)\"\n"}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace extremal::laws
