#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>

#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file What the names and formulas of a scene stand for in its system.

namespace extremal {

/// Calls f with the formula; its FormulaError becomes a SceneError at the place in the scene.
template <class Function>
auto placed(const Text& text, Function&& f) {
  try {
    return f(text.value);
  } catch (const FormulaError& e) {
    throw SceneError(position(text, e.offset), e.what());
  }
}

using Parameters = std::map<std::string, ParameterText>;

/// The number, or the value of the formula. Throws SceneError if it is not finite.
double evaluate(const Quantity& quantity, const Parameters& parameters);

/// A coordinate or an element of an array: q[first] … q[first + count - 1].
struct Range {
  int first = 0, count = 1;
  bool array = false;  ///< the whole of a declared array
};

/// What "x" or "x[2]" names. Throws UnknownName, with `keys` among the names that may be meant, or SceneError
/// for an index out of range.
Range range_of(const std::string& name, const Location& at, const System& system,
               std::vector<std::string> keys = {});

/// Calls f(coordinate, value) for each element that the assignment sets. Throws SceneError if the number of
/// values is wrong.
void for_each_value(const Assignment& assignment, const Range& range,
                    const std::function<void(int, const Quantity&)>& f);

}  // namespace extremal
