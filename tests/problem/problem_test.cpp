#include "problem/problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace extremal {
namespace {

class Named final : public Lagrangian {
 public:
  explicit Named(int coordinates, bool autonomous = true) {
    structure_.coordinates = coordinates;
    structure_.autonomous = autonomous;
  }
  void evaluate(const Points&, Order, double*, Scratch&) const override {}
  void sensitivity(const Points&, int, double*, Scratch&) const override {}
};

Problem example() {
  Problem problem;
  problem.lagrangian = std::make_shared<Named>(1);
  problem.names = {"x"};
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 1);
  problem.boundary.fix(0, true, 2);
  problem.duration.value = 2.5;
  return problem;
}

std::string refusal(Problem problem) {
  try {
    make_problem(std::move(problem));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Problem, EndsAreSolved) {
  const Problem problem = make_problem(example());
  EXPECT_EQ(problem.ends.offset, (std::vector<double>{1, 2}));
}

TEST(Problem, DimensionsMustAgree) {
  Problem problem = example();
  problem.lagrangian = std::make_shared<Named>(2);
  EXPECT_EQ(refusal(problem), "the boundary relation has 1 coordinates, the Lagrangian 2");
  problem.lagrangian = nullptr;
  EXPECT_EQ(refusal(problem), "the problem has no Lagrangian");
  problem = example();
  problem.names = {"x", "y"};
  EXPECT_EQ(refusal(problem), "2 names for 1 coordinates");
  problem = example();
  problem.boundary.add(problem.boundary.add_row(0), 0, 1.0);
  EXPECT_EQ(refusal(problem), "3 boundary conditions for 1 coordinates; at most 2 can hold");
  problem = example();
  problem.periodic = true;
  EXPECT_EQ(refusal(problem),
            "a periodic problem of 1 coordinates has 2 boundary conditions; need one for each coordinate");
}

TEST(Problem, DurationsMustBePositiveAndClosedOnce) {
  Problem problem = example();
  problem.duration.value = -1;
  EXPECT_EQ(refusal(problem), "duration = -1; need a positive number");
  problem.duration.value = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(problem), "duration = inf; need a positive number");
  problem = example();
  problem.duration.energy = -0.5;
  EXPECT_EQ(refusal(problem), "the duration is fixed at 2.5; energy or where need a free duration");
  problem.duration.free = true;
  EXPECT_EQ(refusal(problem), "accepted");
  problem.duration.where = [](auto, auto, auto) { return 0.0; };
  EXPECT_EQ(refusal(problem), "a free duration needs exactly one of energy, where; 2 given");
  problem.duration.energy.reset();
  EXPECT_EQ(refusal(problem), "accepted");
  problem.lagrangian = std::make_shared<Named>(1, false);
  EXPECT_EQ(refusal(problem), "a free duration needs a Lagrangian that does not depend on t");
  problem.duration.where = nullptr;
  EXPECT_EQ(refusal(problem), "a free duration needs exactly one of energy, where; 0 given");
}

TEST(Problem, GuessesMustCoverTheDurationAndBeFinite) {
  Problem problem = example();
  problem.guess = {{0, 0.5, 1}, {1, 2, 3}};
  EXPECT_EQ(refusal(problem), "accepted");
  problem.guess.q.pop_back();
  EXPECT_EQ(refusal(problem), "the guess has 2 values for 3 times of 1 coordinates");
  problem.guess.q.push_back(std::nan(""));
  EXPECT_EQ(refusal(problem), "the guess is nan in coordinate 1 at t/T = 1");
  problem.guess = {{0, 0.5, 0.5, 1}, {1, 2, 3, 4}};
  EXPECT_EQ(refusal(problem), "times 2 and 3 of the guess, 0.5 and 0.5, do not ascend");
  problem.guess = {{0, 0.9}, {1, 2}};
  EXPECT_EQ(refusal(problem), "the guess runs from 0 to 0.9 of T; need 0 to 1");
  problem.guess = {{0}, {1}};
  EXPECT_EQ(refusal(problem), "the guess has 1 samples; need at least 2");
  problem.guess = {{}, {1}};
  EXPECT_EQ(refusal(problem), "the guess has 1 values and no times");
}

TEST(Problem, ContradictionsPassThrough) {
  Problem problem = example();
  problem.boundary = {};
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 1);
  problem.boundary.fix(0, false, 2);
  EXPECT_THROW(make_problem(problem), RelationError);
}

Guess sampled(std::vector<double> tau, double (*f)(double)) {
  Guess guess{std::move(tau), {}};
  for (const double t : guess.tau) {
    guess.q.push_back(f(t));
    guess.q.push_back(-2 * f(t));
  }
  return guess;
}

TEST(Guess, ReproducesCubicsAndItsSamples) {
  const auto cubic = [](double t) { return 1 - 2 * t + 3 * t * t - 4 * t * t * t; };
  const Guess guess = sampled({0, 0.07, 0.3, 0.31, 0.6, 0.95, 1}, cubic);
  std::vector<double> q(2);
  for (double t = 0; t <= 1; t += 1 / 128.) {
    guess.at(t, q);
    EXPECT_NEAR(q[0], cubic(t), 2e-14);
    EXPECT_NEAR(q[1], -2 * cubic(t), 4e-14);
  }
  for (std::size_t k = 0; k < guess.tau.size(); ++k) {
    guess.at(guess.tau[k], q);
    EXPECT_EQ(q[0], guess.q[2 * k]);
    EXPECT_EQ(q[1], guess.q[2 * k + 1]);
  }
}

TEST(Guess, TwoSamplesAreALineAndThreeAParabola) {
  std::vector<double> q(2);
  sampled({0, 1}, [](double t) { return 3 - t; }).at(0.25, q);
  EXPECT_DOUBLE_EQ(q[0], 2.75);
  sampled({0, 0.4, 1}, [](double t) { return t * t; }).at(0.7, q);
  EXPECT_DOUBLE_EQ(q[0], 0.49);
}

TEST(Guess, ErrorFallsAsTheFourthPower) {
  const auto error = [](int samples) {
    std::vector<double> tau(samples), q(2);
    for (int k = 0; k < samples; ++k) tau[k] = k / (samples - 1.0);
    const Guess guess = sampled(tau, [](double t) { return std::sin(5 * t); });
    double largest = 0;
    for (int i = 0; i <= 1000; ++i) {
      guess.at(i / 1000.0, q);
      largest = std::max(largest, std::abs(q[0] - std::sin(5 * i / 1000.0)));
    }
    return largest;
  };
  EXPECT_NEAR(std::log2(error(101) / error(201)), 4, 0.1);
}

TEST(Guess, ConstantBeyondItsEnds) {
  const Guess guess = sampled({0, 0.5, 1}, [](double t) { return t; });
  std::vector<double> q(2);
  guess.at(-0.1, q);
  EXPECT_EQ(q[0], 0);
  guess.at(1.0000001, q);
  EXPECT_EQ(q[0], 1);
}

TEST(Guess, AHundredThousandSamples) {
  std::vector<double> tau(100001), q(2);
  for (int k = 0; k <= 100000; ++k) tau[k] = k / 100000.0;
  const Guess guess = sampled(tau, [](double t) { return std::exp(t); });
  for (int i = 0; i < 100000; ++i) {
    const double t = (i + 0.5) / 100000;
    guess.at(t, q);
    ASSERT_NEAR(q[0], std::exp(t), 2e-15);
  }
}

}  // namespace
}  // namespace extremal
