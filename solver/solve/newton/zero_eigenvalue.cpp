#include "solve/newton/zero_eigenvalue.hpp"

#include <algorithm>

#include "solve/mesh/roundoff.hpp"

namespace extremal {

namespace {

/// An eigenvalue of a path that errs by ε of its extent errs by ε times the relative change of the second
/// derivatives of L, which is about 3 for a force 1/r².
constexpr double change = 3;
/// However much a path errs, an eigenvalue that is not small is not zero.
constexpr double largest_zero = 1e-3;
/// Of an elimination, if all are in one sense.
constexpr double roundings_an_element = 16;

}  // namespace

double zero_eigenvalue_along(double size, double error, int elements) {
  if (!(size > 0)) return zero_eigenvalue;
  return std::clamp(change * error / (size * elements), zero_eigenvalue, largest_zero);
}

double largest_null_eigenvalue(double magnitude, double error, const Path& path) {
  const double roundoff = roundings_an_element * unit_roundoff * path.elements();
  return std::clamp(magnitude > 0 ? change * error / magnitude : 0, roundoff, zero_eigenvalue);
}

}  // namespace extremal
