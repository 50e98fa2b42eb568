#include "report/numbers.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "report/blocks.hpp"

/// \file Numbers as text.

namespace extremal::numbers {
namespace {

std::string number_text(double value) {
  char text[number_size];
  return {text, write_number(value, text)};
}

std::string real_text(double value) {
  char text[number_size];
  return {text, write_real(value, text)};
}

void expect_shortest(double value) {
  const std::string text = number_text(value);
  EXPECT_EQ(text, fmt::format("{}", value));
  double read = 0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(read), std::bit_cast<std::uint64_t>(value)) << text;
}

TEST(Numbers, HaveTheShortestDigitsThatReadBack) {
  std::mt19937_64 random(7);
  for (int k = 0; k < 200'000; ++k) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) expect_shortest(value);
  }
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 100'000; ++k) expect_shortest(uniform(random) * std::pow(10.0, k % 40 - 20));
}

TEST(Numbers, WholeNumbersAndEndsOfTheRange) {
  for (int power = -320; power <= 307; ++power) expect_shortest(std::pow(10.0, power) * 0.7);
  for (std::int64_t k = 1; k < std::int64_t{1} << 60; k *= 3) {
    expect_shortest(static_cast<double>(k));
    expect_shortest(-static_cast<double>(k) / 1024);
  }
  using Limits = std::numeric_limits<double>;
  for (int power = -1074; power <= 1023; ++power) {  // the double below is nearer than the one above
    const double value = std::ldexp(1, power);
    for (const double near : {value, std::nextafter(value, 0), std::nextafter(value, Limits::max())})
      expect_shortest(near);
  }
  for (const double value : {0.0, -0.0, 1.0, 1e15, 1e16, 1e-4, 9.999e-5, 123456789012345678.0, Limits::max(),
                             Limits::min(), Limits::denorm_min(), Limits::epsilon()})
    expect_shortest(value);
}

TEST(Numbers, OfJsonHaveAPointWhereTheyAreWhole) {
  EXPECT_EQ(real_text(0), "0.0");
  EXPECT_EQ(real_text(-0.0), "-0.0");
  EXPECT_EQ(real_text(1), "1.0");
  EXPECT_EQ(real_text(-1200), "-1200.0");
  EXPECT_EQ(real_text(0.5), "0.5");
  EXPECT_EQ(real_text(1e300), "1e+300");
  EXPECT_EQ(real_text(-2.5e-7), "-2.5e-07");
}

TEST(Numbers, BlocksFollowEachOther) {
  for (const std::size_t count : {0u, 1u, 2u, 1000u, 100'000u}) {
    std::ostringstream out;
    write_blocks(out, count, number_size, [](std::size_t first, std::size_t end, char* to) {
      for (std::size_t k = first; k < end; ++k) {
        to = write_number(static_cast<double>(k), to);
        *to++ = ' ';
      }
      return to;
    });
    std::string expected;
    for (std::size_t k = 0; k < count; ++k) expected += std::to_string(k) + " ";
    EXPECT_EQ(out.str(), expected) << count;
  }
}

}  // namespace
}  // namespace extremal::numbers
