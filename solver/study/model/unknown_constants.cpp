#include "study/model/unknown_constants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "system/formula.hpp"

namespace extremal {

namespace {

bool starts_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

Scene with_unknowns(Scene scene) {
  for (const Assignment& unknown : scene.boundary.unknowns) {
    if (unknown.list)
      throw SceneError(unknown.at, fmt::format("'{}' must be one number, the guess", unknown.name));
    const auto same = [&](const Assignment& p) { return p.name == unknown.name; };
    const auto known = std::ranges::find_if(scene.system.parameters, same);
    if (known == scene.system.parameters.end())
      scene.system.parameters.push_back(unknown);
    else if (known->list)
      throw SceneError(unknown.name_at,
                       fmt::format("'{}' is a list; an unknown must be one number", unknown.name));
    else
      known->values = unknown.values;
  }
  return scene;
}

bool any_of(const std::set<std::string>& names, const Dependents& dependents) {
  return std::ranges::any_of(names, [&](const std::string& name) { return dependents.contains(name); });
}

const std::string* as_formula(const Quantity& quantity) { return std::get_if<std::string>(&quantity.value); }

Dependents dependents_of(const Scene& scene) {
  Dependents found;
  for (const Assignment& unknown : scene.boundary.unknowns) found.insert(unknown.name);
  for (std::size_t before = 0; before != found.size();) {
    before = found.size();
    for (const Definition& d : scene.system.definitions)
      if (any_of(names_in(d.formula.value), found)) found.insert(d.name);
    for (const Assignment& p : scene.system.parameters)
      for (const Quantity& q : p.values)
        if (as_formula(q) && any_of(names_in(*as_formula(q)), found)) found.insert(p.name);
  }
  return found;
}

Dependents constants_of(const Scene& scene, const Dependents& dependents) {
  std::set<std::string> varying{"t"};
  for (const Text& c : scene.system.coordinates) varying.insert(c.value.substr(0, c.value.find('[')));
  for (std::size_t before = 0; before != varying.size();) {
    before = varying.size();
    for (const Definition& d : scene.system.definitions)
      if (any_of(names_in(d.formula.value), varying)) varying.insert(d.name);
  }
  Dependents constants;
  std::ranges::set_difference(dependents, varying, std::inserter(constants, constants.end()));
  return constants;
}

std::size_t Rewritten::original(std::size_t offset) const {
  std::size_t before = 0;
  for (const std::size_t place : added)
    if (place < offset) before += std::min<std::size_t>(3, offset - place);
  return offset - before;
}

Rewritten rewritten(const std::string& text, const Dependents& constants) {
  Rewritten result;
  for (std::size_t i = 0; i < text.size();) {
    if (!starts_name(text[i])) {
      // Digits and the letters of an exponent are no names.
      std::size_t end = i + 1;
      if (std::isdigit(static_cast<unsigned char>(text[i])) || text[i] == '.')
        while (end < text.size() && (in_name(text[end]) || text[end] == '.')) ++end;
      result.text += text.substr(i, end - i);
      i = end;
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && in_name(text[end])) ++end;
    const std::string name = text.substr(i, end - i);
    const std::size_t next = text.find_first_not_of(' ', end);
    result.text += name;
    if (constants.contains(name) && !(next != std::string::npos && text[next] == '(')) {
      result.added.push_back(result.text.size());
      result.text += "(0)";
    }
    i = end;
  }
  return result;
}

}  // namespace extremal
