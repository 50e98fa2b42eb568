#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

/// \file What is known of the scenes of problems/: tests/data/problems.json.

namespace problems {

inline const std::string root = EXTREMAL_SOURCE_DIR;

struct Reference {
  std::string scene;     ///< its name in problems/scenes
  std::string quantity;  ///< "action", "momentum_start.x", "end.q[3]", …
  double value = 0;
  int digits = 0;                 ///< relative error at most 10^-digits
  std::vector<std::string> sets;  ///< changes to the scene, as for --set
};

inline void PrintTo(const Reference& reference, std::ostream* out) {
  *out << reference.quantity << " of " << reference.scene;
  for (const std::string& set : reference.sets) *out << " --set " << set;
}

/// In the order of the file.
inline std::vector<Reference> references() {
  std::ifstream in(root + "/tests/data/problems.json");
  const nlohmann::json file = nlohmann::json::parse(in);
  std::vector<Reference> result;
  for (const auto& c : file.at("cases"))
    result.push_back({c.at("scene"), c.at("quantity"), std::stod(c.at("value").get<std::string>()),
                      c.at("digits"), c.value("set", std::vector<std::string>{})});
  return result;
}

}  // namespace problems
