#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file What the names and formulas of a scene stand for in its system.

namespace extremal {

/// A formula that cannot be read, or names what does not exist.
struct FaultyFormula : SceneError {
  using SceneError::SceneError;
};

/// Calls f with the formula; its FormulaError becomes a FaultyFormula at the place in the scene. That of a
/// definition goes on, see make_system.
template <class Function>
auto placed(const Text& text, Function&& f) {
  try {
    return f(text.value);
  } catch (const FormulaError& e) {
    if (e.where.starts_with("definitions.")) throw;
    throw FaultyFormula(position(text, e.offset), e.what());
  }
}

/// The number, or the value of the formula, where `index` > 0 with the index i. Throws SceneError if it is
/// not finite.
double evaluate(const Quantity& quantity, const Vocabulary& vocabulary, int index = 0);

/// The same of a quantity that may be a word too ("free") and is none. Throws UnknownName where the formula
/// is such a word, misspelt.
double evaluate_beside(const std::vector<std::string>& words, const Quantity& quantity,
                       const Vocabulary& vocabulary);

/// A coordinate or an element of an array: q[first] … q[first + count - 1].
struct Range {
  int first = 0, count = 1;
  bool array = false;  ///< the whole of a declared array
  int index = 0;       ///< of the first in its array; 0 for a coordinate that is none
};

/// Whether "p_x" names the momentum of a coordinate.
bool is_momentum(const std::string& name, const System& system);

/// What "x" or "x[2]" names. Throws UnknownName, with `keys` among the names that may be meant, or SceneError
/// for an index out of range.
Range range_of(const std::string& name, const Location& at, const System& system,
               std::vector<std::string> keys = {});

/// Calls f(coordinate, value, index) for each element that the assignment sets; one formula serves all
/// elements of an array. The index is that of the element, 0 without an array. Throws SceneError if the
/// number of values is wrong.
void for_each_value(const Assignment& assignment, const Range& range,
                    const std::function<void(int, const Quantity&, int)>& f);

}  // namespace extremal
