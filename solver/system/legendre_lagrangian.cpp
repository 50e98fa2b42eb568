#include "system/legendre_lagrangian.hpp"

#include <qd/dd_real.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "system/hamiltonian.hpp"

namespace extremal {

namespace {

int row_of_slope(const Structure& s, int z) {
  const auto at = std::lower_bound(s.gradient.begin(), s.gradient.end(), z);
  return at != s.gradient.end() && *at == z ? 1 + static_cast<int>(at - s.gradient.begin()) : -1;
}

int row_of_second(const Structure& s, int a, int b) {
  const std::pair entry(std::max(a, b), std::min(a, b));
  const auto at = std::lower_bound(
      s.hessian.begin(), s.hessian.end(), entry,
      [](const HessianEntry& e, const std::pair<int, int>& x) { return std::pair(e.row, e.column) < x; });
  if (at == s.hessian.end() || std::pair(at->row, at->column) != entry) return -1;
  return 1 + static_cast<int>(s.gradient.size() + (at - s.hessian.begin()));
}

}  // namespace

/// Rows of the stride of the points, in scratch memory.
struct LegendreLagrangian::Evaluation {
  int count;
  std::ptrdiff_t stride;
  double *p, *h;              ///< n rows; those of H
  double *inverse, *product;  ///< of one block: H_pp⁻¹, H_pp⁻¹ H_pq
  double *further, *work;
  double* row(double* rows, int k) const { return rows + k * stride; }
};

LegendreLagrangian::LegendreLagrangian(const LagrangianGraph& hamiltonian, std::shared_ptr<const Kinks> kinks)
    : hamiltonian_(hamiltonian), search_(hamiltonian), kinks_(std::move(kinks)) {
  make_blocks();
  make_structure();
  const Structure& h = hamiltonian_.structure();
  for (const HessianEntry& e : structure_.hessian)
    qq_.push_back(e.row < h.coordinates ? row_of_second(h, e.row, e.column) : -1);
  for (Block& block : blocks_) {
    const int n = h.coordinates;
    const auto lower = [&](int a, int b) { return a >= b ? row_of_second(structure_, a, b) : -1; };
    for (const int p : block.momenta) {
      for (const int other : block.momenta) block.vv.push_back(lower(n + p, n + other));
      for (const int q : block.coordinates) block.vq.push_back(row_of_second(structure_, n + p, q));
    }
    for (const int q : block.coordinates)
      for (const int other : block.coordinates) block.qq.push_back(lower(q, other));
  }
}

void LegendreLagrangian::make_blocks() {
  const Structure& h = hamiltonian_.structure();
  const int n = h.coordinates;
  std::vector<std::vector<int>> beside(n);  // coordinates with an entry of H_pq, by momentum
  for (const HessianEntry& e : h.hessian)
    if (e.row >= n && e.column < n) beside[e.row - n].push_back(e.column);
  for (const std::vector<int>& momenta : search_.blocks()) {
    std::set<int> coordinates;
    for (const int p : momenta) coordinates.insert(beside[p].begin(), beside[p].end());
    Block block;
    block.momenta = momenta;
    block.coordinates.assign(coordinates.begin(), coordinates.end());
    for (const int p : momenta) {
      for (const int other : momenta) block.pp.push_back(row_of_second(h, n + p, n + other));
      for (const int q : coordinates) block.pq.push_back(row_of_second(h, n + p, q));
    }
    largest_ = std::max(largest_, block.size());
    widest_ = std::max(widest_, block.width());
    blocks_.push_back(std::move(block));
  }
}

/// Of L: p depends on t as H does, so frequencies stay.
void LegendreLagrangian::make_structure() {
  const Structure& h = hamiltonian_.structure();
  const int n = h.coordinates;
  structure_.coordinates = n;
  structure_.parameters = h.parameters;
  structure_.autonomous = h.autonomous;
  structure_.harmonic = h.harmonic;
  structure_.pulses = h.pulses;
  structure_.frequencies = h.frequencies;
  structure_.gradient = h.gradient;  // a momentum that H_pp has is there
  std::set<std::pair<int, int>> entries;
  for (const HessianEntry& e : h.hessian)
    if (e.row < n) entries.emplace(e.row, e.column);
  for (const Block& block : blocks_) {
    for (const int p : block.momenta) {
      for (const int other : block.momenta)
        if (other <= p) entries.emplace(n + p, n + other);
      for (const int q : block.coordinates) entries.emplace(n + p, q);
    }
    for (const int q : block.coordinates)
      for (const int other : block.coordinates)
        if (other <= q) entries.emplace(q, other);
  }
  for (const auto& [row, column] : entries) structure_.hessian.push_back({row, column});
}

/// Solves for the momenta and evaluates H there. Tapes take the beginning of the scratch memory.
LegendreLagrangian::Evaluation LegendreLagrangian::evaluate_hamiltonian(const Points& points, Order order,
                                                                        std::size_t further,
                                                                        Scratch& scratch) const {
  const std::size_t n = structure_.coordinates, m = largest_, h = hamiltonian_.rows(order);
  const std::size_t of_tapes = std::max(hamiltonian_.doubles(points.count), search_.doubles(points));
  const std::size_t rows = n + h + m * m + m * widest_ + further;
  double* next = scratch.reserve(of_tapes + rows * points.stride + 2 * m * m * most_lanes) + of_tapes;
  const auto take = [&](std::size_t count) { return std::exchange(next, next + count * points.stride); };
  Evaluation at{.count = points.count,
                .stride = points.stride,
                .p = take(n),
                .h = take(h),
                .inverse = take(m * m),
                .product = take(m * widest_),
                .further = take(further),
                .work = nullptr};
  at.work = next;
  search_.find(points, at.p, scratch);
  hamiltonian_.evaluate({points.count, points.stride, points.q, at.p, points.t}, order, at.h, scratch);
  return at;
}

/// H_pp⁻¹ of a block at all points.
void LegendreLagrangian::invert(const Block& block, const Evaluation& at) const {
  extremal::invert({at.count, at.stride, at.h, at.inverse, at.work},
                   {block.size(), block.momenta.data(), block.pp.data()});
}

/// Adds H_qp H_pp⁻¹ H_pq to L_qq and writes L_vq = −H_pp⁻¹ H_pq, L_vv = H_pp⁻¹.
void LegendreLagrangian::add_block(const Block& block, const Evaluation& at, double* out) const {
  const int m = block.size(), w = block.width();
  invert(block, at);
  for (int e = 0; e < m * m; ++e)
    if (block.vv[e] >= 0) std::copy_n(at.row(at.inverse, e), at.count, at.row(out, block.vv[e]));
  for (int j = 0; j < m; ++j) {
    for (int c = 0; c < w; ++c) {
      double* product = at.row(at.product, j * w + c);
      std::fill_n(product, at.count, 0.0);
      for (int k = 0; k < m; ++k) {
        if (block.pq[k * w + c] < 0) continue;
        const double *inverse = at.row(at.inverse, j * m + k), *mixed = at.row(at.h, block.pq[k * w + c]);
        for (int i = 0; i < at.count; ++i) product[i] += inverse[i] * mixed[i];
      }
      double* vq = at.row(out, block.vq[j * w + c]);
      for (int i = 0; i < at.count; ++i) vq[i] = -product[i];
    }
  }
  for (int c = 0; c < w; ++c) {
    for (int d = 0; d <= c; ++d) {
      double* qq = at.row(out, block.qq[c * w + d]);
      for (int k = 0; k < m; ++k) {
        if (block.pq[k * w + c] < 0) continue;
        const double *mixed = at.row(at.h, block.pq[k * w + c]), *product = at.row(at.product, k * w + d);
        for (int i = 0; i < at.count; ++i) qq[i] += mixed[i] * product[i];
      }
    }
  }
}

void LegendreLagrangian::evaluate(const Points& points, Order order, double* out, Scratch& scratch) const {
  const int n = structure_.coordinates, count = points.count;
  const Evaluation at = evaluate_hamiltonian(points, order, 0, scratch);
  for (int i = 0; i < count; ++i) out[i] = -at.h[i];
  for (int a = 0; a < n; ++a) {
    const double *p = at.row(at.p, a), *v = points.v + a * points.stride;
    for (int i = 0; i < count; ++i) out[i] += p[i] * v[i];
  }
  if (order == Order::value) return;
  const int gradients = static_cast<int>(structure_.gradient.size());
  for (int k = 0; k < gradients; ++k) {
    const int z = structure_.gradient[k];
    double* row = at.row(out, 1 + k);
    if (z >= n) {
      std::copy_n(at.row(at.p, z - n), count, row);
    } else {
      const double* h = at.row(at.h, 1 + k);
      for (int i = 0; i < count; ++i) row[i] = -h[i];
    }
  }
  if (order == Order::gradient) return;
  for (std::size_t k = 0; k < qq_.size(); ++k) {
    double* row = at.row(out, 1 + gradients + static_cast<int>(k));
    if (qq_[k] < 0) {
      std::fill_n(row, count, 0.0);
    } else {
      const double* h = at.row(at.h, qq_[k]);
      for (int i = 0; i < count; ++i) row[i] = -h[i];
    }
  }
  for (const Block& block : blocks_) add_block(block, at, out);
}

/// ∂L/∂μ = −∂H/∂μ at fixed q, v; L_vμ = −H_pp⁻¹ H_pμ, L_qμ = −H_qμ + H_qp H_pp⁻¹ H_pμ.
void LegendreLagrangian::sensitivity(const Points& points, int parameter, double* out,
                                     Scratch& scratch) const {
  const int n = structure_.coordinates, count = points.count;
  const int gradients = static_cast<int>(structure_.gradient.size());
  const Evaluation at = evaluate_hamiltonian(points, Order::hessian, 1 + gradients, scratch);
  hamiltonian_.sensitivity({count, points.stride, points.q, at.p, points.t}, parameter, at.further, scratch);
  for (int k = 0; k <= gradients; ++k) {
    double *row = at.row(out, k), *h = at.row(at.further, k);
    const bool momentum = k > 0 && structure_.gradient[k - 1] >= n;
    for (int i = 0; i < count; ++i) row[i] = momentum ? 0 : -h[i];
  }
  for (const Block& block : blocks_) {
    const int m = block.size(), w = block.width();
    invert(block, at);
    for (int j = 0; j < m; ++j) {
      double* slope = at.row(out, row_of_slope(structure_, n + block.momenta[j]));
      for (int k = 0; k < m; ++k) {
        const double* inverse = at.row(at.inverse, j * m + k);
        const double* h = at.row(at.further, row_of_slope(structure_, n + block.momenta[k]));
        for (int i = 0; i < count; ++i) slope[i] -= inverse[i] * h[i];
      }
      for (int c = 0; c < w; ++c) {
        if (block.pq[j * w + c] < 0) continue;
        double* of_q = at.row(out, row_of_slope(structure_, block.coordinates[c]));
        const double* mixed = at.row(at.h, block.pq[j * w + c]);
        for (int i = 0; i < count; ++i) of_q[i] -= mixed[i] * slope[i];
      }
    }
  }
}

/// p in double, then corrections H_pp⁻¹ (v − H_p) with the residual in extended precision: each gains the
/// digits of H_pp⁻¹.
template <class Number>
bool LegendreLagrangian::extended(const Number* q, const Number* v, const Number& t, Number* out,
                                  PointScratch<Number>& scratch) const {
  constexpr int corrections = 3;
  const int n = structure_.coordinates, lanes = simd_lanes();
  const auto rounded = [](const Number& x) {
    if constexpr (std::is_same_v<Number, DoubleDouble>)
      return x.x[0];
    else
      return static_cast<double>(x);
  };
  AlignedDoubles rows(static_cast<std::size_t>(2 * n + 1) * lanes);
  for (int i = 0; i < lanes; ++i) {
    for (int a = 0; a < n; ++a) {
      rows[a * lanes + i] = rounded(q[a]);
      rows[(n + a) * lanes + i] = rounded(v[a]);
    }
    rows[2 * n * lanes + i] = rounded(t);
  }
  Scratch doubles;
  const Points points{lanes, lanes, rows.data(), rows.data() + n * lanes, rows.data() + 2 * n * lanes};
  const Evaluation at = evaluate_hamiltonian(points, Order::hessian, 0, doubles);
  std::vector<Number> p;
  for (int a = 0; a < n; ++a) p.emplace_back(at.row(at.p, a)[0]);
  const Structure& h = hamiltonian_.structure();
  for (int k = 0; k < corrections; ++k) {
    if (!hamiltonian_.evaluate_extended(q, p.data(), t, out, scratch)) return false;
    for (const Block& block : blocks_) {
      const int m = block.size();
      invert(block, at);
      for (int j = 0; j < m; ++j) {
        double change = 0;
        for (int e = 0; e < m; ++e) {
          const int a = block.momenta[e];
          change += at.row(at.inverse, j * m + e)[0] * rounded(v[a] - out[row_of_slope(h, n + a)]);
        }
        p[block.momenta[j]] += Number(change);
      }
    }
  }
  hamiltonian_.evaluate_extended(q, p.data(), t, out, scratch);
  Number value = -out[0];
  for (int a = 0; a < n; ++a) value += p[a] * v[a];
  out[0] = value;
  for (std::size_t k = 0; k < structure_.gradient.size(); ++k) {
    const int z = structure_.gradient[k];
    out[1 + k] = z >= n ? p[z - n] : -out[1 + k];
  }
  return true;
}

bool LegendreLagrangian::evaluate_extended(const Extended* q, const Extended* v, const Extended& t,
                                           Extended* out, PointScratch<Extended>& scratch) const {
  return extended(q, v, t, out, scratch);
}

bool LegendreLagrangian::evaluate_extended(const DoubleDouble* q, const DoubleDouble* v,
                                           const DoubleDouble& t, DoubleDouble* out,
                                           PointScratch<DoubleDouble>& scratch) const {
  return extended(q, v, t, out, scratch);
}

}  // namespace extremal
