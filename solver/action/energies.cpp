#include "action/energies.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

double energy_unit(const DiscreteAction& action, double duration) {
  const double unit = std::abs(action.slope_duration()) + std::abs(action.action()) / duration;
  return unit > 0 ? unit : 1;
}

}  // namespace extremal
