#include "action/element.hpp"
#include "action/element_kernels.hpp"
#include "machine/lanes.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// Σ over one entry of a table of point sums, of the row `row` (one group a point).
inline Vec sum_points(const PointSums& table, int entry, const double* row) {
  Vec s0 = broadcast(0), s1 = broadcast(0);
  int e = table.start[entry];
  const int end = table.start[entry + 1];
  for (; e + 1 < end; e += 2) {
    s0 += table.coefficient[e] * group(row, table.point[e]);
    s1 += table.coefficient[e + 1] * group(row, table.point[e + 1]);
  }
  if (e < end) s0 += table.coefficient[e] * group(row, table.point[e]);
  return s0 + s1;
}

inline const double* row_of(const ElementShape& s, const ElementBatch& b, int row) {
  return b.rows + static_cast<long>(row) * s.points * lanes;
}

void expand(const ElementShape& s, const ElementBatch& b) {
  const int inner = s.functions - 2, n = s.n;
  const Vec h = at(b.h), rate = 1.0 / h;
  for (int a = 0; a < n; ++a) {
    const Vec qa = group(b.x, inner * n + a), delta = group(b.x, (inner + 1) * n + a);
    double* q = b.q + static_cast<long>(a) * s.points * lanes;
    double* v = s.velocity_free ? nullptr : b.v + static_cast<long>(a) * s.points * lanes;
    for (int i = 0; i < s.points; ++i) {
      const double* value = s.value + i * s.functions;
      Vec chord = delta * s.node[i];
      if (!s.nodal) {
        for (int j = 0; j < inner; ++j) chord += value[j] * group(b.x, j * n + a);
      } else if (i > 0 && i <= inner) {
        chord += group(b.x, (i - 1) * n + a);
      }
      group(q, i) = qa + chord;
      if (!v) continue;
      const double* slope = s.slope + i * s.functions;
      Vec d = delta;
      for (int j = 0; j < inner; ++j) d += slope[j] * group(b.x, j * n + a);
      group(v, i) = d * rate;
    }
  }
  if (b.t)
    for (int i = 0; i < s.points; ++i) group(b.t, i) = at(b.start) + h * s.node[i];
}

/// K x of the kinetic energy: dev parts by the stiffness, ends by the chord alone, since ∫ φ_j' = 0.
inline Vec stiffness_times(const ElementShape& s, const ElementBatch& b, int function, int a) {
  const int inner = s.functions - 2, n = s.n;
  if (function == inner) return -group(b.x, (inner + 1) * n + a);
  if (function > inner) return group(b.x, (inner + 1) * n + a);
  Vec sum0 = broadcast(0), sum1 = broadcast(0);
  const double* k = s.stiffness + function * s.functions;
  int j = 0;
  for (; j + 1 < inner; j += 2) {
    sum0 += k[j] * group(b.x, j * n + a);
    sum1 += k[j + 1] * group(b.x, (j + 1) * n + a);
  }
  if (j < inner) sum0 += k[j] * group(b.x, j * n + a);
  return sum0 + sum1;
}

/// ½ q'ᵀMq' integrated, times h: adds M K x/h to the gradient, returns xᵀ(K ⊗ M)x/2.
Vec kinetic(const ElementShape& s, const ElementBatch& b, const Vec& rate, double* gradient) {
  const int inner = s.functions - 2, n = s.n;
  Vec energy = broadcast(0);
  for (int e = 0; e < s.mass_count; ++e) {
    const EntryView& m = s.mass[e];
    for (int f = 0; f < s.functions; ++f) {
      const Vec kx = m.value * stiffness_times(s, b, f, m.column);
      group(gradient, f * n + m.row) += kx * rate;
      if (f < inner) energy += kx * group(b.x, f * n + m.row);
      if (f > inner) energy += kx * group(b.x, f * n + m.row);
    }
  }
  return 0.5 * energy;
}

/// q'ᵀCq and aᵀq' integrated: independent of h. Coordinates in the basis (d, q_a, q_b = q_a + Δ).
Vec gyroscopic(const ElementShape& s, const ElementBatch& b, double* gradient) {
  const int inner = s.functions - 2, n = s.n, count = s.functions;
  Vec action = broadcast(0);
  for (int e = 0; e < s.gyroscopic_count; ++e) {
    const EntryView& c = s.gyroscopic[e];
    for (int j = 0; j < count; ++j) {
      Vec right = broadcast(0), left = broadcast(0);
      for (int k = 0; k < count; ++k) {
        Vec xq = group(b.x, k * n + c.column), xv = group(b.x, k * n + c.row);
        if (k > inner) {
          xq += group(b.x, inner * n + c.column);
          xv += group(b.x, inner * n + c.row);
        }
        right += s.gyration[j * count + k] * xq;
        left += s.gyration[k * count + j] * xv;
      }
      group(gradient, j * n + c.row) += c.value * right;
      group(gradient, j * n + c.column) += c.value * left;
      Vec xj = group(b.x, j * n + c.row);
      if (j > inner) xj += group(b.x, inner * n + c.row);
      action += c.value * right * xj;
    }
  }
  for (int a = 0; a < s.linear_count; ++a) {
    group(gradient, inner * n + a) -= s.linear[a];
    group(gradient, (inner + 1) * n + a) += s.linear[a];
    action += s.linear[a] * group(b.x, (inner + 1) * n + a);
  }
  return action;
}

void gradient(const ElementShape& s, const ElementBatch& b, double* action, double* out, double* slope_h) {
  const int n = s.n;
  const Vec h = at(b.h), rate = 1.0 / h;
  for (int k = 0; k < s.functions * n; ++k) group(out, k) = broadcast(0);
  const Vec energy = s.mass_count ? kinetic(s, b, rate, out) : broadcast(0);
  Vec potential = broadcast(0);
  const double* values = row_of(s, b, 0);
  for (int i = 0; i < s.points; ++i) potential += s.weight[i] * group(values, i);
  Vec momentum = broadcast(0);  // Σ b_i R_v·q', for ∂L_d/∂h
  for (int g = 0; g < s.gradient_count; ++g) {
    const int z = s.gradient[g];
    const double* row = row_of(s, b, 1 + g);
    if (z < n) {
      for (int f = 0; f < s.functions; ++f) group(out, f * n + z) += h * sum_points(s.value_sum, f, row);
    } else {
      for (int f = 0; f < s.functions; ++f) group(out, f * n + z - n) += sum_points(s.slope_sum, f, row);
      if (slope_h) {
        const double* v = b.v + static_cast<long>(z - n) * s.points * lanes;
        for (int i = 0; i < s.points; ++i) momentum += s.weight[i] * group(row, i) * group(v, i);
      }
    }
  }
  at(action) = energy * rate + h * potential;
  if (s.gyroscopic_count || s.linear_count) at(action) += gyroscopic(s, b, out);
  if (slope_h) at(slope_h) = potential - momentum - energy * rate * rate;
}

/// Adds to the next place; an entry on the diagonal that stands for itself and its mirror image is marked
/// by the complement of its place, and counts twice.
inline void place(double* matrix, const int*& slot, const Vec& value) {
  const int at = *slot++;
  if (at >= 0)
    group(matrix, at) += value;
  else
    group(matrix, ~at) += 2.0 * value;
}

/// K ⊗ M/h and the gyroscopic coupling.
void constant_hessian(const ElementShape& s, const Vec& rate, const int*& slot, double* matrix) {
  const int count = s.functions;
  for (int e = 0; e < s.mass_count; ++e) {
    if (s.mass[e].column > s.mass[e].row) continue;
    const Vec scale = s.mass[e].value * rate;
    for (int j = 0; j < count; ++j)
      for (int k = 0; k <= j; ++k) {
        const double stiffness = s.stiffness[j * count + k];
        if (stiffness == 0) continue;
        const Vec value = stiffness * scale;
        place(matrix, slot, value);
        if (s.mass[e].column != s.mass[e].row && j != k) place(matrix, slot, value);
      }
  }
  for (int e = 0; e < s.gyroscopic_count; ++e)
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < count; ++k)
        place(matrix, slot, broadcast(s.gyroscopic[e].value * s.gyration[j * count + k]));
}

void hessian(const ElementShape& s, const ElementBatch& b, const int* slot, double* matrix) {
  const int n = s.n, count = s.functions;
  const Vec h = at(b.h), rate = 1.0 / h;
  constant_hessian(s, rate, slot, matrix);
  for (int e = 0; e < s.hessian_count; ++e) {
    const int zr = s.hessian[e].row, zc = s.hessian[e].column;
    const double* row = row_of(s, b, 1 + s.gradient_count + e);
    const bool mixed = zr >= n && zc < n;
    const PointSums& table = mixed ? s.slope_value : zc >= n ? s.slope_slope : s.value_value;
    const Vec scale = mixed ? broadcast(1) : zc >= n ? rate : h;
    int pair = 0;
    for (int j = 0; j < count; ++j)
      for (int k = 0; k <= (mixed ? count - 1 : j); ++k, ++pair) {
        if (table.start[pair] == table.start[pair + 1]) continue;
        const Vec value = scale * sum_points(table, pair, row);
        place(matrix, slot, value);
        if (!mixed && zr != zc && j != k) place(matrix, slot, value);
      }
  }
}

/// With q' = (…)/h at fixed unknowns, ∂q'/∂h = −q'/h, and L_d = h Σ b_i L_i gives
///   ∂²L_d/∂x∂h = Σ b_i [φ (L_q − L_qv q') − φ' L_vv q'/h],   ∂²L_d/∂h² = Σ b_i q'ᵀL_vv q'/h.
void border(const ElementShape& s, const ElementBatch& b, double* out, double* corner) {
  const int n = s.n;
  const Vec h = at(b.h), rate = 1.0 / h;
  for (int k = 0; k < s.functions * n; ++k) group(out, k) = broadcast(0);
  Vec second = broadcast(0);
  if (s.mass_count) {
    const Vec energy = kinetic(s, b, -rate * rate, out);
    second = 2.0 * energy * rate * rate * rate;
  }
  for (int g = 0; g < s.gradient_count; ++g) {
    const int z = s.gradient[g];
    if (z >= n) continue;
    for (int f = 0; f < s.functions; ++f)
      group(out, f * n + z) += sum_points(s.value_sum, f, row_of(s, b, 1 + g));
  }
  for (int e = 0; e < s.hessian_count; ++e) {
    const int zr = s.hessian[e].row, zc = s.hessian[e].column;
    if (zr < n) continue;
    const double* row = row_of(s, b, 1 + s.gradient_count + e);
    for (int pass = 0; pass < (zr == zc || zc < n ? 1 : 2); ++pass) {
      // (target, velocity): L_{q_c v_r} v_r into φ of q_c, or L_{v_a v_c} v_c into φ' of q_a.
      const int velocity = zc < n ? zr - n : (pass ? zr : zc) - n;
      const int target = zc < n ? zc : (pass ? zc : zr) - n;
      const double* v = b.v + static_cast<long>(velocity) * s.points * lanes;
      const double* w = b.v + static_cast<long>(target) * s.points * lanes;
      for (int i = 0; i < s.points; ++i) {
        const Vec product = s.weight[i] * group(row, i) * group(v, i);
        const double* factor = (zc < n ? s.value : s.slope) + i * s.functions;
        const Vec scaled = zc < n ? product : product * rate;
        for (int f = 0; f < s.functions; ++f) group(out, f * n + target) -= factor[f] * scaled;
        if (zc >= n) second += product * group(w, i) * rate;
      }
    }
  }
  at(corner) = second;
}

}  // namespace

Assembly assembly_kernels() { return {expand, gradient, hessian, border}; }

}  // namespace extremal::EXTREMAL_LEVEL
