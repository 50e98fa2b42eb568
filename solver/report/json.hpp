#pragma once

#include <iosfwd>
#include <string>

#include "report/result.hpp"

/// \file The result as a JSON object.

namespace extremal {

/// Writes one object, keys in the order of the documentation, numbers that read back as the same double.
/// The solutions of a search follow the fields of the first as "solutions", each an object of its own.
/// A result that has not converged is written without samples, and what is not finite in it as null.
/// Throws std::logic_error with the name of the field if a converged result holds an infinity or a NaN,
/// and std::invalid_argument if samples or momenta do not have one entry a coordinate.
void write_json(std::ostream& out, const Result& result);

/// The same into a file. Throws std::runtime_error with the path if it cannot be written; what was written
/// in part is removed.
void write_json(const std::string& path, const Result& result);

}  // namespace extremal
