#include "analysis/falling_form.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/independent.hpp"
#include "analysis/variation.hpp"

/// \file Forms that fall with time: where they are singular, and those of parts of a trajectory.

namespace extremal::laws {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The image of a diagonal matrix under a reflection.
MatrixXd reflected(const VectorXd& diagonal) {
  VectorXd across(diagonal.size());
  for (Eigen::Index i = 0; i < across.size(); ++i) across[i] = std::cos(3.0 * i * i);
  across.normalize();
  const MatrixXd mirror = MatrixXd::Identity(across.size(), across.size()) - 2 * across * across.transpose();
  return mirror * diagonal.asDiagonal() * mirror;
}

/// The value at the end is not sampled again.
TEST(FallingForm, IsSampledInside) {
  const std::span<const double> points = FallingForm::points();
  ASSERT_EQ(points.size(), limits::falling_form::form_samples);
  EXPECT_GT(points.front(), 0);
  EXPECT_LT(points.back(), 1);
}

/// ω cot(ωτ) is zero at π/2ω. Every fifth frequency is that before it.
TEST(FallingForm, ZerosOfACotangent) {
  for (const int n : {10, 12, 60, 130}) {
    VectorXd omega(n);
    std::vector<double> times;
    for (int i = 0; i < n; ++i) {
      omega[i] = 0.3 + 1.6 * ((i % 5 == 4 ? i - 1 : i) + 0.5) / n;
      if (const double t = std::numbers::pi / (2 * omega[i]); t < 1) times.push_back(t);
    }
    std::ranges::sort(times);
    const auto at = [&](double t) { return reflected((omega.array() * t).tan().inverse() * omega.array()); };
    std::vector<MatrixXd> samples;
    for (const double t : FallingForm::points()) samples.push_back(at(t));
    const auto form = FallingForm::of(0, 1, 0, samples, at(1));
    ASSERT_TRUE(form.has_value()) << n;
    const auto zeros = form->zeros(static_cast<int>(times.size()), false);
    ASSERT_TRUE(zeros.has_value()) << n;
    ASSERT_EQ(zeros->size(), times.size()) << n;
    for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR((*zeros)[k], times[k], 1e-11) << n << ' ' << k;
    const auto first = form->zeros(static_cast<int>(times.size()), true);
    ASSERT_TRUE(first.has_value() && first->size() == 1) << n;
    EXPECT_NEAR(first->front(), times.front(), 1e-11) << n;
  }
}

/// Parts that are evaluated side by side do not meet: each has an end of its own, and V'' differs there.
TEST(SecondVariation, FormsOfPartsAreThoseOfEachAlone) {
  const Problem problem = fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 1);
  const Solution s = solve(problem, within(1e-10));
  ASSERT_TRUE(s.converged()) << s.message;
  SecondVariation variation;
  ASSERT_TRUE(variation.assemble(problem.lagrangian, s.trajectory));
  const std::vector<double> parts = {0.2, 0.35, 0.5, 0.8, 1};
  for (int k = 0; k < variation.count(); ++k) {
    const std::vector<MatrixXd> together = variation.start_forms(k, parts);
    for (std::size_t j = 0; j < parts.size(); ++j) {
      const MatrixXd alone = variation.start_forms(k, {&parts[j], 1})[0];
      EXPECT_LT((together[j] - alone).norm(), 1e-13 * alone.norm()) << k << ' ' << parts[j];
    }
    variation.hold(k);
    const MatrixXd whole = variation.piece(k).a;
    EXPECT_LT((together.back() - whole).norm(), 1e-12 * whole.norm()) << k;
  }
}

}  // namespace
}  // namespace extremal::laws
