#include <gtest/gtest.h>
#include <qd/dd_real.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "system/lagrangian.hpp"
#include "system/tape_code.hpp"

/// Every instruction at every level that this processor has, against long double.

namespace extremal {
namespace {

struct Level {
  SimdLevel level;
  Player player;
};

std::vector<Level> levels() {
  const Player players[] = EXTREMAL_AT_EACH_LEVEL(play);
  std::vector<Level> result;
  for (std::size_t k = 0; k < std::size(players); ++k)
    if (const auto level = static_cast<SimdLevel>(k); available(level)) result.push_back({level, players[k]});
  return result;
}

using Real = long double;
struct Expected {
  Code code;
  std::function<Real(Real a, Real b, Real c, Real s)> value;
  double ulps = 0.502;  ///< of the result, plus as many of each product within
  double low = -3, high = 3;
};

std::vector<Expected> instructions() {
  using std::exp, std::log, std::pow, std::sqrt, std::abs;
  using std::sin, std::cos, std::tan, std::asin, std::acos, std::atan, std::atan2, std::sinh, std::cosh,
      std::tanh;
  return {
      {Code::copy, [](Real a, Real, Real, Real) { return a; }},
      {Code::negate, [](Real a, Real, Real, Real) { return -a; }},
      {Code::fill, [](Real, Real, Real, Real s) { return s; }},
      {Code::add, [](Real a, Real b, Real, Real) { return a + b; }},
      {Code::add_scalar, [](Real a, Real, Real, Real s) { return a + s; }},
      {Code::subtract, [](Real a, Real b, Real, Real) { return a - b; }},
      {Code::subtract_from, [](Real a, Real, Real, Real s) { return s - a; }},
      {Code::multiply, [](Real a, Real b, Real, Real) { return a * b; }},
      {Code::multiply_negate, [](Real a, Real b, Real, Real) { return -a * b; }},
      {Code::scale, [](Real a, Real, Real, Real s) { return s * a; }},
      {Code::divide, [](Real a, Real b, Real, Real) { return a / b; }},
      {Code::multiply_add, [](Real a, Real b, Real c, Real) { return a * b + c; }},
      {Code::multiply_sub, [](Real a, Real b, Real c, Real) { return a * b - c; }},
      {Code::sub_multiply, [](Real a, Real b, Real c, Real) { return c - a * b; }},
      {Code::negate_all, [](Real a, Real b, Real c, Real) { return -a * b - c; }},
      {Code::scale_add, [](Real a, Real b, Real, Real s) { return s * a + b; }},
      {Code::scale_sub, [](Real a, Real b, Real, Real s) { return s * a - b; }},
      {Code::multiply_scalar, [](Real a, Real b, Real, Real s) { return a * b + s; }},
      {Code::scalar_multiply, [](Real a, Real b, Real, Real s) { return s - a * b; }},
      {Code::reciprocal, [](Real a, Real, Real, Real) { return 1 / a; }},
      {Code::square_root, [](Real a, Real, Real, Real) { return sqrt(a); }, 0.502, 0, 3},
      {Code::reciprocal_root, [](Real a, Real, Real, Real) { return 1 / sqrt(a); }, 1.51, 0, 3},
      {Code::step, [](Real a, Real b, Real, Real) { return Real(a >= b); }},
      {Code::minimum, [](Real a, Real b, Real, Real) { return std::min(a, b); }},
      {Code::maximum, [](Real a, Real b, Real, Real) { return std::max(a, b); }},
      {Code::absolute, [](Real a, Real, Real, Real) { return abs(a); }},
      {Code::power, [](Real a, Real b, Real, Real) { return pow(a, b); }, 1.01, 0, 3},
      {Code::exponential, [](Real a, Real, Real, Real) { return exp(a); }, 1.01},
      {Code::logarithm, [](Real a, Real, Real, Real) { return log(a); }, 1.01, 0, 3},
      {Code::sine, [](Real a, Real, Real, Real) { return sin(a); }, 1.01, -100, 100},
      {Code::cosine, [](Real a, Real, Real, Real) { return cos(a); }, 1.01, -100, 100},
      {Code::tangent, [](Real a, Real, Real, Real) { return tan(a); }, 1.01},
      {Code::arcsine, [](Real a, Real, Real, Real) { return asin(a); }, 1.01, -1, 1},
      {Code::arccosine, [](Real a, Real, Real, Real) { return acos(a); }, 1.01, -1, 1},
      {Code::arctangent, [](Real a, Real, Real, Real) { return atan(a); }, 1.01},
      {Code::arctangent2, [](Real a, Real b, Real, Real) { return atan2(a, b); }, 1.01},
      {Code::hyperbolic_sine, [](Real a, Real, Real, Real) { return sinh(a); }, 1.01},
      {Code::hyperbolic_cosine, [](Real a, Real, Real, Real) { return cosh(a); }, 1.01},
      {Code::hyperbolic_tangent, [](Real a, Real, Real, Real) { return tanh(a); }, 1.01},
  };
}

double ulp(Real x) {
  const double size = std::abs(static_cast<double>(x));
  return std::nextafter(size, INFINITY) - size;
}

class EveryLevel : public testing::TestWithParam<Level> {
 protected:
  const int lanes = lanes_of(GetParam().level);

  /// Operands d, a, b, c, e of as many batches.
  AlignedDoubles rows(int batches, double low, double high) {
    AlignedDoubles result(static_cast<std::size_t>(5) * batches * lanes);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(low, high);
    for (double& x : result) x = uniform(random);
    return result;
  }
  void play(const Instruction& instruction, AlignedDoubles& values, int batches, double scalar) {
    double* operands[5];
    for (int k = 0; k < 5; ++k) operands[k] = values.data() + k * batches * lanes;
    GetParam().player(&instruction, 1, operands, &scalar, batches);
  }
};

TEST_P(EveryLevel, PlaysEveryInstructionToItsAccuracy) {
  for (const Expected& e : instructions()) {
    for (const int batches : {1, 3, 8, 16}) {
      AlignedDoubles values = rows(batches, e.low, e.high);
      const double s = 1.37;
      play({e.code, 0, 1, 2, 3, 0}, values, batches, s);
      const int n = batches * lanes;
      for (int i = 0; i < n; ++i) {
        const Real a = values[n + i], b = values[2 * n + i], c = values[3 * n + i],
                   exact = e.value(a, b, c, s);
        // Without fused operations the product is rounded on its own.
        const double largest = std::max({ulp(exact), ulp(a * b), ulp(s * a)});
        const bool fused = e.code >= Code::multiply_add && e.code <= Code::scalar_multiply;
        ASSERT_LE(std::abs(static_cast<double>(values[i] - exact)),
                  e.ulps * (fused ? 2 * largest : ulp(exact)))
            << "instruction " << static_cast<int>(e.code) << " of " << a << " " << b << " " << c;
      }
    }
  }
}

TEST_P(EveryLevel, PutsOutBothCircularFunctions) {
  AlignedDoubles values = rows(3, -10, 10);
  const AlignedDoubles before = values;
  play({Code::sine_cosine, 1, 1, 0, 4, 0}, values, 3, 0);  // in place
  for (int i = 0; i < 3 * lanes; ++i) {
    const Real x = before[3 * lanes + i];
    EXPECT_LE(std::abs(static_cast<double>(values[3 * lanes + i] - std::sin(x))), 1.01 * ulp(std::sin(x)));
    EXPECT_LE(std::abs(static_cast<double>(values[12 * lanes + i] - std::cos(x))), 1.01 * ulp(std::cos(x)));
  }
}

TEST_P(EveryLevel, OverwritesAnOperand) {
  for (const int batches : {1, 5, 8}) {
    AlignedDoubles values = rows(batches, -3, 3);
    const AlignedDoubles before = values;
    play({Code::multiply_add, 1, 1, 1, 1, 0}, values, batches, 0);
    for (int i = 0; i < batches * lanes; ++i) {
      const double x = before[batches * lanes + i];
      EXPECT_NEAR(values[batches * lanes + i], x * x + x, 2e-15);
    }
  }
}

DoubleDouble wide(Real x) {
  const double high = static_cast<double>(x);
  return {high, static_cast<double>(x - high)};
}
Real narrow(Real x) { return x; }
Real narrow(const DoubleDouble& x) { return Real(x.x[0]) + x.x[1]; }

/// Of an operation: that of the reference; where that has more digits than sums of two doubles, some units of
/// their last place, which is what the functions of QD are good to.
constexpr Real operation_roundoff = std::max<Real>(std::numeric_limits<Real>::epsilon(), 0x1p-100L);

template <class Number>
void expect_every_instruction(const std::function<Number(Real)>& number) {
  std::mt19937 random(11);
  for (const Expected& e : instructions()) {
    std::uniform_real_distribution<Real> uniform(e.low, e.high);
    for (int i = 0; i < 20; ++i) {
      Number values[4] = {number(0), number(uniform(random)), number(uniform(random)),
                          number(uniform(random))};
      Number* const operands[] = {values, values + 1, values + 2, values + 3};
      const Instruction instruction{e.code, 0, 1, 2, 3, 0};
      const double s = 1.37;
      play_extended(&instruction, 1, operands, &s);
      const Real a = narrow(values[1]), b = narrow(values[2]), c = narrow(values[3]),
                 exact = e.value(a, b, c, s);
      // Without fused operations the product is rounded on its own.
      const Real terms = std::abs(exact) + std::abs(a * b) + std::abs(s * a);
      ASSERT_LE(std::abs(narrow(values[0]) - exact), 2 * operation_roundoff * terms)
          << "instruction " << static_cast<int>(e.code) << " of " << a << " " << b << " " << c;
    }
  }
  Number angle = number(0.7L), cosine = number(0);
  Number* const operands[] = {&angle, &cosine};
  const Instruction both{Code::sine_cosine, 0, 0, 0, 1, 0};  // in place
  const double none = 0;
  play_extended(&both, 1, operands, &none);
  EXPECT_LE(std::abs(narrow(angle) - std::sin(0.7L)), operation_roundoff / 4);
  EXPECT_LE(std::abs(narrow(cosine) - std::cos(0.7L)), operation_roundoff / 4);
}

TEST(Extended, PlaysEveryInstruction) {
  expect_every_instruction<Extended>([](Real x) { return x; });
  expect_every_instruction<DoubleDouble>(wide);
}

/// sin² + cos² = 1 and √x² = x, the logarithm undoes the exponential.
TEST(Extended, HasTwiceTheDigits) {
  DoubleDouble x = wide(0.7L), values[4] = {x, x, x, x};
  DoubleDouble* const operands[] = {values, values + 1, values + 2, values + 3};
  const Instruction code[] = {{Code::sine_cosine, 0, 0, 0, 1, 0},
                              {Code::square_root, 2, 2, 0, 0, 0},
                              {Code::exponential, 3, 3, 0, 0, 0},
                              {Code::logarithm, 3, 3, 0, 0, 0}};
  const double none = 0;
  play_extended(code, 4, operands, &none);
  EXPECT_LT(std::abs(to_double(sqr(values[0]) + sqr(values[1]) - 1.0)), 1e-31);
  EXPECT_LT(std::abs(to_double(sqr(values[2]) - x)), 1e-31);
  EXPECT_LT(std::abs(to_double(values[3] - x)), 1e-31);
}

/// Quietly, as the standard library has it.
TEST(Extended, GoesBeyondWhereFunctionsAreDefined) {
  const auto played = [](Code code, double a, double b) {
    DoubleDouble values[4] = {0.0, a, b, 0.0};
    DoubleDouble* const operands[] = {values, values + 1, values + 2, values + 3};
    const Instruction instruction{code, 0, 1, 2, 3, 0};
    const double none = 0;
    play_extended(&instruction, 1, operands, &none);
    return to_double(values[0]);
  };
  testing::internal::CaptureStderr();
  EXPECT_EQ(played(Code::power, -2, 3), -8);
  EXPECT_EQ(played(Code::power, 0, 1.5), 0);
  EXPECT_EQ(played(Code::power, -2, -2), 0.25);
  EXPECT_TRUE(std::isnan(played(Code::power, -2, 1.5)));
  EXPECT_EQ(played(Code::logarithm, 0, 0), -INFINITY);
  EXPECT_TRUE(std::isnan(played(Code::logarithm, -1, 0)));
  EXPECT_TRUE(std::isnan(played(Code::square_root, -1, 0)));
  EXPECT_TRUE(std::isnan(played(Code::arcsine, 1.5, 0)));
  EXPECT_FALSE(std::isfinite(played(Code::arctangent2, 0, 0)));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

INSTANTIATE_TEST_SUITE_P(Levels, EveryLevel, testing::ValuesIn(levels()),
                         [](const auto& info) { return std::string(name(info.param.level)); });

}  // namespace
}  // namespace extremal
