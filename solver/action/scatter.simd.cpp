#include "action/element_kernels.hpp"

namespace extremal::EXTREMAL_LEVEL {

void scatter(const double* groups, int count, int used, bool add, double* const* to) {
  if (used > lanes) used = lanes;
  int c = 0;
  for (; c + lanes <= count; c += lanes) {
    Vec rows[lanes];
    for (int i = 0; i < lanes; ++i) rows[i] = group(groups, c + i);
    transpose(rows);
    for (int lane = 0; lane < used; ++lane)
      store(to[lane] + c, add ? rows[lane] + load(to[lane] + c) : rows[lane]);
  }
  for (; c < count; ++c)
    for (int lane = 0; lane < used; ++lane) to[lane][c] = (add ? to[lane][c] : 0) + groups[c * lanes + lane];
}

}  // namespace extremal::EXTREMAL_LEVEL
