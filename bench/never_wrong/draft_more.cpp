#include <fmt/format.h>

#include <algorithm>

#include "draft.hpp"

namespace bench {
namespace {

constexpr double searches = 0.06, families = 0.08;

bool has(const Entries& entries, const std::string& key) {
  return std::any_of(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == key; });
}

void draw_search(Draft& draft) {
  draft.kind = "search";
  draft.search.emplace_back("solutions", std::to_string(draft.random.between(2, 8)));
}

/// The duration, the energy or a parameter; not far, so that it takes a second at most.
void draw_family(Draft& draft) {
  Random& random = draft.random;
  const bool by_energy = has(draft.boundary, "energy"), free = has(draft.guess, "duration");
  const auto put = [&](const std::string& parameter, double from) {
    draft.kind = "family";
    draft.continuation.emplace_back("parameter", quoted(parameter));
    draft.continuation.emplace_back("to", number_text(from * random.uniform(0.6, 1.6)));
    draft.continuation.emplace_back("points", std::to_string(random.between(3, 12)));
  };
  if (by_energy && random.chance(0.6)) return put("energy", draft.motion.energy);
  const bool isolated = draft.recipe.forced && draft.kind == "periodic";
  if (!free && !isolated && draft.recipe.autonomous && random.chance(0.6))
    return put("duration", draft.duration());
  if (draft.varied.empty()) return;
  const auto& [name, value] = random.pick(draft.varied);
  put(name, std::stod(value));
}

}  // namespace

void draw_more(Draft& draft) {
  const double x = draft.random.unit();
  if (draft.kind == "initial" || (draft.recipe.forced && x < searches)) return;
  if (x < searches) return draw_search(draft);
  const bool pinned = has(draft.solve, "scheme");
  if (x < searches + families && !pinned) draw_family(draft);
}

}  // namespace bench
