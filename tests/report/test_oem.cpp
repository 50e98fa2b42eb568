#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <regex>
#include <sstream>

#include "report/oem.hpp"

using namespace extremal;

namespace {

Units units() {
  Units u;
  u.length = 1000;
  u.time = 10;
  u.frame = "ICRF";
  u.centre = "EARTH";
  u.epoch = std::chrono::sys_days(
      std::chrono::year_month_day(std::chrono::year(2024), std::chrono::month(2), std::chrono::day(28)));
  return u;
}

std::string oem_text(const Units& units, const std::string& title, const std::vector<std::string>& names,
                     const Samples& samples) {
  std::ostringstream out;
  write_oem(out, units, title, names, samples);
  return out.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(Oem, HasKilometresAndDatesOfTheEpoch) {
  const Samples samples{{0, 17280.0}, {{1, 2}, {3, 4}}, {{5, 6}, {7, 8}}, {{0, 0}, {0, 0}}};
  const std::vector<std::string> lines = lines_of(oem_text(units(), "Über den Mond\nA", {"x", "y"}, samples));
  const std::vector<std::string> expected = {"CCSDS_OEM_VERS = 2.0",
                                             "CREATION_DATE = 2024-02-28T00:00:00.000000000",
                                             "ORIGINATOR = EXTREMAL",
                                             "",
                                             "META_START",
                                             "OBJECT_NAME = ber den MondA",
                                             "OBJECT_ID = 1",
                                             "CENTER_NAME = EARTH",
                                             "REF_FRAME = ICRF",
                                             "TIME_SYSTEM = TDB",
                                             "START_TIME = 2024-02-28T00:00:00.000000000",
                                             "STOP_TIME = 2024-03-01T00:00:00.000000000",
                                             "INTERPOLATION = HERMITE",
                                             "INTERPOLATION_DEGREE = 3",
                                             "META_STOP",
                                             "",
                                             "2024-02-28T00:00:00.000000000 1.000000000000000e+03 "
                                             "3.000000000000000e+03 0.000000000000000e+00 "
                                             "5.000000000000000e+02 7.000000000000000e+02 "
                                             "0.000000000000000e+00",
                                             "2024-03-01T00:00:00.000000000 2.000000000000000e+03 "
                                             "4.000000000000000e+03 0.000000000000000e+00 "
                                             "6.000000000000000e+02 8.000000000000000e+02 "
                                             "0.000000000000000e+00"};
  EXPECT_EQ(lines, expected);
}

/// Section 7 of CCSDS 502.0-B-2: keywords and values, dates, numbers of at most 16 digits whose point is the
/// second character.
TEST(Oem, KeepsTheGrammarOfTheStandard) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Samples samples{{0, 1, 2.5}, {{}, {}, {}}, {{}, {}, {}}, {{}, {}, {}}};
  for (std::vector<Column>* part : {&samples.q, &samples.v, &samples.p})
    for (Column& column : *part)
      for (std::size_t k = 0; k < samples.count(); ++k)
        column.push_back(normal(random) * std::pow(10.0, 20 * normal(random)));
  const std::string date = "\\d{4}-\\d{2}-\\d{2}T\\d{2}:\\d{2}:\\d{2}\\.\\d+";
  const std::string number = "[+-]?\\d\\.\\d{1,15}e[+-]?\\d{1,3}";
  const std::regex keyword("[A-Z_]+ = [ -~]*[!-~]"), block("META_START|META_STOP|"),
      state(date + "( " + number + "){6}");
  int states = 0;
  for (const std::string& line : lines_of(oem_text(units(), "Title", {"x", "y", "z"}, samples))) {
    const bool is_state = std::regex_match(line, state);
    states += is_state;
    EXPECT_TRUE(is_state || std::regex_match(line, keyword) || std::regex_match(line, block)) << line;
    EXPECT_LE(line.size(), 254u);
  }
  EXPECT_EQ(states, 3);
}

/// More lines than a block of text holds, each with what fmt writes.
TEST(Oem, LinesFollowEachOther) {
  constexpr int count = 20'000;
  Samples samples{{}, {{}, {}}, {{}, {}}, {Column(count), Column(count)}};
  for (int k = 0; k < count; ++k) {
    samples.t.push_back(0.1 * k);  // s: units of ten
    samples.q[0].push_back(std::sin(k));
    samples.q[1].push_back(std::exp(0.01 * k));
    samples.v[0].push_back(-1.0 / (k + 1));
    samples.v[1].push_back(std::cos(k) * 1e-300);
  }
  const std::vector<std::string> lines = lines_of(oem_text(units(), "", {"x", "y"}, samples));
  ASSERT_EQ(lines.size(), 16u + count);
  for (int k = 0; k < count; ++k) {
    const auto [q, v] =
        std::pair(std::array{samples.q[0][k], samples.q[1][k]}, std::array{samples.v[0][k], samples.v[1][k]});
    const std::string date =
        fmt::format("2024-02-28T{:02}:{:02}:{:02}.000000000", k / 3600, k / 60 % 60, k % 60);
    EXPECT_EQ(lines[16 + k], fmt::format("{} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e}", date,
                                         1000 * q[0], 1000 * q[1], 0.0, 100 * v[0], 100 * v[1], 0.0));
  }
}

TEST(Oem, HasASegmentForEachBody) {
  const std::vector<std::string> names = {"x[1]", "x[2]", "y[1]", "y[2]", "z[1]", "z[2]"};
  const Column two{1, 2};
  const Samples samples{{0, 1}, {6, two}, {6, two}, {6, two}};
  const std::string text = oem_text(units(), "", names, samples);
  EXPECT_NE(text.find("OBJECT_NAME = TRAJECTORY 1\n"), std::string::npos);
  EXPECT_NE(text.find("OBJECT_NAME = TRAJECTORY 2\n"), std::string::npos);
}

TEST(Oem, RefusesWhatIsNoPositionAndNoDate) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"theta"}, {"r", "theta"}, {"q[1]", "q[2]"}, {"x", "y", "theta"}})
    EXPECT_THROW(check_oem(names), std::invalid_argument);
  const Samples samples{{0, 1e12}, {{1, 2}, {3, 4}}, {{5, 6}, {7, 8}}, {{0, 0}, {0, 0}}};
  EXPECT_THROW(oem_text(units(), "", {"x", "y"}, samples), std::invalid_argument);
}

}  // namespace
