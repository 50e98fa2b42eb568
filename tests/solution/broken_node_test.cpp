#include "solution/broken_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "system/tape.hpp"

namespace extremal {
namespace {

/// Straight pieces of length one with these velocities, as one coordinate or two copies of it.
Trajectory pieces(const std::vector<double>& velocities, int copies = 1) {
  Trajectory trajectory{copies, 1, {0}, {}};
  double q = 0;
  for (const double v : velocities) {
    trajectory.nodes.insert(trajectory.nodes.end(), copies, q);
    trajectory.nodes.insert(trajectory.nodes.end(), copies, q += v);
    trajectory.times.push_back(trajectory.times.back() + 1);
  }
  return trajectory;
}

/// p = v³ − v, E = ¾v⁴ − ½v² − ¼.
template <class Number>
Number two_wells(Number v) {
  return (v * v - 1.0) * (v * v - 1.0) / 4.0;
}

std::shared_ptr<const Lagrangian> wells() {
  return trace(1, [](auto, auto v, auto) { return two_wells(v[0]); });
}

TEST(BrokenNode, MomentumIsContinuousAndEnergyIsNot) {
  // p = 0 at v = 0 and v = 1, where E = −1/4 and 0.
  const std::optional<BrokenNode> found = find_broken_node(*wells(), pieces({1, 1, 0}), false);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, 2);
  EXPECT_NEAR(found->velocity, 1, 1e-15);
  EXPECT_NEAR(found->energy, -0.25, 1e-15);
  EXPECT_NE(describe(*found).find("the velocity jumps by 1 at t = 2, and with it the energy by 0.25"),
            std::string::npos);
}

TEST(BrokenNode, WeierstrassAndErdmannAllowOneCorner) {
  EXPECT_FALSE(find_broken_node(*wells(), pieces({1, -1, 1}), false));
}

TEST(BrokenNode, CoarseElementsOfAConvexOrConcaveLagrangianAreNotBroken) {
  EXPECT_FALSE(find_broken_node(*wells(), pieces({0.7, 1.1, 2, 5}), false));       // convex beyond 1/√3
  EXPECT_FALSE(find_broken_node(*wells(), pieces({-0.5, 0.1, 0.5, 0.2}), false));  // concave before
  const auto relativistic = trace(1, [](auto, auto v, auto) { return -sqrt(1.0 - v[0] * v[0]); });
  EXPECT_FALSE(find_broken_node(*relativistic, pieces({-0.99, 0.9, 0.999}), false));
}

TEST(BrokenNode, NodesOfOtherElementsAreNotLookedAt) {
  const Trajectory path = pieces({1, 1, 0, 0, 0});
  EXPECT_FALSE(find_broken_node(*wells(), path, false, 0, 2));
  EXPECT_FALSE(find_broken_node(*wells(), path, false, 2, 5));
  EXPECT_TRUE(find_broken_node(*wells(), path, false, 1, 3));
}

TEST(BrokenNode, WhereAPathCloses) {
  const ClosingMap turned{-Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Zero(1)},
      same{Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Zero(1)};
  const Trajectory there = pieces({1, 1, 1}), back = pieces({-1, -0.9, -0.8, -1});
  EXPECT_FALSE(find_broken_node(*wells(), there, false, 0, 3, &same));
  EXPECT_FALSE(find_broken_node(*wells(), there, false, 0, 3, &turned));  // 1, −1: as Weierstrass allows
  EXPECT_FALSE(find_broken_node(*wells(), back, false, 0, 4, &same));
  const Trajectory rests = pieces({0, 0.1, 0.2, 0.4, 0.55, 0.75, 1});
  EXPECT_FALSE(find_broken_node(*wells(), rests, false));
  const std::optional<BrokenNode> found = find_broken_node(*wells(), rests, false, 0, 7, &same);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, 7);
  EXPECT_NEAR(found->energy, -0.25, 1e-15);
}

/// Their Lagrangian vanishes wherever they agree, and its energy too.
TEST(BrokenNode, OfTwoCopies) {
  const auto pair = trace(2, [](auto, auto v, auto) { return two_wells(v[0]) - two_wells(v[1]); });
  const std::optional<BrokenNode> found = find_broken_node(*pair, pieces({1, 1, 0}, 2), true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->energy, -0.25, 1e-15);
  EXPECT_FALSE(find_broken_node(*pair, pieces({1, -1, 1.2}, 2), true));
}

}  // namespace
}  // namespace extremal
