#include "study/quantity.hpp"

#include <fmt/format.h>

#include <cmath>

#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// x = a sin(pi t/T) with the stiffness k = (pi/T)²; the straight line between fixed ends for k = 0.
const std::string spring =
    "[system]\ncoordinates = [\"x\", \"q[2]\"]\nparameters = { k = 0.5, c = 2.0 }\n"
    "definitions = { e = \"x'^2/2 + k*x^2/2\" }\n"
    "lagrangian = \"x'^2/2 - k*x^2/2 + c*(q[1]'^2 + q[2]'^2)/2\"\n"
    "[boundary]\nstart = { x = 1, q = [0, 0] }\nend = { x = 2, q = [3, 5] }\nduration = 1\n"
    "[continuation]\nparameter = \"k\"\nto = 1.5\npoints = 8\n";

}  // namespace

class Quantities : public Scenes {
 protected:
  void SetUp() override {
    Scenes::SetUp();
    made = study(spring);
    branch = follow(made);
  }
  std::string refusal(const std::string& formula) {
    try {
      check_quantity(made, formula);
    } catch (const FormulaError& e) {
      return fmt::format("{}: {}", e.offset, e.what());
    }
    return "accepted";
  }
  Study made;
  FollowedBranch branch;
};

TEST_F(Quantities, AreFormulasOfEndValues) {
  const BranchQuantity found = quantity(made, branch, "x'(0) + q[2](T)*c - 1/k");
  EXPECT_EQ(found.name, "x'(0) + q[2](T)*c - 1/k");
  ASSERT_EQ(found.values.size(), branch.points.size());
  ASSERT_GE(found.values.size(), 3u);
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    const double k = branch.points[i].parameter, w = std::sqrt(k);
    // x = cos wt + b sin wt with x(1) = 2
    const double slope = w * (2 - std::cos(w)) / std::sin(w);
    EXPECT_NEAR(found.values[i], slope + 10 - 1 / k, 1e-6);
  }
}

TEST_F(Quantities, HaveDefinitionsAtTheEnds) {
  for (const double value : quantity(made, branch, "e(T) - e(0)").values) EXPECT_NEAR(value, 0, 1e-7);
  for (const double value : quantity(made, branch, "e(0)").values) EXPECT_GT(value, 0.2);
  EXPECT_EQ(refusal("2*e"), "2: write e(0) or e(T): a quantity of a point is a formula of end values");
  EXPECT_EQ(refusal("e'(0)"),
            "0: \"e'\" is the velocity of a definition; only those of coordinates stand here");
}

TEST_F(Quantities, AreNumbersOfThePoint) {
  const std::vector<double> energies = quantity(made, branch, "energy + 0*duration").values;
  const std::vector<double> widths = quantity(made, branch, "2*amplitude").values;
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    EXPECT_EQ(energies[i], *branch.points[i].solution.energy);
    EXPECT_NEAR(widths[i], 5, 1e-9);  // of q[2], which moves most
  }
}

TEST_F(Quantities, ByDefaultTheAmplitudeAgainstAParameter) {
  EXPECT_EQ(quantity(made, branch).name, "amplitude of q[2]");
  const Study timed = study(spring, {"continuation.parameter=duration", "continuation.to=1.2"});
  const FollowedBranch times = follow(timed);
  EXPECT_EQ(quantity(timed, times).name, "energy");
  EXPECT_EQ(quantity(timed, times).values[0], *times.points[0].solution.energy);
}

TEST_F(Quantities, MayHaveNoValueAtSomePoints) {
  for (const double value : quantity(made, branch, "log(x(0) - 2)").values)
    EXPECT_FALSE(std::isfinite(value));
}

TEST_F(Quantities, ThatAreWrong) {
  EXPECT_EQ(refusal("x"), "0: write x(0) or x(T): a quantity of a point is a formula of end values");
  EXPECT_EQ(refusal("2*x(1)"), "2: write x(0) or x(T) for the value at an end");
  EXPECT_EQ(refusal("y(0)").substr(0, 56), "0: unknown function 'y'; end values are x(0), q[1](0); f");
  EXPECT_EQ(refusal("p_x(0)"),
            "0: unknown function 'p_x'; of a point there are coordinates and velocities: x(0), x'(0)");
  EXPECT_EQ(refusal("amplitud"), "0: unknown name 'amplitud'; did you mean 'amplitude'?");
  EXPECT_EQ(refusal("q[2]'(T)"), "accepted");
}
