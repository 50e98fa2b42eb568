#include "solve/external/external_solver.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace extremal {

void run_external_solver(Method method, const Problem& problem, const ElementTables& tables, Path& path,
                         [[maybe_unused]] const Deadline& deadline,
                         [[maybe_unused]] const std::function<bool()>& count) {
  if (method == Method::newton) return;
  if (!available(method))
    throw std::invalid_argument(fmt::format("method '{}' is not part of this build", name(method)));
  Displacement equations(problem, tables, path);
  std::vector<double> z(equations.size(), 0);
#ifdef EXTREMAL_CERES
  if (method == Method::ceres) solve_least_squares(equations, z, deadline, count);
#endif
#ifdef EXTREMAL_IPOPT
  if (method == Method::ipopt) solve_interior_point(equations, z, deadline, count);
#endif
  equations.evaluate(z, false);
}

}  // namespace extremal
