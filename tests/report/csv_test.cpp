#include "report/csv.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <sstream>

#include "report/sample_results.hpp"
#include "report/temporary_folder.hpp"
#include "study/files/numpy.hpp"

namespace extremal {
namespace {

std::string text(const Samples& samples, const std::vector<std::string>& names) {
  std::ostringstream out;
  write_csv(out, samples, names);
  return out.str();
}

TEST(Csv, HeaderAndRows) {
  EXPECT_EQ(text(*transfer_result().samples, {"x", "y"}),
            "t,x,y,x',y',p_x,p_y\n"
            "0,1,0,0.1,0.3,0.5,0.7\n"
            "2.5,-0.6,0.9,0.2,0.4,0.6,0.8\n");
}

TEST(Csv, SeveralSolutionsBelowEachOther) {
  std::ostringstream out;
  const Samples samples{.t = {0, 2}, .q = {{1, 3}}, .v = {{4, 5}}, .p = {{6, 7}}};
  write_csv(out, std::vector<Samples>{samples, samples}, {"x"});
  EXPECT_EQ(out.str(),
            "solution,t,x,x',p_x\n1,0,1,4,6\n1,2,3,5,7\n"
            "2,0,1,4,6\n2,2,3,5,7\n");
}

/// Where L is infinite at the start: an empty cell, and in arrays no row.
TEST(Csv, EndsWithoutVelocities) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  Samples samples{.t = {0, 1, 2}, .q = {{1, 3, 5}}, .v = {{none, 5, 6}}, .p = {{none, 7, 8}}};
  samples.open_start = true;
  EXPECT_EQ(text(samples, {"x"}), "t,x,x',p_x\n0,1,,\n1,3,5,7\n2,5,6,8\n");
  const std::map<std::string, NumpyArray> arrays = read_npz(npz_text(samples, {"x"}), 1 << 20);
  EXPECT_EQ(arrays.at("t").values, (std::vector<double>{1, 2}));
  EXPECT_EQ(arrays.at("x").values, (std::vector<double>{3, 5}));
  EXPECT_EQ(arrays.at("x'").values, (std::vector<double>{5, 6}));
  EXPECT_EQ(arrays.at("p_x").values, (std::vector<double>{7, 8}));
}

TEST(Csv, ElementsOfArraysAreKeyedAsTheyAreWritten) {
  const std::string all = text(*transfer_result().samples, {"x[1]", "x[2]"});
  EXPECT_EQ(all.substr(0, all.find('\n')), "t,x[1],x[2],x[1]',x[2]',p_x[1],p_x[2]");
}

TEST(Csv, NumbersReadBackAsTheSameDouble) {
  std::mt19937_64 random(11);
  Column numbers{0.1, -0.0, 1.0 / 3, 1e23, std::numeric_limits<double>::denorm_min()};
  while (numbers.size() < 5000) {
    const double number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  std::istringstream in(text({.t = numbers, .q = {numbers}, .v = {numbers}, .p = {numbers}}, {"x"}));
  std::string line;
  std::getline(in, line);
  for (const double number : numbers) {
    std::getline(in, line);
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(std::strtod(cell.c_str(), nullptr)),
                std::bit_cast<std::uint64_t>(number));
    }
  }
}

TEST(Csv, RefusesWhatIsNotFinite) {
  Samples samples = *transfer_result().samples;
  samples.v[1][1] = std::numeric_limits<double>::quiet_NaN();
  try {
    text(samples, {"x", "y"});
    ADD_FAILURE() << "not refused";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "column y' is nan in row 2");
  }
}

TEST(Csv, RefusesColumnsThatDoNotFit) {
  EXPECT_THROW(text(*transfer_result().samples, {"x"}), std::invalid_argument);
}

TEST(Csv, AFileThatCannotBeWrittenIsNamed) {
  for (const std::string path : {"/dev/null/r.csv", "/dev/full"}) {
    try {
      write_csv(path, *transfer_result().samples, {"x", "y"});
      ADD_FAILURE() << path << " was written";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

TEST(Csv, WritesAFile) {
  const TemporaryFolder folder;
  write_csv(folder / "r.csv", *transfer_result().samples, {"x", "y"});
  std::ostringstream content;
  content << std::ifstream(folder / "r.csv").rdbuf();
  EXPECT_EQ(content.str(), text(*transfer_result().samples, {"x", "y"}));
}

}  // namespace
}  // namespace extremal
