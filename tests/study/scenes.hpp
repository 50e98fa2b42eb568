#pragma once

#include <string>
#include <vector>

#include "machine/folder.hpp"
#include "scene/source.hpp"
#include "study/study.hpp"

/// \file Scenes in a folder of their own for each test.

namespace extremal::test {

class Scenes : public InFolder {
 protected:
  Study study(const std::string& content, const std::vector<std::string>& sets = {}) {
    return load(write("scene.toml", content), sets);
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
