#pragma once

#include <vector>

#include "action/discrete_action.hpp"

namespace extremal {

/// The discrete energy −∂L_d/∂h of each element of a path on these tables, in units of L (Chen-Guo-Wu (3.3)).
std::vector<double> discrete_energies(const Lagrangian& lagrangian, const ElementTables& tables,
                                      const Path& path);

/// |E| + |S|/T, or 1 where that is zero: by so much the right-hand sides differ if the energy closes them.
double energy_unit(const DiscreteAction& action, double duration);

}  // namespace extremal
