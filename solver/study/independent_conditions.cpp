#include "study/independent_conditions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string>
#include <vector>

#include "solve/bordered/determinacy.hpp"
#include "study/path_constraints.hpp"

namespace extremal {
namespace {

[[noreturn]] void refuse_condition(const Text& text, const char* mend) {
  throw SceneError(position(text, 0), fmt::format("the condition '{}' follows from what else is given at the "
                                                  "ends, or contradicts it; {}",
                                                  text.value, mend));
}

[[noreturn]] void refuse_unknown(const Scene& scene, const Indeterminacy& found) {
  const Assignment& unknown = scene.boundary.unknowns[found.last];
  std::vector<std::string> others;
  for (const int k : found.constants)
    if (k != found.last) others.push_back(fmt::format("'{}'", scene.boundary.unknowns[k].name));
  for (const int j : found.integrals)
    others.push_back(fmt::format("the multiplier of '{}'", scene.boundary.integrals[j].value));
  const std::string mend =
      fmt::format("leave '{}' out of the unknowns, and one condition out of 'where'", unknown.name);
  if (others.empty())
    throw SceneError(unknown.name_at,
                     fmt::format("no equation of the path and no condition contains '{}', so nothing "
                                 "determines it; {}",
                                 unknown.name, mend));
  throw SceneError(
      unknown.name_at,
      fmt::format("all equations and conditions contain '{}' and {} in one combination alone, so "
                  "nothing determines each of them; {}",
                  unknown.name, fmt::join(others, ", "), mend));
}

}  // namespace

void check_determined(const Scene& scene, const ExtendedScene& parts, const Problem& problem) {
  std::optional<Indeterminacy> found = indeterminacy(problem.pair ? *problem.pair : problem);
  if (!found) return;
  // With forces each copy has all conditions.
  if (found->kind == Indeterminacy::Kind::condition) found->last %= std::ssize(parts.conditions);
  switch (found->kind) {
    case Indeterminacy::Kind::integral: {
      const Text& text = scene.boundary.integrals[found->last];
      throw SceneError(position(text, 0),
                       fmt::format("the ends and the integrals before it determine the integral '{}', or "
                                   "contradict it; leave it out",
                                   text.value));
    }
    case Indeterminacy::Kind::condition:
      // Of a problem with constraints those that are independent are chosen near its guess.
      if (!problem.manifold) refuse_condition(parts.conditions[found->last], "leave it out");
      return;
    case Indeterminacy::Kind::where:
      if (inequalities_vary(scene)) return;  // what contacts determine
      refuse_condition(parts.where[found->last],
                       scene.boundary.unknowns.empty()
                           ? "give the duration, or 'energy' instead of 'where'"
                           : "write one that other values of the unknowns break, or fix an unknown");
    case Indeterminacy::Kind::constant:
      if (inequalities_vary(scene)) return;
      refuse_unknown(scene, *found);
  }
}

}  // namespace extremal
