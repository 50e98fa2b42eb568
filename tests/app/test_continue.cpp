#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "command.hpp"

using namespace extremal::test;
using Json = nlohmann::json;

namespace {

/// Bratu's problem, from the lower branch; λ = 3.513830719 is its fold.
const std::string bratu =
    "[system]\ncoordinates = [\"q\"]\nparameters = { lambda = 1.0, m = [1.0, 2.0] }\n"
    "lagrangian = \"m[1]*q'^2/2 - lambda*exp(q)\"\n"
    "[boundary]\nstart = { q = 0.0 }\nend = { q = 0.0 }\nduration = 1.0\n"
    "[continuation]\nparameter = \"lambda\"\nto = 4.0\npoints = 30\n";

const std::set<std::string> point_keys = {"branch", "parameter",   "duration", "energy",
                                          "action", "morse_index", "nullity",  "multipliers",
                                          "krein",  "kind",        "start"};

std::string bratu_with(const std::string& from, const std::string& to) {
  std::string s = bratu;
  return s.replace(s.find(from), from.size(), to);
}

std::string continued(const std::string& parameter, const std::string& to) {
  return bratu_with("parameter = \"lambda\"\nto = 4.0\n",
                    "parameter = \"" + parameter + "\"\nto = " + to + "\n");
}

}  // namespace

TEST_F(Command, ContinuesAFamily) {
  write("scene.toml", bratu);
  const Outcome o =
      extremal({"continue", "scene.toml", "--output", "b.json", "--csv", "b.csv", "--plot", "b.svg"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(o.error, "");
  EXPECT_NE(o.out.find("3.513830719"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("30 points have been found"), std::string::npos) << o.out;
  EXPECT_NE(read_text(folder / "b.svg").find("<svg"), std::string::npos);
  const Json b = Json::parse(read_text(folder / "b.json"));
  ASSERT_EQ(b.size(), 6u);
  EXPECT_EQ(b["varied"], "lambda");
  EXPECT_TRUE(b["title"].is_string());
  ASSERT_EQ(b["branches"].size(), 1u);
  EXPECT_EQ(b["branches"][0]["origin"], nullptr);
  EXPECT_EQ(b["branches"][0]["points"], 30);
  EXPECT_LE(b["branches"][0]["action_defect"], 1e-7);
  EXPECT_LE(b["branches"][0]["momentum_defect"], 1e-8);  // ten times the tolerance
  EXPECT_EQ(b["status"], "converged");
  ASSERT_EQ(b["points"].size(), 30u);
  int folds = 0;
  for (const Json& point : b["points"]) {
    std::set<std::string> keys;
    for (const auto& [key, value] : point.items()) keys.insert(key);
    EXPECT_EQ(keys, point_keys);
    EXPECT_EQ(point["branch"], 0);
    EXPECT_EQ(point["multipliers"], nullptr);
    EXPECT_EQ(point["start"]["q"], 0.0);
    EXPECT_GT(point["start"]["q'"].get<double>(), 0);
    if (point["kind"] != "fold") continue;
    ++folds;
    EXPECT_NEAR(point["parameter"].get<double>(), 3.513830719125162, 1e-8);
  }
  EXPECT_EQ(folds, 1);
  const std::string csv = read_text(folder / "b.csv");
  EXPECT_EQ(csv.rfind("branch,parameter,duration,energy,action,morse_index,nullity,kind,q,q'\n0,1,1,", 0), 0u)
      << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 31);
}

TEST_F(Command, APlotShowsTheQuantityAsked) {
  write("scene.toml", bratu_with("points = 30", "points = 6"));
  const Outcome o = extremal({"continue", "scene.toml", "--plot", "b.svg", "--quantity", "q'(0)/lambda"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_NE(read_text(folder / "b.svg").find("q'(0)/lambda"), std::string::npos);
  ASSERT_EQ(extremal({"continue", "scene.toml", "--plot", "b.svg"}).exit, 0);
  EXPECT_NE(read_text(folder / "b.svg").find("amplitude of q"), std::string::npos);
  EXPECT_EQ(extremal({"continue", "scene.toml", "--plot", "b.svg", "--quantity", "q'(0)/lamda"}).error,
            "error: --quantity: 'q'(0)/lamda': column 7: unknown name 'lamda'; did you mean 'lambda'?\n");
  EXPECT_EQ(extremal({"continue", "scene.toml", "--quantity", "q'(0)"}).error,
            "error: --quantity says what --plot shows; give a file to --plot\n");
}

TEST_F(Command, ContinuesToTheValueAsked) {
  write("scene.toml", bratu_with("to = 4.0", "to = 2.0"));
  const Outcome o = extremal({"continue", "scene.toml", "--output", "b.json"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_NE(o.out.find("the branch leads to 2"), std::string::npos) << o.out;
  EXPECT_EQ(Json::parse(read_text(folder / "b.json"))["points"].back()["parameter"], 2.0);
}

TEST_F(Command, ContinuesWithoutAFirstPoint) {
  // There is none beyond the fold.
  write("scene.toml", bratu_with("lambda = 1.0", "lambda = 3.8"));
  const Outcome o = extremal({"continue", "scene.toml", "--output", "b.json", "--plot", "b.svg"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_NE(o.error.find("error: scene.toml: no extremal to begin with: "), std::string::npos) << o.error;
  const Json b = Json::parse(read_text(folder / "b.json"));
  EXPECT_EQ(b["status"], "not-converged");
  EXPECT_TRUE(b["points"].empty());
  EXPECT_FALSE(fs::exists(folder / "b.svg"));
}

TEST_F(Command, FamiliesThatAreRefused) {
  const auto refusal = [&](const std::string& scene) {
    write("scene.toml", scene);
    const Outcome o = extremal({"continue", "scene.toml"});
    EXPECT_EQ(o.exit, 2);
    return o.error;
  };
  EXPECT_EQ(refusal(continued("lambdo", "4")),
            "error: scene.toml:10:14: unknown parameter 'lambdo'; did you mean 'lambda'?\n");
  EXPECT_EQ(refusal(continued("m", "4")),
            "error: scene.toml:10:14: 'm' is a list; a continued parameter must be one number\n");
  EXPECT_EQ(refusal(continued("lambda", "1.0")),
            "error: scene.toml:11:6: lambda is 1 already; give another value for 'to'\n");
  EXPECT_EQ(refusal(continued("duration", "-1.0")),
            "error: scene.toml:11:6: to = -1; a duration must be positive\n");
  EXPECT_EQ(
      refusal(continued("energy", "-1.0")),
      "error: scene.toml:10:14: varying the energy needs duration = \"free\" and 'energy' in [boundary]\n");
  EXPECT_EQ(
      refusal(bratu.substr(0, bratu.find("[continuation]"))),
      "error: scene.toml: the table [continuation] is missing; it names the parameter and its last value\n");
  const std::string free =
      "[boundary]\nstart = { q = 0.0 }\nend = { q = 0.0 }\nduration = \"free\"\nenergy = 2\n"
      "[guess]\nduration = 1\n[continuation]\nparameter = \"duration\"\nto = 2\n";
  EXPECT_EQ(refusal(bratu.substr(0, bratu.find("[boundary]")) + free),
            "error: scene.toml:13:14: the duration is free, so it cannot be varied; vary \"energy\" or a "
            "parameter\n");
  write("scene.toml", bratu);
  EXPECT_EQ(extremal({"continue", "scene.toml", "--plot", "b.gif"}).exit, 2);
  EXPECT_EQ(extremal({"continue", "scene.toml", "--output", "scene.toml/b.json"}).error,
            "error: --output: 'scene.toml' is not a folder (see extremal help continue)\n");
}
