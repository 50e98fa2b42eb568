#include "solve/newton/agreement.hpp"

#include <span>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Rows of `lanes` numbers, `coordinates` rows a point.
void average(std::span<double> rows, int coordinates, int lanes) {
  const std::size_t half = static_cast<std::size_t>(coordinates / 2) * lanes;
  for (std::size_t point = 0; point < rows.size(); point += 2 * half)
    for (std::size_t i = point; i < point + half; ++i)
      rows[i] = rows[i + half] = 0.5 * (rows[i] + rows[i + half]);
}

}  // namespace

void make_agree(Step& step, int coordinates) {
  average(step.nodes, coordinates, 1);
  average({step.inner.data(), step.inner.size()}, coordinates, simd_lanes());
}

}  // namespace extremal
