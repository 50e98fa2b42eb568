#pragma once

#include "action/discrete_action.hpp"

namespace extremal {

/// |E| + |S|/T, or 1 where that is zero: by so much the right-hand sides differ if the energy closes them.
double energy_unit(const DiscreteAction& action, double duration);

}  // namespace extremal
