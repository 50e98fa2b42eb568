#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "command.hpp"

using namespace extremal::test;
using Json = nlohmann::json;

namespace {

const std::set<std::string> row_keys = {"method", "tolerance", "seconds", "error", "status"};

}  // namespace

TEST_F(Command, ComparesWithShooting) {
  write("scene.toml", pendulum);
  const Outcome o = extremal({"compare", "scene.toml", "--output", "c.json", "--plot", "c.svg"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(o.error, "");
  EXPECT_NE(o.out.find("single shooting"), std::string::npos) << o.out;
  EXPECT_NE(read_text(folder / "c.svg").find("<svg"), std::string::npos);
  const Json c = Json::parse(read_text(folder / "c.json"));
  ASSERT_EQ(c.size(), 2u);
  EXPECT_LE(c["reference"]["tolerance"].get<double>(), 1e-12);
  std::set<std::string> methods;
  for (const Json& row : c["rows"]) {
    std::set<std::string> keys;
    for (const auto& [key, value] : row.items()) keys.insert(key);
    EXPECT_EQ(keys, row_keys);
    methods.insert(row["method"].get<std::string>());
    EXPECT_EQ(row["status"], "converged");
    EXPECT_GT(row["seconds"].get<double>(), 0);
    // q ranges over 1.5.
    EXPECT_LE(row["error"].get<double>(), 10 * 1.5 * row["tolerance"].get<double>()) << row;
  }
  EXPECT_EQ(methods.size(), 4u);
}

TEST_F(Command, ComparesTheSchemeOfTheScene) {
  write("scene.toml", pendulum);
  const Outcome o =
      extremal({"compare", "scene.toml", "--output", "c.json", "--set", "solve.scheme=lobatto(4)"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const Json c = Json::parse(read_text(folder / "c.json"));
  EXPECT_EQ(c["rows"][0]["method"], "extremal, lobatto(4)");
}

TEST_F(Command, ComparisonWithoutASolution) {
  // From 0 to 1 in half a period of the oscillator: there is none.
  write("scene.toml",
        "[system]\ncoordinates = [\"q\"]\nlagrangian = \"(q'^2 - q^2)/2\"\n"
        "[boundary]\nstart = { q = 0.0 }\nend = { q = 1.0 }\nduration = \"pi\"\n");
  const Outcome o = extremal({"compare", "scene.toml", "--output", "c.json", "--plot", "c.svg"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_NE(o.error.find("error: scene.toml: no reference: "), std::string::npos) << o.error;
  const Json c = Json::parse(read_text(folder / "c.json"));
  EXPECT_TRUE(c["reference"].is_null());
  for (const Json& row : c["rows"]) EXPECT_TRUE(row["error"].is_null());
  EXPECT_EQ(c["rows"][0]["status"], "conjugate-ends");
  EXPECT_FALSE(fs::exists(folder / "c.svg"));
}

TEST_F(Command, ComparisonsThatAreRefused) {
  write("scene.toml", pendulum);
  EXPECT_EQ(extremal({"compare", "scene.toml", "--output", "scene.toml/c.json"}).error,
            "error: --output: 'scene.toml' is not a folder (see extremal help compare)\n");
  EXPECT_EQ(extremal({"compare", "scene.toml", "--plot", "c.gif"}).exit, 2);
  EXPECT_EQ(extremal({"compare", "missing.toml"}).exit, 2);
  EXPECT_EQ(extremal({"compare"}).exit, 2);
}
