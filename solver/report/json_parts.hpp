#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "report/result.hpp"

/// \file Parts of a result in JSON.

namespace extremal {

using Json = nlohmann::ordered_json;

/// Texts may hold any bytes; what is not UTF-8 is replaced.
inline std::string dumped(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// An ordered object looks for the key at each insertion; with the keys known to differ this would only
/// make large systems quadratic.
inline void append(Json& object, std::string key, Json value) {
  object.get_ref<Json::object_t&>().emplace_back(std::move(key), std::move(value));
}

/// Throws std::logic_error: what has converged is finite.
[[noreturn]] void refuse_number(const std::string& field, double value);

/// Each continues an object: a comma, then keys with values, lines indented. Throw as refuse_number().
void write_samples(std::ostream& out, const std::string& indent, const Samples& samples,
                   const std::vector<std::string>& names);
/// t, coordinates and velocities alone.
void write_motion(std::ostream& out, const std::string& indent, const Samples& samples,
                  const std::vector<std::string>& names);
/// "about": units and centres of the system, where there are any.
void write_about(std::ostream& out, const std::string& indent, const Annotation& annotation);
/// What pages show beside samples, where there is anything.
void write_surroundings(std::ostream& out, const std::string& indent, const Result& result);

}  // namespace extremal
