#include <fmt/format.h>

#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Families in quartic potentials, which turn so quickly that a long step ends on another branch with
/// nearly the same tangent. Where they lead was found by 149 solves from one value to the next, each from the
/// orbit before: the period, the action and the index change by little from one to the next.

namespace extremal::laws {
namespace {

struct Quartic {
  std::string potential;
  double energy;  ///< to which the family is followed
  double period, action;
};

TEST(Leaps, NoneOntoOtherBranches) {
  for (const Quartic& each :
       {Quartic{"(x^2 + 3.3171*y^2)/2 + 0.2315*x^3 + 0.4141*x^2*y - 0.4627*x*y^2 - 0.4956*y^3 + 1.2869*x^4 + "
                "0.663*y^4 - 0.6067*x^2*y^2",
                0.759660850556, 3.681495, 0.447901},
        {"(x^2 + 1.6068*y^2)/2 - 0.0254*x^3 + 0.1575*x^2*y + 0.1664*x*y^2 - 0.3574*y^3 + 1.2783*x^4 + "
         "0.5505*y^4 - 0.4519*x^2*y^2",
         0.112644723997, 5.062473, 0.048197},
        {"(x^2 + 2.2973*y^2)/2 + 0.1116*x^3 - 0.2752*x^2*y - 0.4836*x*y^2 - 0.1506*y^3 + 0.8373*x^4 + "
         "0.9324*y^4 - 0.8189*x^2*y^2",
         0.330148, 4.638557, 0.164514}}) {
    const FollowedBranch found = follow(study_of(fmt::format(
        "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2 - ({})\"\n[boundary]\n"
        "periodic = true\nduration = \"free\"\nenergy = 0.02\n[guess]\nx = \"0.2*cos(2*pi*t/T)\"\ny = \"0\"\n"
        "duration = 6.28\n[continuation]\nparameter = \"energy\"\nto = {}\npoints = 80\n",
        each.potential, each.energy)));
    ASSERT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
    const Solution& last = found.points.back().solution;
    EXPECT_NEAR(last.duration(), each.period, 2e-6);
    EXPECT_NEAR(last.action, each.action, 1e-6);
    EXPECT_EQ(last.morse_index, 5);
  }
}

}  // namespace
}  // namespace extremal::laws
