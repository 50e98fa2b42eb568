#include <algorithm>

#include "action/discrete_action.hpp"
#include "machine/simd.hpp"

namespace extremal {

/// Lᵀ x = −L_eᵀ, row by row from the last: x_j = −Σ_{i>j} L_ij x_i, where x is the identity at the ends.
void DiscreteAction::inner_by_ends(int k, std::span<double> fields) const {
  const Fronts& fronts = condensation_->fronts;
  const std::size_t batch = k / lanes_, lane = k % lanes_, columns = 2 * n_;
  const double *matrix = this->matrix(batch) + lane,
               *inverse = inverses_.data() + batch * sizes_.vector + lane;
  for (int f = fronts.count() - 1; f >= 0; --f) {
    const FrontView& front = fronts.data()[f];
    for (int j = front.pivots - 1; j >= 0; --j) {
      double* const field = fields.data() + front.unknown[j] * columns;
      std::fill_n(field, columns, 0.0);
      for (int i = j + 1; i < front.rows; ++i) {
        const std::size_t place = front.panel + static_cast<std::size_t>(i) * front.pivots + j;
        const double factor = matrix[place * lanes_] * inverse[(front.first + j) * lanes_];
        const int unknown = front.unknown[i];
        if (unknown >= inner_) {
          field[unknown - inner_] -= factor;
          continue;
        }
        const double* const later = fields.data() + unknown * columns;
        for (std::size_t e = 0; e < columns; ++e) field[e] -= factor * later[e];
      }
    }
  }
}

}  // namespace extremal
