#include "rivals/almost_block_diagonal.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace extremal {
namespace {

TEST(AlmostBlockDiagonal, AgainstADenseSystem) {
  std::srand(7);
  for (const int count : {1, 2, 5}) {
    for (const int extra : {0, 1}) {
      constexpr int b = 4, y = 3;
      AlmostBlockDiagonal::Blocks blocks;
      for (int k = 0; k < count; ++k) {
        // Growth along the chain, and decay.
        blocks.transition.push_back(10 * Eigen::MatrixXd::Random(b, k == 0 ? y : b));
        if (extra) blocks.extra.push_back(Eigen::VectorXd::Random(b));
      }
      const int rows = y + extra, unknowns = y + b * count + extra;
      blocks.by_first = Eigen::MatrixXd::Random(rows, y);
      blocks.by_last = Eigen::MatrixXd::Random(rows, b);
      if (extra) blocks.by_extra = Eigen::VectorXd::Random(rows);
      Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(unknowns, unknowns);
      for (int k = 0; k < count; ++k) {
        dense.block(k * b, k == 0 ? 0 : y + (k - 1) * b, b, blocks.transition[k].cols()) =
            blocks.transition[k];
        dense.block(k * b, y + k * b, b, b) = -Eigen::MatrixXd::Identity(b, b);
        if (extra) dense.block(k * b, unknowns - 1, b, 1) = blocks.extra[k];
      }
      dense.block(count * b, 0, rows, y) = blocks.by_first;
      dense.block(count * b, y + (count - 1) * b, rows, b) = blocks.by_last;
      if (extra) dense.block(count * b, unknowns - 1, rows, 1) = blocks.by_extra;
      Eigen::VectorXd right(unknowns);
      std::vector<Eigen::VectorXd> parts;
      for (int k = 0; k < count; ++k) parts.push_back(Eigen::VectorXd::Random(b));
      parts.push_back(Eigen::VectorXd::Random(rows));
      for (int k = 0, at = 0; k <= count; at += static_cast<int>(parts[k].size()), ++k)
        right.segment(at, parts[k].size()) = parts[k];
      const Eigen::VectorXd expected = dense.fullPivLu().solve(right);
      for (const bool singular : {false, true}) {
        blocks.may_be_singular = singular;
        AlmostBlockDiagonal system;
        system.factor(blocks);
        const AlmostBlockDiagonal::Solution found = system.solve(parts);
        EXPECT_TRUE(found.finite());
        EXPECT_LT((found.first - expected.head(y)).norm(), 1e-10 * expected.norm());
        for (int k = 0; k < count; ++k)
          EXPECT_LT((found.rest[k] - expected.segment(y + k * b, b)).norm(), 1e-10 * expected.norm());
        if (extra) {
          EXPECT_NEAR(found.extra, expected[unknowns - 1], 1e-10 * expected.norm());
        }
      }
    }
  }
}

}  // namespace
}  // namespace extremal
