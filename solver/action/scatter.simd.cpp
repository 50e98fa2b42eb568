#include "action/element_kernels.hpp"

namespace extremal::EXTREMAL_LEVEL {

void scatter(const double* groups, int count, int used, bool add, double* const* to) {
  if (used > lanes) used = lanes;
  int c = 0;
  for (; c + 8 <= count; c += 8) {
    Vec rows[8];
    for (int i = 0; i < 8; ++i) rows[i] = group(groups, c + i);
    transpose(rows);
    for (int lane = 0; lane < used; ++lane) {
      if (add) rows[lane] += load_eight(to[lane] + c);
      __builtin_memcpy(to[lane] + c, rows + lane, sizeof(Vec));
    }
  }
  for (; c < count; ++c)
    for (int lane = 0; lane < used; ++lane) to[lane][c] = (add ? to[lane][c] : 0) + groups[c * lanes + lane];
}

}  // namespace extremal::EXTREMAL_LEVEL
