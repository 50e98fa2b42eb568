#include "report/text.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "report/sample_results.hpp"

namespace extremal {
namespace {

TEST(Summary, OfAConvergedResult) {
  EXPECT_EQ(summary(transfer_result()),
            "title           Planar transfer\n"
            "status          converged\n"
            "message         the tolerance 1e-09 is met\n"
            "strategy        newton from the guess\n"
            "duration        2.5\n"
            "action          1.234\n"
            "energy          -0.4, drift 1.0e-14\n"
            "error estimate  3.0e-10\n"
            "residual        2.0e-15\n"
            "index           0, nullity 1, minimising\n"
            "windows         2, sampled; conjugate times 1.25\n"
            "mesh            2 elements of degree 8, 62 unknowns\n"
            "iterations      5\n"
            "time            read 100 µs, solve 40.0 µs, analyse 10.0 µs\n");
}

TEST(Summary, OpenEndsOfAFitHaveNoNaturalConditions) {
  Result result = transfer_result();
  result.natural_conditions = 2;
  EXPECT_NE(summary(result).find("2 natural conditions"), std::string::npos);
  result.fit = Fitted{};
  EXPECT_EQ(summary(result).find("natural condition"), std::string::npos);
}

TEST(Summary, OfSeveralSolutions) {
  Result result = transfer_result(), other = transfer_result();
  other.solution.action = 5.5;
  other.solution.morse_index = 3;
  other.solution.energy.reset();
  other.solution.strategy = "deflated newton from the guess";
  const std::string first = summary(result);
  result.solutions = {{transfer_result()}};
  EXPECT_EQ(summary(result), first);
  result.solutions->push_back(other);
  EXPECT_EQ(summary(result),
            first +
                "\n"
                "solution  action  duration  energy  index  nullity  strategy\n"
                "       1   1.234       2.5    -0.4      0        1  newton from the guess\n"
                "       2     5.5       2.5       –      3        1  deflated newton from the guess\n");
}

TEST(Summary, ListsTheFirstConjugateTimes) {
  Result result = transfer_result();
  result.solution.conjugate_times = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  EXPECT_NE(summary(result).find("; conjugate times 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, … (7 in all)\n"),
            std::string::npos);
  result.solution.conjugate_times.clear();
  EXPECT_NE(summary(result).find("windows         2, sampled\n"), std::string::npos);
  result.solution.certificate = Certificate::none;
  EXPECT_EQ(summary(result).find("windows"), std::string::npos);
}

TEST(Summary, TellsStability) {
  Result result = transfer_result();
  Floquet& floquet = result.solution.floquet.emplace();
  floquet.multipliers = {{606.25, 0}, {1, 0}, {1, 0}, {1 / 606.25, 0}};
  floquet.real_pairs = floquet.trivial_pairs = 1;
  EXPECT_NE(summary(result).find("stability       unstable: 1 real pair, 1 trivial pair at ±1 (double: exact "
                                 "for the time shift, else accurate to √ε); largest modulus 606.25\n"),
            std::string::npos);
  floquet.multipliers = {{2, 2}, {2, -2}, {0.25, 0.25}, {0.25, -0.25}};
  floquet.real_pairs = floquet.trivial_pairs = 0;
  floquet.quadruples = 1;
  EXPECT_NE(summary(result).find("unstable: 1 complex quadruple; largest modulus 2.82842712\n"),
            std::string::npos);
  floquet.multipliers = {{0.6, 0.8}, {0.6, -0.8}, {0, 1}, {0, -1}};
  floquet.quadruples = 0;
  floquet.circle_pairs = 2;
  EXPECT_NE(summary(result).find("stable: 2 pairs on the unit circle; largest modulus 1\n"),
            std::string::npos);
}

TEST(Summary, LeavesOutWhatThereIsNot) {
  Result result = transfer_result();
  result.title.clear();
  result.solution.status = Status::not_converged;
  result.solution.message = "the iteration\nstopped";
  result.solution.energy.reset();
  result.solution.action = std::numeric_limits<double>::quiet_NaN();
  result.solution.morse_index.reset();
  result.solution.trajectory.times = {0, 1};
  result.solution.unknowns = 1;
  EXPECT_EQ(summary(result),
            "status          not-converged\n"
            "strategy        newton from the guess\n"
            "duration        1\n"
            "residual        2.0e-15\n"
            "mesh            1 element of degree 8, 1 unknown\n"
            "iterations      5\n"
            "time            read 100 µs, solve 40.0 µs, analyse 10.0 µs\n");
}

TEST(Summary, OfASolutionNeverBegun) {
  EXPECT_EQ(summary(Result{}),
            "status          not-converged\n"
            "iterations      0\n"
            "time            read 0.00 ns, solve 0.00 ns, analyse 0.00 ns\n");
}

TEST(DurationText, HasThreeDigitsInTheUnitThatFits) {
  EXPECT_EQ(duration_text(8.5e-9), "8.50 ns");
  EXPECT_EQ(duration_text(850e-9), "850 ns");
  EXPECT_EQ(duration_text(999.4e-9), "999 ns");
  EXPECT_EQ(duration_text(999.6e-9), "1.00 µs");
  EXPECT_EQ(duration_text(9.994e-6), "9.99 µs");
  EXPECT_EQ(duration_text(9.996e-6), "10.0 µs");
  EXPECT_EQ(duration_text(99.96e-6), "100 µs");
  EXPECT_EQ(duration_text(4.56e-3), "4.56 ms");
  EXPECT_EQ(duration_text(1.234), "1.23 s");
  EXPECT_EQ(duration_text(12345), "12345 s");
}

Table small_table() {
  return {.head = {{"method", Table::Align::left}, {"time"}, {"error"}},
          .rows = {{"lobatto", "8.1 µs", "3e-10"}, {"dop853", "44 µs", "1e-8"}}};
}

TEST(Table, PlainTextIsAligned) {
  EXPECT_EQ(plain_text(small_table()),
            "method     time  error\n"
            "lobatto  8.1 µs  3e-10\n"
            "dop853    44 µs   1e-8\n");
}

TEST(Table, NoBlanksAtTheEndOfALine) {
  EXPECT_EQ(plain_text({.head = {{"a"}, {"long heading", Table::Align::left}}, .rows = {{"1", "x"}}}),
            "a  long heading\n"
            "1  x\n");
}

TEST(Table, RefusesARowOfAnotherLength) {
  Table table = small_table();
  table.rows[1].pop_back();
  try {
    plain_text(table);
    ADD_FAILURE() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "a row has 2 cells under 3 headings");
  }
}

TEST(Text, ControlCharactersBecomeVisible) {
  EXPECT_EQ(visible("a\nb\x1b[31m\t\u009b\u202e\xff é", false),
            "a\\nb\\u001b[31m\\u0009\\u009b\\u202e\uFFFD é");
  EXPECT_EQ(visible("a\nb\r", true), "a\nb\\u000d");
  EXPECT_EQ(visible(std::string("a\0b", 3), true), "a\\u0000b");
}

}  // namespace
}  // namespace extremal
