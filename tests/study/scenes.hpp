#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "machine/folder.hpp"
#include "machine/long_test.hpp"
#include "machine/sanitizer.hpp"
#include "scene/source.hpp"
#include "solve/external/method.hpp"
#include "study/study.hpp"

/// \file Scenes in a folder of their own for each test.

namespace extremal::test {

class Scenes : public InFolder {
 protected:
  /// Under sanitizers, which take 25 times as long, with a budget in proportion where the scene gives none.
  Study study(const std::string& content, const std::vector<std::string>& sets = {}) {
    Study result = load(write("scene.toml", content), sets);
    if (EXTREMAL_ADDRESS_SANITIZER && result.budget == Study{}.budget) result.budget *= 25;
    return result;
  }
  /// What the scene is refused with, without the folder's name; "" if it is accepted.
  std::string message(const std::string& content, const std::vector<std::string>& sets = {}) {
    try {
      study(content, sets);
      return "";
    } catch (const SceneError& e) {
      return without_folder(e.what());
    }
  }
};

/// A free particle in the plane, among inequalities; the rest of [boundary] is to follow.
inline std::string free_particle(const std::string& constraints, const std::string& boundary) {
  return fmt::format(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n[path]\nconstraints = [{}]\n"
      "[boundary]\n{}",
      constraints, boundary);
}

/// Scenes with inequalities along the path, which need Ipopt.
class UnderInequalities : public Scenes {
 protected:
  void SetUp() override {
    if (!available(Method::ipopt)) GTEST_SKIP() << "built without Ipopt";
    Scenes::SetUp();
  }
  Solution found(const std::string& scene) {
    Solution solution = run(study(scene));
    EXPECT_TRUE(solution.converged()) << solution.message;
    return solution;
  }
};

/// Two coordinates and an array, parameters and a definition; [boundary] is to follow as line 6.
inline const std::string masses =
    "[system]\n"
    "coordinates = [\"x\", \"q[3]\"]\n"
    "parameters = { k = 4.0, m = [1, 2] }\n"
    "definitions = { v = \"k*x^2/2 + sum(i, 1, 3, q[i]^2/2)\" }\n"
    "lagrangian = \"m[2]*x'^2/2 + sum(i, 1, 3, q[i]'^2/2) - v\"\n";

inline const std::string ends = "[boundary]\nstart = { x = 0 }\nend = { x = 1 }\nduration = 2\n";

/// A coordinate of the guess at τ = t/T.
inline double guessed(const Study& study, double tau, int coordinate) {
  std::vector<double> q(study.problem.coordinates());
  study.problem.guess.at(tau, q);
  return q[coordinate];
}

}  // namespace extremal::test
