#include "study/suggestion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

SceneError suggested(const UnknownChoice& e) {
  constexpr std::size_t most_listed = 12;
  std::string mend = suggestion(e.name, e.known, e.prefix);
  if (mend.empty() && !e.known.empty() && e.known.size() <= most_listed)
    mend = fmt::format("; there {} '{}'", e.known.size() == 1 ? "is" : "are", fmt::join(e.known, "', '"));
  return {e.at, e.message + mend};
}

}  // namespace extremal
