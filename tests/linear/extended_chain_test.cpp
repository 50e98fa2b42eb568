#include "linear/extended_chain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

namespace extremal {
namespace {

/// Random blocks, the first of which is nearly singular: eliminated alone it would leave no digits of
/// doubles.
ExtendedChain random_chain(int blocks, int size, double first) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ExtendedChain chain;
  chain.reset(blocks, size);
  for (int k = 0; k < blocks; ++k)
    for (int i = 0; i < size; ++i) {
      const std::size_t row = static_cast<std::size_t>(k) * size + i;
      for (int j = 0; j <= i; ++j) {
        const TwoDoubles entry{uniform(random) * (k == 0 ? first : 1), 0x1p-60 * uniform(random) * first};
        chain.diagonal().set(row, j, entry);
        chain.diagonal().set(row - i + j, i, entry);
      }
      for (int j = 0; j < size && k + 1 < blocks; ++j)
        chain.lower().set(row, j, {uniform(random), 0x1p-60 * uniform(random)});
    }
  return chain;
}

/// b − A x.
ExtendedRows residual(const ExtendedChain& chain, const ExtendedRows& b, const ExtendedRows& x) {
  const std::size_t n = chain.size(), columns = x.columns();
  ExtendedRows rest = b;
  const auto take = [&](std::size_t row, std::size_t column, TwoDoubles entry) {
    rest.add_scaled(columns, {-entry.high, -entry.low}, x.high(column), x.low(column), row);
  };
  for (std::size_t row = 0; row < chain.order(); ++row) {
    const std::size_t first = row / n * n;
    for (std::size_t j = 0; j < n; ++j) take(row, first + j, chain.diagonal().at(row, j));
    for (std::size_t j = 0; j < n && first + n < chain.order(); ++j) {
      const TwoDoubles entry = chain.lower().at(row, j);
      take(row + n, first + j, entry);
      take(first + j, row + n, entry);
    }
  }
  return rest;
}

TEST(ExtendedChain, SolvesWithThirtyDigits) {
  for (const int size : {1, 2, 3, 6, 7})
    for (const int blocks : {1, 2, 5, 40})
      for (const double first : {1.0, 1e-9}) {
        ExtendedChain chain = random_chain(blocks, size, first);
        ASSERT_TRUE(chain.factor());
        ExtendedRows b;
        b.reset(chain.order(), 3);
        for (std::size_t i = 0; i < chain.order(); ++i)
          for (std::size_t c = 0; c < 3; ++c) b.set(i, c, {std::sin(1.0 + i + 7.0 * c), 0x1p-60});
        ExtendedRows x = b;
        chain.solve(x);
        double most = 0, largest = 0;
        const ExtendedRows rest = residual(chain, b, x);
        for (std::size_t i = 0; i < chain.order(); ++i)
          for (std::size_t c = 0; c < 3; ++c) {
            most = std::max(most, std::abs(rest.at(i, c).high));
            largest = std::max(largest, std::abs(x.at(i, c).high));
          }
        EXPECT_LT(most, 1e-28 * (1 + largest)) << size << " " << blocks << " " << first;
      }
}

TEST(ExtendedChain, CountsSigns) {
  for (const int size : {1, 3, 6}) {
    const int blocks = 9;
    const ExtendedChain chain = random_chain(blocks, size, 1);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(chain.order(), chain.order());
    for (int k = 0; k < blocks; ++k)
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) {
          const int row = k * size + i, first = k * size;
          dense(row, first + j) = chain.diagonal().at(row, j).high;
          if (k + 1 == blocks) continue;
          dense(row + size, first + j) = dense(first + j, row + size) = chain.lower().at(row, j).high;
        }
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    EXPECT_EQ(chain.inertia().negative, (values.array() < 0).count()) << size;
    EXPECT_EQ(chain.inertia().positive, (values.array() > 0).count()) << size;
  }
}

TEST(ExtendedChain, SaysThatItIsSingular) {
  ExtendedChain chain;
  chain.reset(3, 2);
  EXPECT_FALSE(chain.factor());
}

}  // namespace
}  // namespace extremal
