#include <cmath>
#include <nlohmann/json.hpp>

#include "command.hpp"

using namespace extremal::test;
using Json = nlohmann::json;

namespace {

constexpr double pendulum_slope = 1.3736908728527137;  // q'(0), by integration in 113-bit arithmetic

}  // namespace

TEST_F(Command, SolvesAndSummarises) {
  const Outcome o = solve(pendulum);
  EXPECT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(o.error, "");
  EXPECT_NE(o.out.find("converged"), std::string::npos) << o.out;
}

TEST_F(Command, QuietWritesNothing) {
  const std::string family = pendulum + "[continuation]\nparameter = \"duration\"\nto = 2.5\npoints = 3\n";
  for (const char* command : {"solve", "compare", "continue"}) {
    write("scene.toml", family);
    const Outcome o = extremal({command, "scene.toml", "--quiet"});
    EXPECT_EQ(o.exit, 0) << o.error;
    EXPECT_EQ(o.out + o.error, "") << command;
  }
}

TEST_F(Command, RatesThatAreInfiniteAtAnEndAreNull) {
  write(
      "scene.toml",
      "[system]\ncoordinates = [\"y\"]\nlagrangian = \"sqrt((1 + y'^2)/y)\"\n[boundary]\nstart = { y = 0 }\n"
      "end = { y = 1 }\nduration = 1\n");
  const Outcome o = extremal({"solve", "scene.toml", "--quiet", "--output", "-", "--samples", "3", "--csv",
                              "y.csv", "--plot", "y.svg"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const Json result = Json::parse(o.out);
  EXPECT_TRUE(result["momentum_start"].is_null());
  EXPECT_TRUE(result["momentum_end"]["y"].is_number());
  EXPECT_EQ(result["samples"]["y"][0], 0);
  for (const char* key : {"y'", "p_y"}) {
    EXPECT_TRUE(result["samples"][key][0].is_null()) << key;
    EXPECT_TRUE(result["samples"][key][1].is_number()) << key;
    EXPECT_TRUE(result["samples"][key][2].is_number()) << key;
  }
  EXPECT_NE(read_text(folder / "y.csv").find("\n0,0,,\n"), std::string::npos) << read_text(folder / "y.csv");
}

TEST_F(Command, FamiliesWithEndsAtInfinity) {
  const std::string system =
      "[system]\ncoordinates = [\"x\"]\nparameters = { a = 1.0 }\nlagrangian = \"x'^2/2 + (x^2 - a)^2/4\"\n"
      "[boundary]\nstart = { x = \"-sqrt(a)\" }\nend = { x = \"sqrt(a)\" }\nduration = \"infinite\"\n"
      "[continuation]\nto = 4.0\npoints = 10\n";
  write("scene.toml", system + "parameter = \"a\"\n");
  const Outcome o = extremal({"continue", "scene.toml", "--quiet", "--output", "-"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const Json branch = Json::parse(o.out);
  EXPECT_EQ(branch["status"], "converged");
  ASSERT_EQ(branch["points"].size(), 10u);
  for (const Json& point : branch["points"]) {
    const double a = point["parameter"];
    EXPECT_NEAR(point["action"].get<double>(), 2 * std::sqrt(2.0) / 3 * std::pow(a, 1.5), 1e-8) << a;
    EXPECT_EQ(point["morse_index"], 0) << a;
  }
  EXPECT_EQ(branch["points"].back()["parameter"], 4.0);
  write("scene.toml", system + "parameter = \"duration\"\n");
  const Outcome refused = extremal({"continue", "scene.toml", "--quiet"});
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.error.find("vary a parameter"), std::string::npos) << refused.error;
}

TEST_F(Command, AFailureIsToldOnce) {
  for (const std::string search : {"", "[search]\nsolutions = 3\n"}) {
    const Outcome o = solve(
        "[system]\ncoordinates = [\"q\"]\nlagrangian = \"q'^2/2 - exp(q)\"\n[boundary]\nstart = { q = 0 }\n"
        "end = { q = 0 }\nduration = 4\n" +
        search);
    EXPECT_EQ(o.exit, 1) << o.out;
    const std::string message = o.error.substr(0, o.error.find('\n')).substr(o.error.rfind(": ") + 2);
    EXPECT_EQ(o.out.find(message), std::string::npos) << o.out;
    EXPECT_EQ(o.out.find("solve 0.00 ns"), std::string::npos) << o.out;
  }
}

TEST_F(Command, SolveLeavesAContinuationAside) {
  write("scene.toml", pendulum + "[continuation]\nparameter = \"energy\"\nto = 1\n");
  EXPECT_EQ(extremal({"solve", "scene.toml", "--quiet"}).exit, 0);
  EXPECT_EQ(extremal({"compare", "scene.toml", "--quiet"}).exit, 0);
  for (const char* command : {"continue", "check"}) {
    const Outcome o = extremal({command, "scene.toml"});
    EXPECT_EQ(o.exit, 2);
    EXPECT_NE(o.error.find("varying the energy needs"), std::string::npos) << o.error;
  }
}

TEST_F(Command, MomentaThatAreGiven) {
  std::string scene = pendulum;
  scene.replace(scene.find("q = 0.0 }"), 9, "p_q = \"1.3736908728527137\" }");
  const Outcome o = solve(scene + "[guess]\nq = \"1.5*t/T\"\n", {"--output", "r.json", "--at", "0"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(o.out.find("natural condition"), std::string::npos) << o.out;
  const Json r = Json::parse(read_text(folder / "r.json"));
  EXPECT_NEAR(r["samples"]["q"][0].get<double>(), 0, 1e-9);
  EXPECT_NEAR(r["momentum_start"]["q"].get<double>(), pendulum_slope, 1e-10);
  const Outcome checked = extremal({"check", "scene.toml"});
  EXPECT_NE(
      checked.out.find("not fixed      at the start q(0) with p_q = 1.3736908728527137; at the end none"),
      std::string::npos)
      << checked.out;
  EXPECT_EQ(extremal({"compare", "scene.toml", "--quiet"}).exit, 0);
}

/// The equations of one element that passes the centre at its middle hold by symmetry, with an infinite
/// action.
TEST_F(Command, PathsThroughASingularityAreNoSolutions) {
  const Outcome o = solve(
      "[system]\nuse = \"kepler\"\n"
      "[boundary]\nperiodic = true\nmap = { x = \"-x\", y = \"-y\" }\nduration = 0.025\n"
      "[guess]\nx = \"-0.16 - 0.1*sin(2*pi*t/T)\"\ny = \"-0.14 + 0.38*sin(2*pi*t/T + 3)\"\n"
      "[solve]\nscheme = \"simpson\"\nelements = 1\n");
  EXPECT_EQ(o.exit, 1) << o.out;
  EXPECT_NE((o.out + o.error).find("singularity"), std::string::npos) << o.out << o.error;
}

TEST_F(Command, WritesJsonWithSamples) {
  const Outcome o =
      solve(pendulum, {"--output", "r.json", "--samples", "5", "--set", "solve.tolerance=1e-12"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const Json r = Json::parse(read_text(folder / "r.json"));
  EXPECT_EQ(r["status"], "converged");
  EXPECT_EQ(r["title"], "Pendulum");
  EXPECT_EQ(r["duration"], 2.0);
  EXPECT_EQ(r["samples"]["t"], (std::vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(r["samples"]["q"][0], 0.0);
  EXPECT_EQ(r["samples"]["q"][4], 1.5);
  EXPECT_NEAR(r["momentum_start"]["q"].get<double>(), pendulum_slope, 1e-11);
  EXPECT_NEAR(r["samples"]["q'"][0].get<double>(), pendulum_slope, 1e-10);
  EXPECT_EQ(r["samples"]["q'"], r["samples"]["p_q"]);
  EXPECT_GT(r["seconds"]["read"].get<double>(), 0);
}

TEST_F(Command, SamplesAtTimes) {
  ASSERT_EQ(solve(pendulum, {"--output", "r.json", "--at", "0.25,2,0"}).exit, 0);
  EXPECT_EQ(Json::parse(read_text(folder / "r.json"))["samples"]["t"], (std::vector<double>{0.25, 2, 0}));
  const Outcome beyond = solve(pendulum, {"--output", "s.json", "--at", "0.5,2.5"});
  EXPECT_EQ(beyond.exit, 2);
  EXPECT_EQ(beyond.error, "error: --at: 2.5 is beyond the duration 2\n");
  EXPECT_FALSE(fs::exists(folder / "s.json"));
  EXPECT_EQ(solve(pendulum, {"--at", "-1"}).error, "error: --at: -1 is before the start; times run from 0\n");
  EXPECT_EQ(solve(pendulum, {"--at", "1,,2"}).error, "error: --at: '' is not a time; write T1,T2,…\n");
}

TEST_F(Command, WritesCsvAndPlot) {
  const Outcome o = solve(pendulum, {"--csv", "r.csv", "--plot", "r.svg"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const std::string csv = read_text(folder / "r.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "t,q,q',p_q");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 202);
  EXPECT_NE(read_text(folder / "r.svg").find("<svg"), std::string::npos);
}

TEST_F(Command, SeveralSolutions) {
  const std::vector<std::string> search{"--set", "search.solutions=9", "--set", "boundary.duration=12"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), search.begin(), search.end());
    return solve(pendulum, more);
  };
  const Outcome o = with({"--output", "r.json", "--csv", "r.csv", "--plot", "r.svg", "--samples", "5"});
  ASSERT_EQ(o.exit, 0) << o.error;
  Json r = Json::parse(read_text(folder / "r.json"));
  const Json list = r["solutions"];
  ASSERT_GT(list.size(), 2u);
  EXPECT_LT(list.size(), 9u);
  for (std::size_t k = 0; k < list.size(); ++k) {
    EXPECT_EQ(list[k]["status"], "converged");
    EXPECT_EQ(list[k]["samples"]["q"][0], 0.0);
    EXPECT_EQ(list[k]["samples"]["q"][4], 1.5);
    EXPECT_EQ(list[k]["windows"].back()[1], 12.0);
    EXPECT_TRUE(list[k]["morse_index"].is_number());
    if (k > 0) {
      EXPECT_GT(list[k]["action"], list[k - 1]["action"]);
    }
  }
  r.erase("solutions");
  EXPECT_EQ(r, list[0]);
  EXPECT_NE(o.out.find("of up to 9 extremals found"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("solution  "), std::string::npos) << o.out;
  const std::string csv = read_text(folder / "r.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "solution,t,q,q',p_q");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), static_cast<std::ptrdiff_t>(1 + 5 * list.size()));
  EXPECT_NE(csv.find("\n" + std::to_string(list.size()) + ",12,1.5,"), std::string::npos);

  const Outcome again = with({"--output", "s.json", "--samples", "5", "--repeat", "2", "--quiet"});
  EXPECT_EQ(again.exit, 0);
  EXPECT_EQ(again.out + again.error, "");
  Json s = Json::parse(read_text(folder / "s.json"))["solutions"];
  ASSERT_EQ(s.size(), list.size());
  for (std::size_t k = 0; k < s.size(); ++k) {
    s[k]["seconds"] = list[k]["seconds"];
    EXPECT_EQ(s[k], list[k]);
  }
}

/// q'' = −4 eᑫ has no solution between zeros a time of 1 apart.
TEST_F(Command, ASearchThatFindsNothing) {
  const Outcome o = solve(
      "[system]\ncoordinates = [\"q\"]\nlagrangian = \"q'^2/2 - 4*exp(q)\"\n[boundary]\nstart = { q = 0 }\n"
      "end = { q = 0 }\nduration = 1\n[search]\nsolutions = 3\n",
      {"--output", "r.json"});
  EXPECT_EQ(o.exit, 1);
  const Json r = Json::parse(read_text(folder / "r.json"));
  EXPECT_NE(r["status"], "converged");
  EXPECT_EQ(r["solutions"], Json::array());
}

TEST_F(Command, AResultServesAsTheGuessOfAnother) {
  ASSERT_EQ(solve(pendulum, {"--output", "r.json", "--samples", "40"}).exit, 0);
  const Outcome o = solve(pendulum, {"--set", "guess.file=r.json", "--set", "boundary.duration=2.1"});
  EXPECT_EQ(o.exit, 0) << o.error;
}

TEST_F(Command, OutputIsDeterministic) {
  const auto result = [&](const char* name) {
    solve(pendulum, {"--output", name, "--samples", "9", "--repeat", "3"});
    Json r = Json::parse(read_text(folder / name));
    r.erase("seconds");
    return r.dump();
  };
  EXPECT_EQ(result("a.json"), result("b.json"));
}

TEST_F(Command, ThreadsChangeNothing) {
  const std::string chain =
      "[system]\nuse = \"fpu-chain\"\nparameters = { n = 12 }\n[boundary]\n"
      "start = { q = [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.5, 0.4, 0.3, 0.2, 0.1, 0] }\n"
      "end = { q = [0.1, 0, -0.1, -0.2, -0.3, -0.4, -0.4, -0.3, -0.2, -0.1, 0, 0.1] }\n"
      "duration = 20\n[solve]\ntolerance = 1e-12\n";
  std::vector<Json> results;
  for (const char* threads : {"1", "2", "3"}) {
    ::setenv("EXTREMAL_THREADS", threads, 1);
    const Outcome o = solve(chain, {"--output", "r.json", "--samples", "9"});
    ::unsetenv("EXTREMAL_THREADS");
    ASSERT_EQ(o.exit, 0) << o.error << o.out;
    results.push_back(Json::parse(read_text(folder / "r.json")));
    results.back().erase("seconds");
  }
  EXPECT_EQ(results[1], results[0]);
  EXPECT_EQ(results[2], results[0]);
  ::setenv("EXTREMAL_THREADS", "none", 1);
  const Outcome refused = solve(chain);
  ::unsetenv("EXTREMAL_THREADS");
  EXPECT_EQ(refused.exit, 2);
  EXPECT_EQ(refused.error, "error: EXTREMAL_THREADS=none: need a number from 1 to 1024\n");
}
