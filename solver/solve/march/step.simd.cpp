#include "machine/lanes.hpp"
#include "solve/march/step_kernels.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

inline double magnitude(double x) { return x < 0 ? -x : x; }

/// The sum over the lanes.
inline double total(Vec x) {
  double lane[lanes], sum = 0;
  __builtin_memcpy(lane, &x, sizeof x);
  for (int i = 0; i < lanes; ++i) sum += lane[i];
  return sum;
}

void expand(const StepShape& s, const StepPoints& p, const double* start, double time, double h,
            const double* x) {
  const double rate = 1.0 / h;
  for (int i = 0; i < s.width; i += lanes) {
    const Vec node = at(s.node + i);
    for (int a = 0; a < s.n; ++a) {
      const double* own = x + a * s.s;
      const double delta = own[s.s - 1];
      Vec q = node * delta, v = broadcast(delta);
      for (int j = 0; j + 1 < s.s; ++j) {
        q += own[j] * at(s.value + j * s.width + i);
        v += own[j] * at(s.slope + j * s.width + i);
      }
      at(p.q + a * s.width + i) = start[a] + q;
      at(p.v + a * s.width + i) = v * rate;
    }
    if (p.t) at(p.t + i) = time + h * node;
  }
}

/// L and its derivatives at the points, with their weights: ½ q'ᵀMq' + q'ᵀCq + aᵀq' beside the remainder.
/// Returns Σ b_i L_i.
double derivatives(const StepShape& s, const StepPoints& p) {
  Vec action = broadcast(0);
  for (int i = 0; i < s.width; i += lanes) {
    Vec value = at(p.remainder + i);
    for (int a = 0; a < s.n; ++a) {
      const double linear = s.linear ? s.linear[a] : 0;
      at(p.dq + a * s.width + i) = broadcast(0);
      at(p.dv + a * s.width + i) = broadcast(linear);
      if (s.linear) value += linear * at(p.v + a * s.width + i);
    }
    for (int e = 0; e < s.mass_count; ++e) {
      const MassView& m = s.mass[e];
      const Vec momentum = m.value * at(p.v + m.column * s.width + i);
      at(p.dv + m.row * s.width + i) += momentum;
      value += 0.5 * momentum * at(p.v + m.row * s.width + i);
    }
    for (int e = 0; e < s.gyroscopic_count; ++e) {
      const MassView& c = s.gyroscopic[e];
      const Vec momentum = c.value * at(p.q + c.column * s.width + i), v = at(p.v + c.row * s.width + i);
      at(p.dv + c.row * s.width + i) += momentum;
      at(p.dq + c.column * s.width + i) += c.value * v;
      value += momentum * v;
    }
    for (int g = 0; g < s.gradient_count; ++g) {
      const int z = s.gradient[g];
      double* to = z < s.n ? p.dq + z * s.width : p.dv + (z - s.n) * s.width;
      at(to + i) += at(p.remainder + (1 + g) * s.width + i);
    }
    const Vec weight = at(s.weight + i);
    action += weight * value;
    for (int a = 0; a < s.n; ++a) {
      at(p.dq + a * s.width + i) *= weight;
      at(p.dv + a * s.width + i) *= weight;
    }
  }
  return total(action);
}

double gather(const StepShape& s, const StepPoints& p, double h, double* out, double* force) {
  const double action = derivatives(s, p);
  for (int a = 0; a < s.n; ++a) {
    const double *dq = p.dq + a * s.width, *dv = p.dv + a * s.width;
    Vec sum = broadcast(0);
    for (int i = 0; i < s.width; i += lanes) sum += at(dq + i);
    force[a] = h * total(sum);
    for (int f = 0; f < s.functions; f += lanes) {
      Vec r = broadcast(0), kinetic = broadcast(0);
      for (int i = 0; i < s.points; ++i) {
        r += dq[i] * at(s.sum_value + i * s.functions + f);
        kinetic += dv[i] * at(s.sum_slope + i * s.functions + f);
      }
      at(out + a * s.functions + f) = h * r + kinetic;
    }
  }
  return h * action;
}

/// A row of entries that belongs at any address, as many as count.
inline void put(double* to, Vec value, int count) {
  if (count >= lanes) {
    store(to, value);
    return;
  }
  double lane[lanes];
  __builtin_memcpy(lane, &value, sizeof value);
  for (int i = 0; i < count; ++i) to[i] = lane[i];
}

/// ∂G_I/∂x_K = Σ b_i (h φ_I [L_qq φ_K + L_qv φ_K'/h] + φ_I' [L_vq φ_K + L_vv φ_K'/h]).
void matrix(const StepShape& s, const StepPoints& p, double h, double* matrix, int stride) {
  const double rate = 1.0 / h;
  for (int k = 0; k < s.n * s.s * stride; k += lanes) at(matrix + k) = broadcast(0);
  const double* const hessian = p.remainder + (1 + s.gradient_count) * s.width;
  for (int e = 0; e < s.pair_count; ++e) {
    const CoupledPair& c = s.pairs[e];
    const double* const qq = c.qq < 0 ? nullptr : hessian + c.qq * s.width;
    for (int k = 0; k < s.s; ++k)
      for (int f = 0; f < s.functions; f += lanes) {
        Vec sum = broadcast(0);
        if (qq)
          for (int i = 0; i < s.points; ++i)
            sum += (h * qq[i] * s.trial_value[i * s.s + k]) * at(s.test_value + i * s.functions + f);
        if (!c.velocities) {
          sum += (c.mass * rate) * at(s.stiffness + k * s.functions + f);
        } else {
          const double *qv = c.qv < 0 ? nullptr : hessian + c.qv * s.width,
                       *vq = c.vq < 0 ? nullptr : hessian + c.vq * s.width,
                       *vv = c.vv < 0 ? nullptr : hessian + c.vv * s.width;
          for (int i = 0; i < s.points; ++i) {
            const double value = s.trial_value[i * s.s + k], slope = s.trial_slope[i * s.s + k];
            const double by_value = (c.qv0 + (qv ? qv[i] : 0)) * slope,
                         by_slope =
                             (c.vq0 + (vq ? vq[i] : 0)) * value + (c.mass + (vv ? vv[i] : 0)) * slope * rate;
            sum += by_value * at(s.test_value + i * s.functions + f) +
                   by_slope * at(s.test_slope + i * s.functions + f);
          }
        }
        put(matrix + (c.b * s.s + k) * stride + c.a * s.s + f, sum, s.s - f);
      }
  }
}

/// Row k becomes that of the inverse and is taken from the others; rows of `count` registers. Column k is
/// stored last: a register that is read after one of its doubles was written waits.
template <int count>
void eliminate(int size, int stride, double* matrix, int k) {
  Vec pivot[count];
  double* const row = matrix + k * stride;
  const double inverse = 1 / row[k];
  for (int c = 0; c < count; ++c) at(row + c * lanes) = pivot[c] = inverse * at(row + c * lanes);
  row[k] = inverse;
  for (int r = 0; r < size; ++r) {
    double* const other = matrix + r * stride;
    const double factor = other[k];
    if (r == k || factor == 0) continue;
    for (int c = 0; c < count; ++c) at(other + c * lanes) -= factor * pivot[c];
    other[k] = -factor * inverse;
  }
}

/// The same for any number.
void eliminate_long(int size, int stride, double* matrix, int k) {
  double* const row = matrix + k * stride;
  const double inverse = 1 / row[k];
  for (int c = 0; c < stride; c += lanes) at(row + c) = inverse * at(row + c);
  row[k] = inverse;
  for (int r = 0; r < size; ++r) {
    double* const other = matrix + r * stride;
    const double factor = other[k];
    if (r == k || factor == 0) continue;
    for (int c = 0; c < stride; c += lanes) at(other + c) -= factor * at(row + c);
    other[k] = -factor * inverse;
  }
}

using Eliminate = void (*)(int size, int stride, double* matrix, int k);

Eliminate elimination_for(int stride) {
  switch (stride / lanes) {
    case 1:
      return eliminate<1>;
    case 2:
      return eliminate<2>;
    case 3:
      return eliminate<3>;
    case 4:
      return eliminate<4>;
    case 5:
      return eliminate<5>;
    case 6:
      return eliminate<6>;
    default:
      return eliminate_long;
  }
}

/// Gauss-Jordan elimination with the largest pivot of a column, rows being measured by their largest entries.
bool invert(int size, int stride, double* matrix, double* work) {
  double *const scale = work, *const order = work + size;
  const Eliminate eliminate = elimination_for(stride);
  for (int r = 0; r < size; ++r) {
    double largest = 0;
    for (int c = 0; c < size; ++c) {
      const double entry = magnitude(matrix[r * stride + c]);
      largest = entry > largest ? entry : largest;
    }
    if (!(largest > 0) || !(largest < 1e300)) return false;
    scale[r] = 1 / largest;
  }
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    double largest = -1;
    for (int r = k; r < size; ++r) {
      const double entry = magnitude(matrix[r * stride + k]) * scale[r];
      pivot = entry > largest ? r : pivot;
      largest = entry > largest ? entry : largest;
    }
    if (!(largest > 1e-15)) return false;
    order[k] = pivot;
    if (pivot != k) {
      double *const row = matrix + k * stride, *const other = matrix + pivot * stride;
      for (int c = 0; c < stride; c += lanes) {
        const Vec kept = at(row + c);
        at(row + c) = at(other + c);
        at(other + c) = kept;
      }
      scale[pivot] = scale[k];
    }
    eliminate(size, stride, matrix, k);
  }
  for (int k = size - 1; k >= 0; --k) {
    const int pivot = static_cast<int>(order[k]);
    if (pivot == k) continue;
    for (int r = 0; r < size; ++r) {
      const double kept = matrix[r * stride + k];
      matrix[r * stride + k] = matrix[r * stride + pivot];
      matrix[r * stride + pivot] = kept;
    }
  }
  return true;
}

void multiply(int size, int stride, const double* matrix, const double* r, double* y) {
  for (int c = 0; c < stride; c += lanes) {
    Vec even = broadcast(0), odd = broadcast(0);
    int k = 0;
    for (; k + 1 < size; k += 2) {
      even -= r[k] * at(matrix + k * stride + c);
      odd -= r[k + 1] * at(matrix + (k + 1) * stride + c);
    }
    if (k < size) even -= r[k] * at(matrix + k * stride + c);
    at(y + c) = even + odd;
  }
}

}  // namespace

StepKernels step_kernels() { return {expand, gather, matrix, invert, multiply}; }

}  // namespace extremal::EXTREMAL_LEVEL
