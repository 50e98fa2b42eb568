#include "study/model/dependence.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "system/formula.hpp"

namespace extremal {

bool names_any(const std::string& formula, const std::set<std::string>& names) {
  return std::ranges::any_of(names_in(formula),
                             [&](const std::string& name) { return names.contains(name); });
}

bool names_any(const Quantity& quantity, const std::set<std::string>& names) {
  const auto* formula = std::get_if<std::string>(&quantity.value);
  return formula && names_any(*formula, names);
}

bool names_any(const std::vector<Assignment>& assignments, const std::set<std::string>& names) {
  return std::ranges::any_of(assignments, [&](const Assignment& a) {
    return std::ranges::any_of(a.values, [&](const Quantity& q) { return names_any(q, names); });
  });
}

std::set<std::string> with_dependent(std::set<std::string> names, const SystemTable& table) {
  for (std::size_t before = 0; before < names.size();) {
    before = names.size();
    for (const Definition& definition : table.definitions)
      if (names_any(definition.formula.value, names)) names.insert(definition.name);
    for (const Assignment& parameter : table.parameters)
      if (names_any({parameter}, names)) names.insert(parameter.name);
  }
  return names;
}

}  // namespace extremal
