#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/newton/iteration.hpp"
#include "solve/scenes.hpp"

/// \file Steps and inertia with 106 bits, where those of double precision have all digits.

namespace extremal::laws {
namespace {

struct SystemAndEnds {
  std::string name, text;
  friend void PrintTo(const SystemAndEnds& test, std::ostream* to) { *to << test.name; }
};

class ExtendedModel : public testing::TestWithParam<SystemAndEnds> {};

TEST_P(ExtendedModel, AgreesWithDoublePrecision) {
  const Problem problem = study_of(GetParam().text).problem;
  Levels levels;
  levels.bind(problem.lagrangian);
  const ElementTables& tables = levels.at(6);
  Path path;
  path.reset(tables, Values{0, 0.2, 0.45, 0.7, 1}, problem.duration.value);
  start_path(problem, starting_ends(problem), tables, path);
  const int elements = path.elements();
  ASSERT_TRUE(extended_model_suits(problem, tables, elements));

  PhaseConditions phases;
  measure_phases(problem, path, tables.scheme(), true, phases);
  ClosingEquation equation;
  const ClosingEquation* const closing = closing_equation(problem, path, equation);
  Step steps[2];
  Inertia inertia[2];
  for (const bool extended : {false, true}) {
    DiscreteAction action;
    action.reset(*problem.lagrangian, tables, elements, problem.duration.free);
    action.give_momenta(problem.boundary.momenta);
    action.extend(extended);
    const auto model = extended ? make_extended_model() : make_condensed_model();
    model->reset(problem, tables, elements);
    model->set_phases(phases.count > 0 ? &phases : nullptr);
    ASSERT_TRUE(model->evaluate(action, path, closing));
    model->solve(action, closing, steps[extended]);
    inertia[extended] = model->inertia(1e-9);
  }
  double size = std::abs(steps[0].duration), gap = std::abs(steps[0].duration - steps[1].duration);
  const auto compare = [&](const auto& a, const auto& b) {
    for (std::size_t k = 0; k < a.size(); ++k) {
      size = std::max(size, std::abs(a[k]));
      gap = std::max(gap, std::abs(a[k] - b[k]));
    }
  };
  compare(steps[0].nodes, steps[1].nodes);
  compare(steps[0].inner, steps[1].inner);
  EXPECT_GT(size, 1e-3);
  EXPECT_LT(gap, 1e-11 * size);
  EXPECT_EQ(inertia[0], inertia[1]);
}

INSTANTIATE_TEST_SUITE_P(
    Ends, ExtendedModel,
    testing::Values(
        SystemAndEnds{"FixedEnds",
                      "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1, y = 0 }\n"
                      "end = { x = -0.6, y = 0.9 }\nduration = 2.5\n"},
        SystemAndEnds{"NaturalEnd",
                      "[system]\nuse = \"pendulum\"\nparameters = { g = 1.0 }\n[boundary]\n"
                      "start = { theta = 1 }\nduration = 4\n"},
        SystemAndEnds{"Energy",
                      "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1, y = 0 }\n"
                      "end = { x = -0.6, y = 0.9 }\nduration = \"free\"\nenergy = -0.4\n"
                      "[guess]\nduration = 2.4\n"},
        SystemAndEnds{"Condition",
                      "[system]\nuse = \"kepler\"\n[boundary]\nstart = { x = 1, y = 0 }\n"
                      "duration = \"free\"\nwhere = \"x(T) = -0.5\"\n[guess]\nduration = 2\n"
                      "x = \"cos(t)\"\ny = \"sin(t)\"\n"},
        SystemAndEnds{"Periodic",
                      "[system]\nuse = \"henon-heiles\"\n[boundary]\nperiodic = true\nduration = 6.5\n"
                      "[guess]\nx = \"0.3*cos(0.966*t)\"\ny = \"0.2*sin(0.966*t)\"\n"},
        SystemAndEnds{"RotatingFrame",
                      "[system]\nuse = \"cr3bp\"\nparameters = { mu = 0.2 }\n[boundary]\n"
                      "start = { x = 0.4, y = 0.5, z = 0 }\nend = { x = -0.1, y = 0.9, z = 0.3 }\n"
                      "duration = 1.2\n"}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace extremal::laws
