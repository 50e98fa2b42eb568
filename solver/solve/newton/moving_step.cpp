#include "solve/newton/moving_step.hpp"

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "action/tables.hpp"
#include "solve/newton/limits.hpp"

namespace extremal {

using namespace limits::moving_step;

/// q' and the shift of each node, rounded so that t/T of the nodes moves by exactly as much. False where it
/// matters to no element.
bool MovingStep::measure_shift(const Step& step, double factor, const Path& path) {
  const std::size_t n = path.coordinates(), degree = path.degree(), elements = path.elements(),
                    size = (degree + 1) * n;
  const Basis& basis = lobatto_nodal_basis(path.degree());
  slopes_.resize(elements * size);
  for (std::size_t k = 0; k < elements; ++k)
    path.element_slopes(static_cast<int>(k), basis.derivative, slopes_.data() + k * size);
  const std::span<const double> mesh = path.mesh();
  shift_.assign(elements + 1, 0);
  bool matters = false;
  for (std::size_t k = 1; k < elements; ++k) {
    double along = 0, square = 0;
    for (std::size_t a = 0; a < n; ++a) {
      double& left = slopes_[k * size - n + a];
      double& right = slopes_[k * size + a];
      left = right = 0.5 * (left + right);
      along += right * step.nodes[k * n + a];
      square += right * right;
    }
    if (!(square > 0)) continue;
    const double wanted = -factor * along / square / path.duration();
    shift_[k] = (mesh[k] + wanted) - mesh[k];
    const double shortest = std::min(path.lengths()[k - 1], path.lengths()[k]);
    matters = matters || std::abs(wanted) > least_part * shortest;
  }
  return matters;
}

/// Whether elements keep their order, and about their lengths.
bool MovingStep::keeps_elements(const Path& path) const {
  for (int k = 0; k < path.elements(); ++k)
    if (!(std::abs(shift_[k + 1] - shift_[k]) < most_stretch * path.lengths()[k])) return false;
  return true;
}

/// What moving the nodes makes of deviations from the chord.
void MovingStep::shift_inner(const Path& path) {
  const double T = path.duration();
  const std::size_t n = path.coordinates(), degree = path.degree(), size = (degree + 1) * n;
  const int lanes = path.lanes();
  const std::vector<double>& tau = SchemeTables::of_lobatto(path.degree()).lobatto;
  for (int place = 0; place < path.batches() * lanes; ++place) {
    const int k = std::min(place, path.elements() - 1);  // idle lanes copy the last element
    double* const inner =
        inner_.data() + static_cast<std::size_t>(place / lanes) * size * lanes + place % lanes;
    const double *const v = slopes_.data() + k * size, *const last = v + degree * n;
    for (std::size_t j = 1; j < degree; ++j)
      for (std::size_t a = 0; a < n; ++a) {
        const double left = (1 - tau[j]) * shift_[k], right = tau[j] * shift_[k + 1], here = v[j * n + a];
        inner[((j - 1) * n + a) * lanes] += T * (left * (here - v[a]) + right * (here - last[a]));
      }
  }
}

void MovingStep::add(const Step& step, double factor, Path& path) {
  const bool moves = measure_shift(step, factor, path) && keeps_elements(path);
  if (!moves) std::fill(shift_.begin(), shift_.end(), 0.0);
  const std::size_t n = path.coordinates(), size = path.nodes().size(), elements = path.elements(),
                    slopes = (static_cast<std::size_t>(path.degree()) + 1) * n;
  inner_ = step.inner;
  for (double& x : inner_) x *= factor;
  if (moves) shift_inner(path);
  nodes_.reset(size, 1);
  const bool exact = step.nodes_low.size() == size;
  for (std::size_t i = 0; i < size; ++i) {
    nodes_.set(i, 0, {path.nodes()[i], path.rest(0)[i]});
    nodes_.add(i, 0, {factor * step.nodes[i], exact ? factor * step.nodes_low[i] : 0});
    const std::size_t k = i / n;
    if (moves && k > 0 && k < elements)
      nodes_.add(
          i, 0,
          extended_arithmetic().multiply({shift_[k], 0}, {path.duration() * slopes_[k * slopes + i % n], 0}));
  }
  if (moves) path.move_mesh(shift_, 1, 1 - most_stretch);
  zero_.assign(size, 0);
  path.add(zero_, inner_, 1);
  for (std::size_t i = 0; i < size; ++i)
    path.set_node(static_cast<int>(i / n), static_cast<int>(i % n), nodes_.high(i)[0], nodes_.low(i)[0]);
}

}  // namespace extremal
