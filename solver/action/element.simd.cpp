#include "action/element.hpp"

#include "machine/lanes.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

constexpr int lanes = 8;

inline const Vec& group(const double* p, int k) { return at(p + lanes * k); }
inline Vec& group(double* p, int k) { return at(p + lanes * k); }

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

void clear(int m, double* matrix) {
  for (int row = 0; row < m; ++row)
    for (int column = 0; column <= row; ++column) group(matrix, row * m + column) = broadcast(0);
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
void border(const ElementShape& s, const ElementBatch& b, const double*, double* out, double* corner) {
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

/// A tile of four rows and two columns of A − Y Lᵀ over `depth` eliminated columns.
template <int rows>
inline void tile(const double* y, long m, int depth, const double* l0, const double* l1, Vec* s0, Vec* s1) {
  for (int r = 0; r < rows; ++r) s0[r] = s1[r] = broadcast(0);
  for (int k = 0; k < depth; ++k) {
    const Vec a = group(l0, k), c = group(l1, k);
    for (int r = 0; r < rows; ++r) {
      const Vec x = group(y + r * m * lanes, k);
      s0[r] += x * a;
      s1[r] += x * c;
    }
  }
}

/// Columns j and j + 1 of `rows` rows from row i on; both > j + 1.
template <int rows>
inline void column_pair(double* matrix, int m, int i, int j, int depth, bool eliminate, const Vec& l10,
                        const double* l0, const double* l1) {
  Vec s0[rows], s1[rows];
  double* y = matrix + static_cast<long>(i) * m * lanes;
  tile<rows>(y, m, depth, l0, l1, s0, s1);
  for (int r = 0; r < rows; ++r) {
    double* row = y + static_cast<long>(r) * m * lanes;
    const Vec first = group(row, j) - s0[r];
    group(row, j) = first;
    Vec second = group(row, j + 1) - s1[r];
    if (eliminate) second -= first * l10;
    group(row, j + 1) = second;
  }
}

/// Left-looking, two columns at a time. Rows hold y_ik = L_ik d_k; `work` holds rows j, j + 1 of L.
void condense(int inner, int m, int rows, double* matrix, double* inverse, double* negative, double* ratio,
              double* work) {
  Vec count = broadcast(0), least = broadcast(1);
  double *l0 = work, *l1 = work + static_cast<long>(m) * lanes;
  const auto pivot = [&](int j, const Vec& d, const Vec& before) {
    group(inverse, j) = 1.0 / d;
    const Vec magnitude = d < 0 ? -d : d, scale = before < 0 ? -before : before;
    const Vec relative = magnitude / scale;
    count += d < 0 ? broadcast(1) : broadcast(0);
    least = relative < least ? relative : least;
  };
  int j = 0;
  while (j < m) {
    const int depth = j < inner ? j : inner;
    const bool eliminate = j < inner;
    // A pair does not straddle the border between what is eliminated and what stays.
    const bool pair = j + 1 < m && (j + 1 < inner || j >= inner);
    double* row0 = matrix + static_cast<long>(j) * m * lanes;
    double* row1 = pair ? row0 + static_cast<long>(m) * lanes : row0;
    Vec s00 = broadcast(0), s10 = broadcast(0), s11 = broadcast(0);
    for (int k = 0; k < depth; ++k) {
      const Vec y0 = group(row0, k), y1 = group(row1, k);
      const Vec a = y0 * group(inverse, k), c = y1 * group(inverse, k);
      group(l0, k) = a;
      group(l1, k) = c;
      s00 += y0 * a;
      s10 += y1 * a;
      s11 += y1 * c;
    }
    const Vec before0 = group(row0, j), d0 = before0 - s00;
    group(row0, j) = d0;
    if (eliminate) pivot(j, d0, before0);
    Vec l10 = broadcast(0);
    if (pair) {
      const Vec y10 = group(row1, j) - s10;
      group(row1, j) = y10;
      const Vec before1 = group(row1, j + 1);
      Vec d1 = before1 - s11;
      if (eliminate) {
        l10 = y10 * group(inverse, j);
        d1 -= y10 * l10;
      }
      group(row1, j + 1) = d1;
      if (eliminate) pivot(j + 1, d1, before1);
    }
    int i = j + 1 + pair;
    if (pair) {
      for (; i + 3 < rows; i += 4) column_pair<4>(matrix, m, i, j, depth, eliminate, l10, l0, l1);
      for (; i < rows; ++i) column_pair<1>(matrix, m, i, j, depth, eliminate, l10, l0, l1);
    } else {
      for (; i < rows; ++i) {
        double* row = matrix + static_cast<long>(i) * m * lanes;
        Vec sum = broadcast(0);
        for (int k = 0; k < depth; ++k) sum += group(row, k) * group(l0, k);
        group(row, j) -= sum;
      }
    }
    j += 1 + pair;
  }
  at(negative) = count;
  at(ratio) = least;
}

void reduce(int inner, int m, const double* matrix, const double* inverse, double* gradient) {
  for (int j = 0; j < m; ++j) {
    const double* row = matrix + static_cast<long>(j) * m * lanes;
    const int depth = j < inner ? j : inner;
    Vec s0 = broadcast(0), s1 = broadcast(0);
    int k = 0;
    for (; k + 1 < depth; k += 2) {
      s0 += group(gradient, k) * group(inverse, k) * group(row, k);
      s1 += group(gradient, k + 1) * group(inverse, k + 1) * group(row, k + 1);
    }
    if (k < depth) s0 += group(gradient, k) * group(inverse, k) * group(row, k);
    group(gradient, j) -= s0 + s1;
  }
}

void expand_step(int inner, int m, const double* matrix, const double* inverse, const double* gradient,
                 const double* border, const double* step_h, double* x) {
  const long stride = static_cast<long>(m) * lanes;
  for (int j = inner - 1; j >= 0; --j) {
    Vec s0 = group(gradient, j), s1 = broadcast(0), s2 = broadcast(0), s3 = broadcast(0);
    if (border) s1 = group(border, j) * at(step_h);
    const double* y = matrix + static_cast<long>(j) * lanes;
    // The latest x last, so that the chain of dependent sums is short.
    int i = m - 1;
    for (; i - 3 > j; i -= 4) {
      s0 += at(y + i * stride) * group(x, i);
      s1 += at(y + (i - 1) * stride) * group(x, i - 1);
      s2 += at(y + (i - 2) * stride) * group(x, i - 2);
      s3 += at(y + (i - 3) * stride) * group(x, i - 3);
    }
    for (; i > j; --i) s0 += at(y + i * stride) * group(x, i);
    group(x, j) = -group(inverse, j) * ((s0 + s1) + (s2 + s3));
  }
}

}  // namespace

extern const ElementKernels element_kernels;
const ElementKernels element_kernels = {expand, gradient, clear,  hessian,
                                        border, condense, reduce, expand_step};

}  // namespace extremal::EXTREMAL_LEVEL
