#include "study/suggestion.hpp"

#include <fmt/format.h>

#include "system/formula.hpp"

namespace extremal {

std::string suggestion(const std::string& name, std::span<const std::string> known,
                       const std::string& prefix) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? "" : fmt::format("; did you mean '{}{}'?", prefix, nearest);
}

SceneError suggested(const UnknownName& e) {
  return {e.at, e.message + suggestion(e.name, e.known, e.prefix)};
}

}  // namespace extremal
