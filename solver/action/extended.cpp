#include "action/extended.hpp"

#include <algorithm>
#include <cmath>

#include "machine/largest.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Of the largest coordinate, what paths are compared over: differences of gradients keep half the digits,
/// and are linear as far.
constexpr double small_part = 0x1p-56;

}  // namespace

/// One element of a path, or of that path changed by `part` of a change.
struct ExtendedGradient::Element {
  Element(const ExtendedBasis& basis, const Lagrangian& lagrangian, const Path& path,
          const PathChange* change = nullptr, double part = 0);

  bool known() { return lagrangian.evaluate_extended(q.data(), v.data(), t, rows.data(), scratch); }
  void evaluate(int k);

  const ExtendedBasis& basis;
  const Lagrangian& lagrangian;
  const Path& path;
  const PathChange* change;
  const double part;
  const int n, degree;
  std::vector<DoubleDouble> inner, ends;  ///< ∂L_d/∂x of the unknowns
  DoubleDouble action, slope_duration;

 private:
  void load(int k);
  void place(int k, int i);
  DoubleDouble differentiate();

  std::vector<DoubleDouble> start, delta, deviation;      ///< q_a, Δ and inner unknowns of the element
  std::vector<DoubleDouble> q, v, rows, force, momentum;  ///< at one point; L_q and L_q'
  DoubleDouble t = 0.0, duration, h;
  PointScratch<DoubleDouble> scratch;
};

ExtendedGradient::Element::Element(const ExtendedBasis& basis, const Lagrangian& lagrangian, const Path& path,
                                   const PathChange* change, double part)
    : basis(basis),
      lagrangian(lagrangian),
      path(path),
      change(change),
      part(part),
      n(path.coordinates()),
      degree(path.degree()),
      inner(static_cast<std::size_t>(degree - 1) * n),
      ends(2 * static_cast<std::size_t>(n)),
      start(n),
      delta(n),
      deviation(inner.size()),
      q(n),
      v(n),
      rows(lagrangian.rows(Order::gradient)),
      force(n),
      momentum(n),
      duration(path.duration()) {
  if (change) duration += part * change->duration;
}

/// The unknowns of element k.
void ExtendedGradient::Element::load(int k) {
  const int lanes = path.lanes();
  const std::size_t first = static_cast<std::size_t>(k) * n,
                    lane = static_cast<std::size_t>(k / lanes) * (degree + 1) * n * lanes + k % lanes;
  for (int a = 0; a < n; ++a) {
    const std::size_t left = first + a, right = left + n;
    start[a] = dd_real(path.node(0)[left]) + path.rest(0)[left];
    delta[a] = (dd_real(path.node(0)[right]) - path.node(0)[left]) +
               (dd_real(path.rest(0)[right]) - path.rest(0)[left]);
    if (!change) continue;
    start[a] += part * change->nodes[left];
    delta[a] += part * (dd_real(change->nodes[right]) - change->nodes[left]);
  }
  const double *const x = path.x(0) + lane, *const by = change ? change->inner.data() + lane : nullptr;
  for (std::size_t u = 0; u < deviation.size(); ++u)
    deviation[u] = dd_real(x[u * lanes]) + (by ? part * by[u * lanes] : 0);
  h = path.lengths()[k] * duration;
}

/// q, q' and t at point i of element k.
void ExtendedGradient::Element::place(int k, int i) {
  const std::size_t row = static_cast<std::size_t>(i) * (degree + 1);
  const DoubleDouble *value = basis.value.data() + row, *slope = basis.slope.data() + row,
                     tau = basis.node(i);
  for (int a = 0; a < n; ++a) {
    DoubleDouble chord = tau * delta[a], rate = delta[a];
    for (int j = 1; j < degree; ++j) {
      chord += value[j] * deviation[(j - 1) * n + a];
      rate += slope[j] * deviation[(j - 1) * n + a];
    }
    q[a] = start[a] + chord;
    v[a] = rate / h;
  }
  t = path.mesh()[k] * duration + tau * h;
}

/// L from its remainder, returned, L_q and L_q'.
DoubleDouble ExtendedGradient::Element::differentiate() {
  const Structure& structure = lagrangian.structure();
  std::fill(force.begin(), force.end(), 0.0);
  std::fill(momentum.begin(), momentum.end(), 0.0);
  DoubleDouble value = rows[0];
  for (const Triplet& m : structure.mass) {
    momentum[m.row] += m.value * v[m.column];
    value += 0.5 * m.value * v[m.row] * v[m.column];
  }
  for (const Triplet& c : structure.gyroscopic) {
    momentum[c.row] += c.value * q[c.column];
    force[c.column] += c.value * v[c.row];
    value += c.value * v[c.row] * q[c.column];
  }
  for (std::size_t a = 0; a < structure.linear.size(); ++a) {
    momentum[a] += structure.linear[a];
    value += structure.linear[a] * v[a];
  }
  for (std::size_t g = 0; g < structure.gradient.size(); ++g) {
    const int z = structure.gradient[g];
    (z < n ? force[z] : momentum[z - n]) += rows[1 + g];
  }
  return value;
}

/// ∂L_d/∂x of every unknown; L_d = h Σ b_i L_i with q' = (…)/h gives ∂L_d/∂h = Σ b_i (L_i − L_q'·q').
void ExtendedGradient::Element::evaluate(int k) {
  load(k);
  std::fill(inner.begin(), inner.end(), 0.0);
  std::fill(ends.begin(), ends.end(), 0.0);
  action = slope_duration = 0.0;
  for (int i = 0; i < basis.points; ++i) {
    place(k, i);
    known();
    const DoubleDouble value = differentiate(), weight = basis.weight(i), left = basis.node(i),
                       right = basis.before_end(i);
    DoubleDouble work = 0.0;
    for (int a = 0; a < n; ++a) {
      const DoubleDouble impulse = weight * h * force[a], part = weight * momentum[a];
      work += momentum[a] * v[a];
      ends[a] += right * impulse - part;
      ends[n + a] += left * impulse + part;
      for (int j = 1; j < degree; ++j) {
        const std::size_t entry = static_cast<std::size_t>(i) * (degree + 1) + j;
        inner[(j - 1) * n + a] += basis.value[entry] * impulse + basis.slope[entry] * part;
      }
    }
    action += weight * h * value;
    slope_duration += weight * h / duration * (value - work);
  }
}

void ExtendedGradient::evaluate(Element& element, Values& values) {
  const int n = element.n, elements = element.path.elements();
  values.inner.resize(element.inner.size() * elements);
  values.nodes.assign(static_cast<std::size_t>(elements + 1) * n, 0.0);
  values.action = values.slope_duration = 0.0;
  values.momentum_scale = 0;
  for (int k = 0; k < elements; ++k) {
    element.evaluate(k);
    std::copy(element.inner.begin(), element.inner.end(),
              values.inner.begin() + k * std::ssize(element.inner));
    DoubleDouble* const node = values.nodes.data() + static_cast<std::size_t>(k) * n;
    for (int a = 0; a < 2 * n; ++a) {
      node[a] += element.ends[a];
      values.momentum_scale = std::max(values.momentum_scale, std::abs(to_double(element.ends[a])));
    }
    values.action += element.action;
    values.slope_duration += element.slope_duration;
  }
}

bool ExtendedGradient::evaluate(const Lagrangian& lagrangian, const ElementTables& tables, const Path& path) {
  if (!basis_.bind(tables.scheme())) return false;
  Element element(basis_, lagrangian, path);
  if (!element.known()) return false;
  evaluate(element, values_);
  return true;
}

void ExtendedGradient::evaluate_change(const Lagrangian& lagrangian, const Path& path,
                                       const PathChange& change) {
  const double size = std::max({largest(change.nodes), largest(change.inner), std::abs(change.duration)});
  const double part = size > 0 ? small_part * std::max(largest(path.nodes()), 0x1p-500) / size : 1;
  Element element(basis_, lagrangian, path, &change, part);
  evaluate(element, change_);
  const auto relative = [part](const DoubleDouble& after, const DoubleDouble& before) {
    return (after - before) / part;
  };
  const auto compare = [&](std::vector<DoubleDouble>& after, const std::vector<DoubleDouble>& before) {
    std::transform(after.begin(), after.end(), before.begin(), after.begin(), relative);
  };
  compare(change_.inner, values_.inner);
  compare(change_.nodes, values_.nodes);
  change_.action = relative(change_.action, values_.action);
  change_.slope_duration = relative(change_.slope_duration, values_.slope_duration);
}

}  // namespace extremal
