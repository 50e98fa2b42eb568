#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "formula_support.hpp"

namespace extremal {
namespace {

/// Whatever is fed in: a value, or a FormulaError that points into its text.
void feed(const std::string& text) {
  const SystemText system{.coordinates = {"x", "q[4]"},
                          .parameters = {{"n", {{3}}}, {"m", {{1, 2}, true}}},
                          .definitions = {{"d", "x + sum(i, 1, n, q[i])"}},
                          .lagrangian = text,
                          .active = {"n"}};
  SystemText folded = system;
  folded.active.clear();
  const auto check = [&](auto action) {
    try {
      action();
    } catch (const FormulaError& error) {
      EXPECT_LE(error.offset, std::max<std::size_t>(text.size(), 32)) << text;
      EXPECT_STRNE(error.what(), "");
    }
  };
  check([&] { graph_of(system); });
  check([&] { graph_of(folded); });
  check([&] { number(text, system.parameters, "number"); });
}

TEST(FormulaFuzz, RandomBytesAreRefusedOrRead) {
  std::mt19937 engine(1);
  std::uniform_int_distribution<int> byte(0, 255), length(0, 40);
  for (int run = 0; run < 3000; ++run) {
    std::string text(length(engine), ' ');
    for (char& c : text) c = static_cast<char>(byte(engine));
    feed(text);
  }
}

TEST(FormulaFuzz, RandomTokensAreRefusedOrRead) {
  constexpr std::string_view tokens[] = {"x",  "q",  "[",    "]",    "'",    "(",  ")",  "+",    "-",
                                         "*",  "/",  "^",    ",",    "1",    "2",  "i",  "n",    "m",
                                         "d",  "t",  "pi",   "sum(", "i,",   "1,", "n,", "sin(", "q[i]",
                                         "x'", "m[", "max(", "0.5",  "q[1]", "j,", "j",  "=",    "T"};
  std::mt19937 engine(2);
  std::uniform_int_distribution<std::size_t> pick(0, std::size(tokens) - 1);
  std::uniform_int_distribution<int> length(1, 14);
  for (int run = 0; run < 20000; ++run) {
    std::string text;
    for (int k = length(engine); k > 0; --k) text += tokens[pick(engine)];
    feed(text);
  }
}

/// Random formulas that are well formed have the value of their plain reading.
class Writer {
 public:
  explicit Writer(unsigned seed) : engine_(seed) {}

  /// A formula and its value at x = 0.7, y = -1.3, in the indices i, j.
  std::pair<std::string, double> write(int depth) {
    const auto [a, u] = depth > 0 ? write(depth - 1) : leaf();
    if (depth == 0) return {a, u};
    const auto [b, v] = write(depth - 1);
    switch (pick(7)) {
      case 0:
        return {"(" + a + ") + " + b, u + v};
      case 1:
        return {"(" + a + ") - (" + b + ")", u - v};
      case 2:
        return {"(" + a + ")*(" + b + ")", u * v};
      case 3:
        return {"(" + a + ")/(2 + (" + b + ")^2)", u / (2 + v * v)};
      case 4:
        return {"-sin(" + a + ")", -std::sin(u)};
      case 5:
        return {"max(" + a + ", " + b + ")", std::max(u, v)};
      default:
        return {"atan2(" + a + ", 3 + abs(" + b + "))", std::atan2(u, 3 + std::abs(v))};
    }
  }

 private:
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }
  std::pair<std::string, double> leaf() {
    switch (pick(4)) {
      case 0:
        return {"x", 0.7};
      case 1:
        return {"y", -1.3};
      case 2:
        return {"2^-1", 0.5};
      default:
        return {"pi", 3.14159265358979323846};
    }
  }
  std::mt19937 engine_;
};

TEST(FormulaFuzz, RandomFormulasHaveTheirValues) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    const auto [text, exact] = Writer(seed).write(4);
    EXPECT_NEAR(value_of({.coordinates = {"x", "y"}, .lagrangian = text}, {0.7, -1.3}, {0, 0}), exact,
                1e-13 * (1 + std::abs(exact)))
        << text;
  }
}

TEST(FormulaFuzz, KernelsAgreeWithSumsWrittenOut) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const std::string body = Writer(seed).write(3).first;
    const std::string sum = "sum(i, 1, 3, sum(j, i, 4, i*x*q[j]*(" + body + ") - m[i]*q[i]^2/(j + x^2)))";
    SystemText text{.coordinates = {"x", "y", "q[4]"}, .parameters = {{"m", {{1, 2, 4}, true}}}};
    text.lagrangian = "x*(y - " + sum + "/3)";
    const std::vector<double> q{0.7, -1.3, 0.2, 0.4, -0.6, 0.9}, v(6);
    const double kernels = value_of(text, q, v);
    text.lagrangian = "x*(y - min(" + sum + ", 1e30)/3)";
    EXPECT_EQ(graph_of(text).terms.size(), 1u);
    EXPECT_NEAR(value_of(text, q, v), kernels, 1e-12 * (1 + std::abs(kernels))) << sum;
  }
}

}  // namespace
}  // namespace extremal
