#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "solve/laws.hpp"
#include "study/study.hpp"

/// \file Scenes with their solutions to 16 digits, and published cases.

namespace extremal::laws {

/// q(t) and q'(t) at given times, n entries each.
struct Table {
  Values t;
  std::vector<State> states;
};

/// Columns t, the n coordinates, their n velocities.
Table read_table(const std::string& path, int n);

/// Of the text of a scene.
Study study_of(const std::string& scene);

inline std::string bench_data(const std::string& name) {
  return std::string(EXTREMAL_SOURCE_DIR) + "/bench/data/" + name;
}

/// The case of a file of tests/data/reference.
nlohmann::json published(const std::string& file, const std::string& id);

/// A decimal string, a list of them.
double decimal(const nlohmann::json& text);
Values decimals(const nlohmann::json& list);

}  // namespace extremal::laws
