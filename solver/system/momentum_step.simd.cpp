#include "system/momentum_step.hpp"

#include "machine/lanes.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

inline Vec size(Vec x) { return x < 0 ? -x : x; }

}  // namespace

/// Accepts the trial where it reduces |v − H_p| enough, else halves the step; returns how many go on. What is
/// not a number fails every comparison.
double advance_momentum(const MomentumRows& rows, int count) {
  constexpr double largest = 0x1.fffffffffffffp1023;
  const Vec none{}, one = broadcast(1);
  Vec left{};
  for (int i = 0; i < count; i += lanes) {
    const auto here = [i](double* row) -> Vec& { return at(row + i); };
    Vec &p = here(rows.p), &trial = here(rows.trial), &step = here(rows.step), &state = here(rows.state);
    Vec &norm = here(rows.norm), &damping = here(rows.damping);
    const Vec scale = at(rows.scale + i), residual = at(rows.v + i) - at(rows.slope + i);

    const Mask reduced = size(residual) <= (one - damping / 4) * norm;
    const Vec from = reduced ? trial : p;
    const Vec next = reduced ? residual / at(rows.curvature + i) : step;
    const Vec rest = reduced ? size(residual) : norm;
    const Vec doubled = 2 * damping < one ? 2 * damping : one;
    const Vec part = reduced ? doubled : damping / 2;
    const Mask last = reduced & ((size(next) <= last_step * size(from)) | (rest <= last_residual * scale));
    const Mask stuck = ~reduced & (part <= broadcast(smallest_damping));

    Vec after = last ? broadcast(solved) : broadcast(searching);
    after = size(next) <= broadcast(largest) ? after : broadcast(lost);
    const Vec given_up = rest <= unreduced_residual * scale ? broadcast(solved) : broadcast(lost);
    after = stuck ? given_up : after;
    Vec to = from + (last ? one : part) * next;
    to = (stuck | (after == broadcast(lost))) ? from : to;

    const Mask active = state == broadcast(searching);
    p = active ? (last ? to : from) : p;
    trial = active ? to : trial;
    step = active ? next : step;
    norm = active ? rest : norm;
    damping = active ? part : damping;
    state = active ? after : state;
    left += (active & (after == broadcast(searching))) ? one : none;
  }
  double sum = 0;
  for (int k = 0; k < lanes; ++k) sum += left[k];
  return sum;
}

}  // namespace extremal::EXTREMAL_LEVEL
