#include "system/momentum_step.hpp"

#include "machine/lanes.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

inline Vec size(Vec x) { return x < 0 ? -x : x; }

inline bool any(Mask mask) {
  long long some = 0;
  for (int k = 0; k < lanes; ++k) some |= mask[k];
  return some != 0;
}

/// Sizes up to this are known to the compiler.
constexpr int most_known = 3;

/// Exchanges a and b where `where` is set.
inline void exchange(Mask where, Vec& a, Vec& b) {
  const Vec before = a;
  a = where ? b : a;
  b = where ? before : b;
}

/// x, n × columns, becomes a⁻¹x: Gaussian elimination in which each lane exchanges rows by itself. Infinite
/// or not a number where a is singular.
template <int known>
void solve(Vec* a, Vec* x, int size_of_a, int columns) {
  const int n = known ? known : size_of_a;
  for (int k = 0; k < n; ++k) {
    Vec* pivot = a + k * n;
    for (int i = k + 1; i < n; ++i) {
      Vec* row = a + i * n;
      const Mask larger = size(row[k]) > size(pivot[k]);
      for (int j = k; j < n; ++j) exchange(larger, pivot[j], row[j]);
      for (int j = 0; j < columns; ++j) exchange(larger, x[k * columns + j], x[i * columns + j]);
    }
    pivot[k] = 1 / pivot[k];
    for (int i = k + 1; i < n; ++i) {
      Vec* row = a + i * n;
      const Vec factor = row[k] * pivot[k];
      for (int j = k + 1; j < n; ++j) row[j] -= factor * pivot[j];
      for (int j = 0; j < columns; ++j) x[i * columns + j] -= factor * x[k * columns + j];
    }
  }
  for (int i = n; i-- > 0;) {
    for (int k = i + 1; k < n; ++k)
      for (int j = 0; j < columns; ++j) x[i * columns + j] -= a[i * n + k] * x[k * columns + j];
    for (int j = 0; j < columns; ++j) x[i * columns + j] *= a[i * n + i];
  }
}

/// The matrix of the points from i on.
inline void gather(const double* rows, std::ptrdiff_t stride, const int* entries, int count, int i, Vec* to) {
  for (int e = 0; e < count; ++e) to[e] = entries[e] < 0 ? Vec{} : at(rows + entries[e] * stride + i);
}

/// Accepts the trial where it reduces |v − H_p| enough, else halves the step; returns how many go on. What is
/// not a number fails every comparison.
template <int known>
double advance(const MomentumRows& rows, const CoupledMomenta& coupled) {
  constexpr double largest = 0x1.fffffffffffffp1023;
  const Vec none{}, one = broadcast(1);
  const int n = known ? known : coupled.size;
  Vec memory[known ? known * (known + 1) : 1];
  Vec* const matrix = known ? memory : &at(rows.work);
  Vec* const next = matrix + n * n;
  Vec left{};
  for (int i = 0; i < rows.count; i += lanes) {
    const auto of = [&](auto* from, int k) -> auto& {
      return at(from + coupled.momenta[k] * rows.stride + i);
    };
    Vec &state = at(rows.state + i), &norm = at(rows.norm + i), &damping = at(rows.damping + i);
    const auto unit = [&](int k) { return known == 1 ? one : of(rows.unit, k); };
    const Vec scale = at(rows.scale + i);
    const Mask active = state == broadcast(searching);
    if (!any(active)) continue;

    Vec residual{};
    for (int k = 0; k < n; ++k) {
      next[k] = of(rows.v, k) - of(rows.slopes, k);
      residual += size(next[k]) / unit(k);
    }
    const Mask reduced = residual <= (one - damping / 4) * norm;
    gather(rows.slopes, rows.stride, coupled.entries, n * n, i, matrix);
    solve<known>(matrix, next, n, 1);
    Vec whole{}, change{};
    for (int k = 0; k < n; ++k) {
      next[k] = reduced ? next[k] : of(rows.step, k);
      const Vec from = reduced ? of(rows.trial, k) : of(rows.p, k);
      whole += size(from) * unit(k);
      change += size(next[k]) * unit(k);
    }
    const Vec rest = reduced ? residual : norm;
    const Vec doubled = 2 * damping < one ? 2 * damping : one;
    const Vec part = reduced ? doubled : damping / 2;
    const Mask last = reduced & ((change <= last_step * whole) | (rest <= last_residual * scale));
    const Mask stuck = ~reduced & (part <= broadcast(smallest_damping));

    Vec after = last ? broadcast(solved) : broadcast(searching);
    after = change <= broadcast(largest) ? after : broadcast(lost);
    const Vec given_up = rest <= unreduced_residual * scale ? broadcast(solved) : broadcast(lost);
    after = stuck ? given_up : after;
    const Mask stays = stuck | (after == broadcast(lost));
    for (int k = 0; k < n; ++k) {
      Vec &p = of(rows.p, k), &trial = of(rows.trial, k), &step = of(rows.step, k);
      const Vec from = reduced ? trial : p;
      const Vec to = stays ? from : from + (last ? one : part) * next[k];
      p = active ? (last ? to : from) : p;
      trial = active ? to : trial;
      step = active ? next[k] : step;
    }
    norm = active ? rest : norm;
    damping = active ? part : damping;
    state = active ? after : state;
    left += (active & (after == broadcast(searching))) ? one : none;
  }
  double sum = 0;
  for (int k = 0; k < lanes; ++k) sum += left[k];
  return sum;
}

template <int known>
void invert(const InverseRows& rows, const CoupledMomenta& coupled) {
  const int n = known ? known : coupled.size;
  Vec memory[known ? 2 * known * known : 1];
  Vec* const matrix = known ? memory : &at(rows.work);
  Vec* const inverse = matrix + n * n;
  for (int i = 0; i < rows.count; i += lanes) {
    gather(rows.matrix, rows.stride, coupled.entries, n * n, i, matrix);
    for (int e = 0; e < n * n; ++e) inverse[e] = broadcast(e % (n + 1) == 0);
    solve<known>(matrix, inverse, n, n);
    for (int e = 0; e < n * n; ++e) at(rows.inverse + e * rows.stride + i) = inverse[e];
  }
}

}  // namespace

/// From H_p and H_pp at the start, which is the trial: units in which H_pp has a diagonal of about 1
/// where it couples momenta.
void begin_momenta(const MomentumRows& rows, const CoupledMomenta& coupled) {
  const double infinite = __builtin_inf();
  const int n = coupled.size;
  for (int i = 0; i < rows.count; i += lanes) {
    Vec& state = at(rows.state + i);
    const Mask active = state != broadcast(solved);
    Vec scale{};
    for (int k = 0; k < n; ++k) {
      const std::ptrdiff_t row = coupled.momenta[k] * rows.stride + i;
      const int diagonal = coupled.entries[k * (n + 1)];
      const Vec of_h = diagonal < 0 ? Vec{} : size(at(rows.slopes + diagonal * rows.stride + i));
      Vec unit = broadcast(1);
      for (int j = 0; j < lanes; ++j)
        if (n > 1 && of_h[j] > 0 && of_h[j] < infinite) unit[j] = __builtin_sqrt(of_h[j]);
      const Vec v = at(rows.v + row);
      scale += (size(v - at(rows.slopes + row)) + size(v)) / unit;
      at(rows.unit + row) = active ? unit : at(rows.unit + row);
      at(rows.step + row) = active ? broadcast(__builtin_nan("")) : at(rows.step + row);
    }
    state = active ? broadcast(searching) : state;
    at(rows.norm + i) = active ? broadcast(infinite) : at(rows.norm + i);
    at(rows.scale + i) = active ? scale : at(rows.scale + i);
    at(rows.damping + i) = active ? broadcast(0.5) : at(rows.damping + i);
  }
}

double advance_momenta(const MomentumRows& rows, const CoupledMomenta& coupled) {
  static_assert(most_known == 3);
  switch (coupled.size) {
    case 1:
      return advance<1>(rows, coupled);
    case 2:
      return advance<2>(rows, coupled);
    case 3:
      return advance<3>(rows, coupled);
    default:
      return advance<0>(rows, coupled);
  }
}

void invert_coupled(const InverseRows& rows, const CoupledMomenta& coupled) {
  switch (coupled.size) {
    case 1:
      return invert<1>(rows, coupled);
    case 2:
      return invert<2>(rows, coupled);
    case 3:
      return invert<3>(rows, coupled);
    default:
      return invert<0>(rows, coupled);
  }
}

}  // namespace extremal::EXTREMAL_LEVEL
