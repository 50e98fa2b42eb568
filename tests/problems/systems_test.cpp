#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "problems/reference.hpp"
#include "solve/external/curve_fit.hpp"
#include "solve/external/method.hpp"
#include "study/annotation.hpp"
#include "study/inspection.hpp"
#include "study/study.hpp"

using namespace extremal;
namespace fs = std::filesystem;

namespace {

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(problems::root + "/problems/" + folder))
    if (entry.path().extension() == ".toml") names.insert(entry.path().stem());
  return names;
}

std::string scene_path(const std::string& name) {
  return problems::root + "/problems/scenes/" + name + ".toml";
}

TEST(Systems, AreDocumented) {
  const std::set<std::string> systems = names_in("systems");
  ASSERT_GE(systems.size(), 20u);
  for (const std::string& name : systems) {
    const toml::table file = toml::parse_file(problems::root + "/problems/systems/" + name + ".toml");
    for (const char* key : {"summary", "formula", "units", "reference"}) {
      const auto text = file["about"][key].value<std::string>();
      ASSERT_TRUE(text.has_value()) << name << " lacks " << key;
      EXPECT_FALSE(text->empty()) << name << ": " << key;
    }
    EXPECT_LE(file["about"]["summary"].value<std::string>()->size(), 110u) << name;
    EXPECT_TRUE(file["about"]["invariants"].is_array()) << name;
    ASSERT_TRUE(file["about"]["sources"].is_array()) << name;
    EXPECT_FALSE(file["about"]["sources"].as_array()->empty()) << name;
  }
}

TEST(Systems, HaveASceneAndAKnownValueEach) {
  std::set<std::string> used, known;
  for (const std::string& name : names_in("scenes")) {
    const auto system = toml::parse_file(scene_path(name))["system"]["use"].value<std::string>();
    if (system) used.insert(*system);
    for (const problems::Reference& reference : problems::references())
      if (system && reference.scene == name) known.insert(*system);
  }
  for (const std::string& name : names_in("systems")) {
    EXPECT_TRUE(used.contains(name)) << "no scene uses " << name;
    EXPECT_TRUE(known.contains(name)) << "tests/data/problems.json knows nothing of " << name;
  }
}

class EveryScene : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!can_fit() && toml::parse_file(scene_path(GetParam())).contains("fit"))
      GTEST_SKIP() << "this build has no Ceres, which fits need";
    if (!available(Method::ipopt) && toml::parse_file(scene_path(GetParam())).contains("path"))
      GTEST_SKIP() << "this build has no Ipopt, which inequalities need";
  }
};

TEST_P(EveryScene, HasRightDerivatives) {
  const DerivativeCheck check = inspect(load(scene_path(GetParam()))).derivatives;
  EXPECT_TRUE(check.agree()) << check.gradient.name << " off by " << check.gradient.error << ", "
                             << check.hessian.name << " by " << check.hessian.error;
}

TEST_P(EveryScene, HasAPictureWithAnnotations) { EXPECT_NO_THROW(annotation(load(scene_path(GetParam())))); }

/// But for those that say how many elements there are, and those of which data determine the ends.
TEST_P(EveryScene, KeepsItsEnergy) {
  Study study = load(scene_path(GetParam()));
  if (study.fit) return;
  const bool pinned = study.options.elements > 0;
  if (!pinned) study.options.tolerance = 1e-11;
  const Solution solution = run(study);
  ASSERT_TRUE(solution.converged()) << solution.message;
  if (pinned || !solution.energy_drift) return;
  EXPECT_LE(*solution.energy_drift, 1e-8 * std::max(1.0, std::abs(*solution.energy)));
}

INSTANTIATE_TEST_SUITE_P(Problems, EveryScene, testing::ValuesIn(names_in("scenes")), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
