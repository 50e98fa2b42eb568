#include "solve/method.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace extremal {

const char* name(Method method) {
  switch (method) {
    case Method::ceres:
      return "ceres";
    case Method::ipopt:
      return "ipopt";
    default:
      return "newton";
  }
}

const char* description(Method method) {
  switch (method) {
    case Method::ceres:
      return "least squares";
    case Method::ipopt:
      return "an interior point method";
    default:
      return "Newton's method";
  }
}

bool available([[maybe_unused]] Method method) {
#ifndef EXTREMAL_CERES
  if (method == Method::ceres) return false;
#endif
#ifndef EXTREMAL_IPOPT
  if (method == Method::ipopt) return false;
#endif
  return true;
}

void lead(Method method, const Problem& problem, const ElementTables& tables, Path& path,
          [[maybe_unused]] const std::function<bool()>& count) {
  if (method == Method::newton) return;
  if (!available(method))
    throw std::invalid_argument(fmt::format("method '{}' is not part of this build", name(method)));
  Displacement equations(problem, tables, path);
  std::vector<double> z(equations.size(), 0);
#ifdef EXTREMAL_CERES
  if (method == Method::ceres) solve_least_squares(equations, z, count);
#endif
#ifdef EXTREMAL_IPOPT
  if (method == Method::ipopt) solve_interior_point(equations, z, count);
#endif
  equations.evaluate(z, false);
}

}  // namespace extremal
