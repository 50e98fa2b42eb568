#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "problems/reference.hpp"
#include "solution/extension_values.hpp"
#include "solve/external/method.hpp"
#include "study/study.hpp"

using namespace extremal;
using problems::Reference;

namespace {

Study study_of(const Reference& reference) {
  std::vector<std::string> sets{"solve.tolerance=1e-12"};
  sets.insert(sets.end(), reference.sets.begin(), reference.sets.end());
  return load(problems::root + "/problems/scenes/" + reference.scene + ".toml", sets);
}

/// The element of a quantity like "momentum_start.x[3]".
int index_of(const std::string& name, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument("no coordinate " + name);
  return static_cast<int>(found - names.begin());
}

double position(const Solution& solution, double t, int coordinate) {
  std::vector<double> q(solution.trajectory.coordinates), v(q.size());
  solution.trajectory.at(t, q, v);
  return q[coordinate];
}

double quantity(const std::string& text, const Solution& solution, const std::vector<std::string>& names) {
  if (text == "action") return solution.action;
  if (text == "energy") return solution.energy.value();
  if (text == "duration") return solution.duration();
  const std::size_t dot = text.find('.');
  const std::string kind = text.substr(0, dot);
  if (kind == "unknowns")
    for (const auto& [name, value] : solution.extension->unknowns)
      if (name == text.substr(dot + 1)) return value;
  const int coordinate = index_of(text.substr(dot + 1), names);
  if (kind == "momentum_start") return solution.momentum_start[coordinate];
  if (kind == "momentum_end") return solution.momentum_end[coordinate];
  if (kind == "start") return position(solution, 0, coordinate);
  if (kind == "end") return position(solution, solution.duration(), coordinate);
  throw std::invalid_argument("no quantity " + text);
}

class Scenes : public testing::TestWithParam<Reference> {};

TEST_P(Scenes, GiveTheKnownValue) {
  const Reference& reference = GetParam();
  const std::string path = problems::root + "/problems/scenes/" + reference.scene + ".toml";
  if (!available(Method::ipopt) && toml::parse_file(path).contains("path"))
    GTEST_SKIP() << "this build has no Ipopt, which inequalities need";
  const Study study = study_of(reference);
  const Solution solution = run(study);
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(quantity(reference.quantity, solution, study.system.names), reference.value,
              std::pow(10.0, -reference.digits) * std::abs(reference.value));
}

std::string test_name(const testing::TestParamInfo<Reference>& info) {
  std::string name = info.param.scene + "_" + info.param.quantity;
  for (const std::string& set : info.param.sets) name += "_" + set.substr(0, set.find('='));
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name + "_" + std::to_string(info.index);
}

INSTANTIATE_TEST_SUITE_P(Problems, Scenes, testing::ValuesIn(problems::references()), test_name);

}  // namespace
