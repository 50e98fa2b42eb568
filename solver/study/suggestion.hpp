#pragma once

#include <span>
#include <string>
#include <utility>

#include "scene/source.hpp"

/// \file The nearest name that exists, for a name that does not.

namespace extremal {

/// "; did you mean 'kepler'?", or nothing where no known name is near. `prefix` is written before the name.
std::string suggestion(const std::string& name, std::span<const std::string> known,
                       const std::string& prefix = "");

/// The message of an unknown name with its suggestion, or with the choices if they are few.
SceneError suggested(const UnknownName& error);
SceneError suggested(const UnknownChoice& error);

/// Calls f. An UnknownName becomes a SceneError with a suggestion.
template <class Function>
auto with_suggestion(Function&& f) {
  try {
    return std::forward<Function>(f)();
  } catch (const UnknownChoice& e) {
    throw suggested(e);
  } catch (const UnknownName& e) {
    throw suggested(e);
  }
}

}  // namespace extremal
