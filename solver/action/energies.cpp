#include "action/energies.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

std::vector<double> discrete_energies(const Lagrangian& lagrangian, const ElementTables& tables,
                                      const Path& path) {
  DiscreteAction action;
  action.reset(lagrangian, tables, path.elements(), true, false);
  std::vector<double> energies(path.elements());
  action.visit(path, false, [&](int batch, const BatchValues& values) {
    const int first = batch * path.lanes(), last = std::min(path.elements(), first + path.lanes());
    for (int k = first; k < last; ++k) energies[k] = -values.slope[k - first];
  });
  return energies;
}

double energy_unit(const DiscreteAction& action, double duration) {
  const double unit = std::abs(action.slope_duration()) + std::abs(action.action()) / duration;
  return unit > 0 ? unit : 1;
}

}  // namespace extremal
