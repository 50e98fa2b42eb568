#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "machine/long_test.hpp"
#include "solve/branch/bifurcation_equations.hpp"
#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Branch points at which several branches begin, against closed forms.

namespace extremal::laws {
namespace {

/// From rest at both ends of a time of length one, along a.
Study springs(const std::string& coordinates, const std::string& potential) {
  std::string ends;
  for (const char name : {'x', 'y', 'z'})
    if (coordinates.find(name) != std::string::npos)
      ends += fmt::format("{}{} = 0", ends.empty() ? "" : ", ", name);
  return study_of("[system]\ncoordinates = [" + coordinates + "]\nparameters = { a = 5 }\nlagrangian = \"" +
                  potential + "\"\n[boundary]\nstart = { " + ends + " }\nend = { " + ends +
                  " }\nduration = 1\n[continuation]\nparameter = \"a\"\nto = 15\nswitch = true\n");
}

/// What kinds of branches there are: the slopes of their last points at the start, by those that single
/// coordinates have.
std::multiset<std::vector<int>> shares(const FollowedBranch& found, const std::vector<double>& slopes) {
  std::multiset<std::vector<int>> kinds;
  for (std::size_t branch = 1; branch < found.branches.size(); ++branch) {
    EXPECT_EQ(found.branches[branch].end, BranchEnd::target) << found.branches[branch].message;
    const auto last =
        std::ranges::find_if(found.points.rbegin(), found.points.rend(),
                             [&](const BranchPoint& p) { return p.branch == static_cast<int>(branch); });
    if (last == found.points.rend()) continue;
    std::vector<int> kind;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double share = start_of(*last).v[i] / slopes[i];
      EXPECT_NEAR(share, std::round(share), 1e-7);
      kind.push_back(static_cast<int>(std::round(share)));
    }
    kinds.insert(kind);
  }
  return kinds;
}

/// x'' = −a x + 4c x³ is solved by x = A sn(ωt; k) with ω = 2K(k), a = ω²(1 + k²) and 2c A² = k² ω². The
/// slope at the start where a = 15.
double slope_of_spring(double c) {
  double low = 0, high = 1;
  const auto rate = [](double k) { return 2 * std::comp_ellint_1(k); };
  for (int i = 0; i < 60; ++i) {
    const double k = (low + high) / 2;
    (rate(k) * rate(k) * (1 + k * k) < 15 ? low : high) = k;
  }
  return low * rate(low) * rate(low) / std::sqrt(2 * c);
}

using Kinds = std::multiset<std::vector<int>>;

/// How many coordinates move, on how many branches.
std::map<int, int> moving(const Kinds& kinds) {
  std::map<int, int> counts;
  for (const std::vector<int>& kind : kinds)
    ++counts[static_cast<int>(kind.size() - std::ranges::count(kind, 0))];
  return counts;
}

/// Springs that are not coupled swing each alone, or several at once; of these mirror images are one.
TEST(OtherBranches, OfTwoSprings) {
  const FollowedBranch found =
      extremal::follow(springs("\"x\", \"y\"", "(x'^2 + y'^2)/2 - a*(x^2 + y^2)/2 + x^4/8 + y^4/10"));
  const Kinds kinds = shares(found, {slope_of_spring(1.0 / 8), slope_of_spring(1.0 / 10)});
  EXPECT_EQ(kinds.size(), 6u);
  for (const std::vector<int>& kind : {std::vector{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    EXPECT_EQ(kinds.count(kind), 1u);
  EXPECT_EQ(moving(kinds)[2], 2);
  // Each that does not swing is a maximum.
  for (const BranchPoint& point : found.points)
    if (point.branch > 0 && point.kind == PointKind::regular) {
      const State start = start_of(point);
      EXPECT_EQ(point.solution.morse_index, std::abs(start.v[0] * start.v[1]) > 1e-9 ? 0 : 1);
    }
}

TEST(OtherBranches, OfThreeSprings) {
  LONG_TEST();
  const FollowedBranch found =
      extremal::follow(springs("\"x\", \"y\", \"z\"",
                               "(x'^2 + y'^2 + z'^2)/2 - a*(x^2 + y^2 + z^2)/2 + x^4/8 + "
                               "y^4/10 + z^4/14"));
  const Kinds kinds =
      shares(found, {slope_of_spring(1.0 / 8), slope_of_spring(1.0 / 10), slope_of_spring(1.0 / 14)});
  EXPECT_EQ(moving(kinds), (std::map<int, int>{{1, 6}, {2, 6}, {3, 2}}));
}

/// x'' = −a x + 3c x², on both sides of the point: of two springs with c and d, y = x c/d.
TEST(OtherBranches, OnBothSides) {
  const FollowedBranch found =
      extremal::follow(springs("\"x\", \"y\"", "(x'^2 + y'^2)/2 - a*(x^2 + y^2)/2 + x^3/8 + y^3/10"));
  ASSERT_EQ(found.branches.size(), 7u);
  std::map<int, int> counts;
  for (int branch = 1; branch < 7; ++branch)
    for (const BranchPoint& point : found.points) {
      if (point.branch != branch) continue;
      const State start = start_of(point);
      const double x = start.v[0], y = start.v[1], size = std::max(std::abs(x), std::abs(y));
      const bool alone = std::min(std::abs(x), std::abs(y)) < 1e-8 * size;
      EXPECT_TRUE(alone || std::abs(y / x - 1.25) < 1e-7) << y / x;
      counts[branch] |= alone ? 1 : 2;
    }
  EXPECT_EQ(std::ranges::count_if(counts, [](const auto& each) { return each.second == 1; }), 4);
  EXPECT_EQ(std::ranges::count_if(counts, [](const auto& each) { return each.second == 2; }), 2);
}

/// What the bifurcation equations of the square's symmetry give: a b + b³ and 2 b b'² more of each have the
/// axes and the diagonals.
TEST(OtherBranches, EquationsOfASquare) {
  const auto forces = [](const Departure& at) -> std::optional<Eigen::VectorXd> {
    const double x = at.across[0], y = at.across[1];
    return Eigen::Vector2d(-at.along * x + x * x * x + 2 * x * y * y,
                           -at.along * y + y * y * y + 2 * y * x * x);
  };
  const auto equations = BifurcationEquations::measure(2, 0.01, forces);
  ASSERT_TRUE(equations);
  const std::vector<Departure> found = equations->solutions();
  ASSERT_EQ(found.size(), 8u);
  for (const Departure& each : found) {
    const double x = each.across[0] / 0.01, y = each.across[1] / 0.01;
    EXPECT_NEAR(x * y * (x * x - y * y), 0, 1e-7);
    EXPECT_NEAR(each.along / 1e-4, x * x * y * y > 0.1 ? 1.5 : 1, 1e-7);
    EXPECT_NEAR(equations->potential(each), -each.along * 1e-4 / 4, 1e-12);
  }
}

}  // namespace
}  // namespace extremal::laws
