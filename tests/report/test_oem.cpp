#include <gtest/gtest.h>

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
                                             "2024-02-28T00:00:00.000000000 1000 3000 0 500 700 0",
                                             "2024-03-01T00:00:00.000000000 2000 4000 0 600 800 0"};
  EXPECT_EQ(lines, expected);
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
