#include "report/json.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "report/sample_results.hpp"
#include "report/temporary_folder.hpp"

namespace extremal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string text(const Result& result) {
  std::ostringstream out;
  write_json(out, result);
  return out.str();
}

Json parsed(const Result& result) { return Json::parse(text(result)); }

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> list;
  for (const auto& [key, value] : object.items()) list.push_back(key);
  return list;
}

/// What() of the exception, which must be of this type.
template <class Exception>
std::string refusal(const Result& result) {
  try {
    text(result);
  } catch (const Exception& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Json, SolutionsOfASearchFollow) {
  Result result = transfer_result();
  EXPECT_FALSE(parsed(result).contains("solutions"));
  const Json first = parsed(result);
  Result other = transfer_result();
  other.solution.action = 5.5;
  result.solutions = {{transfer_result(), other}};
  Json json = parsed(result);
  EXPECT_EQ(keys(json).back(), "solutions");
  ASSERT_EQ(json["solutions"].size(), 2u);
  EXPECT_EQ(json["solutions"][0], first);
  EXPECT_EQ(json["solutions"][1]["action"], 5.5);
  EXPECT_EQ(keys(json["solutions"][1]), keys(first));
  result.solutions->clear();
  EXPECT_EQ(parsed(result)["solutions"], Json::array());
}

TEST(Json, WritesEveryFieldInTheOrderOfTheContract) {
  const Json json = parsed(transfer_result());
  EXPECT_EQ(keys(json), (std::vector<std::string>{"status",          "message",        "strategy",
                                                  "title",           "duration",       "action",
                                                  "energy",          "energy_drift",   "error_estimate",
                                                  "residual",        "morse_index",    "nullity",
                                                  "minimizing",      "certificate",    "windows",
                                                  "conjugate_times", "momentum_start", "momentum_end",
                                                  "multipliers",     "krein",          "symplectic_defect",
                                                  "elements",        "degree",         "unknowns",
                                                  "iterations",      "seconds",        "samples"}));
  EXPECT_EQ(json["status"], "converged");
  EXPECT_EQ(json["message"], "the tolerance 1e-09 is met");
  EXPECT_EQ(json["strategy"], "newton from the guess");
  EXPECT_EQ(json["title"], "Planar transfer");
  EXPECT_EQ(json["duration"], 2.5);
  EXPECT_EQ(json["action"], 1.234);
  EXPECT_EQ(json["energy"], -0.4);
  EXPECT_EQ(json["energy_drift"], 1e-14);
  EXPECT_EQ(json["error_estimate"], 3e-10);
  EXPECT_EQ(json["residual"], 2e-15);
  EXPECT_EQ(json["morse_index"], 0);
  EXPECT_EQ(json["nullity"], 1);
  EXPECT_EQ(json["minimizing"], true);
  EXPECT_EQ(json["certificate"], "sampled");
  EXPECT_EQ(json["windows"].dump(), "[[0.0,1.2],[1.2,2.5]]");
  EXPECT_EQ(json["conjugate_times"].dump(), "[1.25]");
  EXPECT_EQ(json["momentum_start"].dump(), R"({"x":0.1,"y":0.9})");
  EXPECT_EQ(json["momentum_end"].dump(), R"({"x":-0.3,"y":0.7})");
  EXPECT_EQ(json["elements"], 2);
  EXPECT_EQ(json["degree"], 8);
  EXPECT_EQ(json["unknowns"], 62);
  EXPECT_EQ(json["iterations"], 5);
  EXPECT_EQ(json["seconds"].dump(), R"({"read":0.0001,"solve":4e-05,"analyse":1e-05})");
  EXPECT_EQ(json["samples"].dump(),
            R"({"t":[0.0,2.5],"x":[1.0,-0.6],"y":[0.0,0.9],"x'":[0.1,0.2],"y'":[0.3,0.4],)"
            R"("p_x":[0.5,0.6],"p_y":[0.7,0.8]})");
}

TEST(Json, TypesAreThoseOfTheContract) {
  const Json json = parsed(transfer_result());
  for (const char* field : {"elements", "degree", "unknowns", "iterations", "morse_index", "nullity"}) {
    EXPECT_TRUE(json[field].is_number_integer()) << field;
  }
  for (const char* field : {"duration", "action", "energy", "energy_drift", "error_estimate", "residual"}) {
    EXPECT_TRUE(json[field].is_number_float()) << field;
  }
}

TEST(Json, PutsThePrefixBeforeAndThePrimeAfterAnElement) {
  Result result = transfer_result();
  result.names = {"x[1]", "x[2]"};
  const Json json = parsed(result);
  EXPECT_EQ(keys(json["samples"]),
            (std::vector<std::string>{"t", "x[1]", "x[2]", "x[1]'", "x[2]'", "p_x[1]", "p_x[2]"}));
  EXPECT_EQ(keys(json["momentum_start"]), (std::vector<std::string>{"x[1]", "x[2]"}));
}

TEST(Json, WritesNullWhereThereIsNone) {
  Result result = transfer_result();
  result.solution.energy.reset();
  result.solution.energy_drift.reset();
  result.solution.morse_index.reset();
  result.solution.nullity.reset();
  const Json json = parsed(result);
  for (const char* field : {"energy", "energy_drift", "morse_index", "nullity"}) {
    EXPECT_TRUE(json.at(field).is_null()) << field;
  }
}

TEST(Json, LeavesSamplesOutUnlessAsked) {
  Result result = transfer_result();
  result.samples.reset();
  EXPECT_FALSE(parsed(result).contains("samples"));
}

TEST(Json, NumbersReadBackAsTheSameDouble) {
  std::mt19937_64 random(7);
  Column numbers{0.0,
                 -0.0,
                 0.1,
                 1.0 / 3,
                 1e22,
                 1e23,
                 123456789012345678.0,
                 std::numeric_limits<double>::min(),
                 std::numeric_limits<double>::max(),
                 std::numeric_limits<double>::denorm_min(),
                 std::numeric_limits<double>::lowest(),
                 std::nextafter(1.0, 2.0)};
  while (numbers.size() < 20000) {
    const double number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  Result result = transfer_result();
  result.names = {"x"};
  result.solution.momentum_start = {numbers[3]};
  result.solution.momentum_end = {numbers[10]};
  result.samples = Samples{.t = numbers, .q = {numbers}, .v = {numbers}, .p = {numbers}};
  const Json json = parsed(result);
  for (const char* key : {"t", "x", "x'", "p_x"}) {
    const Column back = json["samples"][key];
    ASSERT_EQ(back.size(), numbers.size());
    for (std::size_t k = 0; k < back.size(); ++k) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(back[k]), std::bit_cast<std::uint64_t>(numbers[k])) << k;
    }
  }
  EXPECT_EQ(json["momentum_start"]["x"].get<double>(), numbers[3]);
  EXPECT_EQ(json["momentum_end"]["x"].get<double>(), numbers[10]);
}

TEST(Json, RefusesAConvergedResultWithANumberThatIsNotFinite) {
  struct Case {
    const char* field;
    std::function<void(Result&)> spoil;
  };
  const std::vector<Case> cases{
      {"duration is inf", [](Result& r) { r.solution.trajectory.times.back() = infinity; }},
      {"action is nan", [](Result& r) { r.solution.action = nan; }},
      {"energy is -inf", [](Result& r) { r.solution.energy = -infinity; }},
      {"energy_drift is nan", [](Result& r) { r.solution.energy_drift = nan; }},
      {"error_estimate is inf", [](Result& r) { r.solution.error_estimate = infinity; }},
      {"residual is nan", [](Result& r) { r.solution.residual = nan; }},
      {"momentum_start.y is nan", [](Result& r) { r.solution.momentum_start[1] = nan; }},
      {"momentum_end.x is inf", [](Result& r) { r.solution.momentum_end[0] = infinity; }},
      {"seconds.read is nan", [](Result& r) { r.seconds_read = nan; }},
      {"seconds.solve is nan", [](Result& r) { r.solution.seconds_solve = nan; }},
      {"seconds.analyse is nan", [](Result& r) { r.solution.seconds_analyse = nan; }},
      {"samples.t[1] is nan", [](Result& r) { r.samples->t[1] = nan; }},
      {"samples.x[0] is inf", [](Result& r) { r.samples->q[0][0] = infinity; }},
      {"samples.y'[1] is nan", [](Result& r) { r.samples->v[1][1] = nan; }},
      {"samples.p_y[0] is -inf", [](Result& r) { r.samples->p[1][0] = -infinity; }},
  };
  for (const Case& each : cases) {
    Result result = transfer_result();
    each.spoil(result);
    EXPECT_EQ(refusal<std::logic_error>(result),
              std::string("the result has converged, but its ") + each.field);
  }
}

TEST(Json, AFailedResultKeepsWhatIsFinite) {
  Result result = transfer_result();
  result.solution.status = Status::collision;
  result.solution.message = "x and y meet zero at t = 1.2";
  result.solution.action = infinity;
  result.solution.residual = nan;
  result.solution.momentum_start = {nan, 0.9};
  result.solution.momentum_end.clear();
  const Json json = parsed(result);
  EXPECT_EQ(json["status"], "collision");
  EXPECT_EQ(json["message"], "x and y meet zero at t = 1.2");
  EXPECT_EQ(json["strategy"], "newton from the guess");
  EXPECT_EQ(json["title"], "Planar transfer");
  EXPECT_EQ(json["iterations"], 5);
  EXPECT_EQ(json["seconds"]["solve"], 4e-5);
  EXPECT_EQ(json["duration"], 2.5);
  EXPECT_TRUE(json["action"].is_null());
  EXPECT_TRUE(json["residual"].is_null());
  EXPECT_TRUE(json["error_estimate"].is_null());
  EXPECT_EQ(json["momentum_start"].dump(), R"({"x":null,"y":0.9})");
  EXPECT_TRUE(json["momentum_end"].is_null());
  EXPECT_FALSE(json.contains("samples"));
}

TEST(Json, WritesMultipliersWhereTheyAreKnown) {
  Result result = transfer_result();
  for (const char* key : {"multipliers", "krein", "symplectic_defect"})
    EXPECT_TRUE(parsed(result)[key].is_null()) << key;
  Floquet& floquet = result.solution.floquet.emplace();
  floquet.multipliers = {{2, 0}, {0.6, 0.8}, {0.6, -0.8}, {0.5, 0}};
  floquet.krein = {0, -1, 1, 0};
  floquet.symplectic_defect = 1e-16;
  EXPECT_EQ(parsed(result)["multipliers"].dump(), "[[2.0,0.0],[0.6,0.8],[0.6,-0.8],[0.5,0.0]]");
  EXPECT_EQ(parsed(result)["krein"].dump(), "[0,-1,1,0]");
  EXPECT_EQ(parsed(result)["symplectic_defect"], 1e-16);
  result.solution.status = Status::not_converged;
  EXPECT_TRUE(parsed(result)["multipliers"].is_null());
}

TEST(Json, WritesEmptyListsOnlyWhereTheyAreKnown) {
  Result result = transfer_result();
  result.solution.conjugate_times.clear();
  result.solution.certificate = Certificate::global;
  EXPECT_EQ(parsed(result)["conjugate_times"].dump(), "[]");
  EXPECT_EQ(parsed(result)["certificate"], "global");
  result.solution.conjugate_times_known = false;
  EXPECT_TRUE(parsed(result)["conjugate_times"].is_null());
  EXPECT_FALSE(parsed(result)["windows"].is_null());
  result.solution.windows.clear();
  result.solution.certificate = Certificate::none;
  EXPECT_TRUE(parsed(result)["windows"].is_null());
  EXPECT_TRUE(parsed(result)["conjugate_times"].is_null());
}

TEST(Json, ASolutionNeverBegunHasNoNumbers) {
  const Json json = parsed(Result{.title = "", .names = {"x"}});
  EXPECT_EQ(json["status"], "not-converged");
  for (const char* field :
       {"duration", "action", "energy", "energy_drift", "error_estimate", "residual", "morse_index",
        "nullity", "certificate", "windows", "conjugate_times", "momentum_start", "momentum_end"}) {
    EXPECT_TRUE(json.at(field).is_null()) << field;
  }
  EXPECT_EQ(json["elements"], 0);
  EXPECT_EQ(json["minimizing"], false);
}

TEST(Json, EscapesTexts) {
  Result result = transfer_result();
  result.title = "\"quoted\"\n\\ τ \x01";
  result.solution.message = "bytes \xff\xfe that are no text";
  const Json json = parsed(result);
  EXPECT_EQ(json["title"], result.title);
  EXPECT_EQ(json["message"], "bytes \uFFFD\uFFFD that are no text");
}

TEST(Json, RefusesColumnsThatDoNotFit) {
  Result result = transfer_result();
  result.samples->v[1].pop_back();
  EXPECT_EQ(refusal<std::invalid_argument>(result), "samples have 1 velocities of \"y\" at 2 times");
  result = transfer_result();
  result.samples->p.pop_back();
  EXPECT_EQ(refusal<std::invalid_argument>(result), "samples have 1 columns of momenta for 2 coordinates");
  result = transfer_result();
  result.solution.momentum_end.push_back(0);
  EXPECT_EQ(refusal<std::invalid_argument>(result), "momentum_end has 3 entries for 2 coordinates");
}

TEST(Json, LargeSystemsKeepTheirKeys) {
  const int coordinates = 2000;
  Result result = transfer_result();
  result.names.clear();
  for (int i = 1; i <= coordinates; ++i) result.names.push_back("x[" + std::to_string(i) + "]");
  const std::vector<Column> columns(coordinates, Column{0.5, 0.25});
  result.samples = Samples{.t = {0, 1}, .q = columns, .v = columns, .p = columns};
  result.solution.momentum_start.assign(coordinates, 1);
  result.solution.momentum_end.assign(coordinates, 2);
  const Json json = parsed(result);
  EXPECT_EQ(json["samples"].size(), 3u * coordinates + 1);
  EXPECT_EQ(json["samples"]["p_x[2000]"][1], 0.25);
}

TEST(Json, AFileThatCannotBeWrittenIsNamed) {
  for (const std::string path : {"/dev/null/r.json", "/dev/full"}) {
    try {
      write_json(path, transfer_result());
      ADD_FAILURE() << path << " was written";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

TEST(Json, ARefusedResultLeavesNoFile) {
  const TemporaryFolder folder;
  const std::string path = folder / "r.json";
  Result result = transfer_result();
  result.samples->q[0][1] = nan;
  EXPECT_THROW(write_json(path, result), std::logic_error);
  EXPECT_FALSE(std::filesystem::exists(path));
  write_json(path, transfer_result());
  std::ifstream in(path);
  EXPECT_EQ(Json::parse(in)["duration"], 2.5);
}

}  // namespace
}  // namespace extremal
