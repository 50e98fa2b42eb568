#include "solve/newton/zero_eigenvalue.hpp"

#include <algorithm>
#include <cmath>

#include "solve/mesh/roundoff.hpp"
#include "solve/newton/limits.hpp"

namespace extremal {

using namespace limits::zero_eigenvalue;

double zero_eigenvalue_along(double size, double error, int elements) {
  if (!(size > 0)) return zero_eigenvalue;
  return std::clamp(change * error / (size * elements), zero_eigenvalue, largest_zero);
}

double null_eigenvalue_of_branch(double size, double error, const Path& path) {
  const double roundoff = roundings_an_element * unit_roundoff * path.elements();
  return std::clamp(size > 0 ? change * error / (size * path.elements()) : 0, roundoff, largest_zero);
}

double largest_null_eigenvalue(double magnitude, double error, const Path& path) {
  const double roundoff = roundings_an_element * unit_roundoff * path.elements();
  return std::clamp(magnitude > 0 ? change * error / magnitude : 0, roundoff, zero_eigenvalue);
}

double doubt_of_eigenvalue(double size, double error) { return size > 0 ? change * error / size : INFINITY; }

Path bumped(const Path& path, double by, double size) {
  Path moved = path;
  for (int k = 1; k < path.elements(); ++k)
    for (int a = 0; a < path.coordinates(); ++a)
      moved.set_node(k, a, path.node(k)[a] + by * size * std::sin(k * (a + 1.0) + path.mesh()[k]));
  moved.load_ends();
  moved.set_duration(path.duration() * (1 + by));
  return moved;
}

}  // namespace extremal
