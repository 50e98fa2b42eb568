#include "system/momentum_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "machine/simd.hpp"
#include "system/hamiltonian.hpp"
#include "system/momentum_step.hpp"
#include "system/structure.hpp"

namespace extremal {

namespace {

constexpr int most_steps = 60;
/// Where p begins, until one leads to a solution: at zero, at v, at ones of either sign.
constexpr int starts = 4;
double start_value(int start, double v) { return start == 0 ? 0 : start == 1 ? v : start == 2 ? 1 : -1; }

using AdvanceMomentum = double (*)(const MomentumRows&, int);
AdvanceMomentum kernel() { return at_simd_level(EXTREMAL_AT_EACH_LEVEL(advance_momentum)); }

}  // namespace

bool factor_small(double* a, double* pivots, int m) {
  for (int k = 0; k < m; ++k) {
    int best = k;
    for (int i = k + 1; i < m; ++i)
      if (std::abs(a[i * m + k]) > std::abs(a[best * m + k])) best = i;
    const double pivot = a[best * m + k];
    if (!(std::abs(pivot) > 0) || !std::isfinite(pivot)) return false;
    pivots[k] = best;
    if (best != k) std::swap_ranges(a + k * m, a + (k + 1) * m, a + best * m);
    for (int i = k + 1; i < m; ++i) {
      const double factor = a[i * m + k] /= pivot;
      for (int j = k + 1; j < m; ++j) a[i * m + j] -= factor * a[k * m + j];
    }
  }
  return true;
}

void solve_small(const double* lu, const double* pivots, int m, double* x) {
  for (int k = 0; k < m; ++k) std::swap(x[k], x[static_cast<int>(pivots[k])]);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < i; ++j) x[i] -= lu[i * m + j] * x[j];
  for (int i = m; i-- > 0;) {
    for (int j = i + 1; j < m; ++j) x[i] -= lu[i * m + j] * x[j];
    x[i] /= lu[i * m + i];
  }
}

/// Rows of the batch, each of the stride of the points.
struct MomentumSearch::Batch {
  const Points& points;
  Scratch& scratch;
  double *p, *trial, *step;                ///< n rows: accepted, tried, Newton's step
  double *weight, *slopes;                 ///< |H_pp| of each momentum at the start; what the tape writes
  double *state, *norm, *scale, *damping;  ///< a row for each block
  double *matrix, *vector, *pivots;        ///< of the largest block
  std::ptrdiff_t at(int row, int i) const { return row * points.stride + i; }
};

MomentumSearch::MomentumSearch(const LagrangianGraph& hamiltonian) : n_(hamiltonian.coordinates) {
  const Analysis analysis = analyse(hamiltonian);
  const Structure& s = analysis.structure;
  std::vector<int> block(n_);
  std::iota(block.begin(), block.end(), 0);
  const auto root = [&](int a) {
    while (block[a] != a) a = block[a] = block[block[a]];
    return a;
  };
  std::map<std::pair<int, int>, int> entries;  // of H_pp, lower triangle: row of slopes_
  for (const HessianEntry& e : s.hessian) {
    if (e.row < n_ || e.column < n_) continue;
    entries.emplace(std::pair(e.row - n_, e.column - n_), n_ + static_cast<int>(entries.size()));
    block[root(e.row - n_)] = root(e.column - n_);
  }
  slope_rows_ = n_ + static_cast<int>(entries.size());

  std::map<int, std::vector<int>> members;
  for (int a = 0; a < n_; ++a) members[root(a)].push_back(a);
  for (const auto& [first, momenta] : members) {
    const int m = static_cast<int>(momenta.size());
    if (m > most_coupled_momenta)
      throw std::invalid_argument("the Hamiltonian couples " + std::to_string(m) + " momenta; " +
                                  std::to_string(most_coupled_momenta) + " are the most");
    Block& made = blocks_.emplace_back(Block{momenta, {}});
    for (const int a : momenta)
      for (const int b : momenta) {
        const auto found = entries.find({std::max(a, b), std::min(a, b)});
        made.rows.push_back(found == entries.end() ? -1 : found->second);
      }
    if (m == 1 && made.rows[0] < 0)
      throw SingularHamiltonian("the second derivative of the Hamiltonian by the momenta is singular",
                                momenta);
    largest_ = std::max(largest_, m);
    members_.push_back(momenta);
  }

  std::vector<Tape::Contribution> all;
  for (const Kernel& kernel : analysis.kernels) {
    Tape::Contribution c{&kernel, {}, {}};
    std::vector<const SecondPartial*> seconds;
    std::vector<const Partial*> firsts;
    for (const Partial& p : kernel.gradient)
      if (kernel.kinds[p.input] == Variable::velocity) firsts.push_back(&p);
    for (const SecondPartial& p : kernel.hessian)
      if (kernel.kinds[p.row] == Variable::velocity && kernel.kinds[p.column] == Variable::velocity)
        seconds.push_back(&p);
    if (firsts.empty()) continue;
    for (const Partial* p : firsts) c.roots.push_back(p->value);
    for (const SecondPartial* p : seconds) c.roots.push_back(p->value);
    for (int r = 0; r < kernel.rows; ++r) {
      for (const Partial* p : firsts) c.rows.push_back(static_cast<int>(kernel.at(r, p->input)));
      for (const SecondPartial* p : seconds) {
        const HessianEntry e = hessian_entry(kernel, r, *p, n_);
        c.rows.push_back(entries.at({e.row - n_, e.column - n_}));
      }
    }
    all.push_back(std::move(c));
  }
  slopes_ = Tape(all, slope_rows_, hamiltonian.uniforms);
}

/// The step of several momenta, with the sizes of p and of the step in the units of H^(1/2); not a number
/// where H_pp is singular.
double MomentumSearch::coupled_step(const Batch& b, const Block& block, int i, double& size) const {
  const int m = static_cast<int>(block.momenta.size());
  for (int e = 0; e < m * m; ++e) b.matrix[e] = block.rows[e] < 0 ? 0 : b.slopes[b.at(block.rows[e], i)];
  for (int e = 0; e < m; ++e) {
    const int a = block.momenta[e];
    b.vector[e] = b.points.v[b.at(a, i)] - b.slopes[b.at(a, i)];
  }
  if (!factor_small(b.matrix, b.pivots, m)) return std::numeric_limits<double>::quiet_NaN();
  solve_small(b.matrix, b.pivots, m, b.vector);
  double change = 0, whole = 0;
  for (int e = 0; e < m; ++e) {
    const int a = block.momenta[e];
    const double w = b.weight[b.at(a, i)], p = b.p[b.at(a, i)];
    b.step[b.at(a, i)] = b.vector[e];
    whole += p * p * w;
    change += b.vector[e] * b.vector[e] * w;
  }
  size = std::sqrt(whole);
  return std::sqrt(change);
}

/// From slopes at p: the next trial, or the end of the search.
void MomentumSearch::step(const Batch& b, int k, int i) const {
  const Block& block = blocks_[k];
  double size = 0;
  const double change = coupled_step(b, block, i, size);
  if (!std::isfinite(change)) {
    b.state[b.at(k, i)] = lost;
    return;
  }
  const bool last = change <= last_step * size || b.norm[b.at(k, i)] <= last_residual * b.scale[b.at(k, i)];
  const double part = last ? 1 : b.damping[b.at(k, i)];
  for (const int a : block.momenta) {
    const std::ptrdiff_t at = b.at(a, i);
    b.trial[at] = b.p[at] + part * b.step[at];
    if (last) b.p[at] = b.trial[at];
  }
  if (last) b.state[b.at(k, i)] = solved;
}

/// |v − H_p| in units of H^(1/2).
double MomentumSearch::residual(const Batch& b, const Block& block, int i) const {
  double sum = 0;
  for (const int a : block.momenta) {
    const std::ptrdiff_t at = b.at(a, i);
    const double r = b.points.v[at] - b.slopes[at];
    sum += r * r / b.weight[at];
  }
  return std::sqrt(sum);
}

void MomentumSearch::play(const Batch& b) const {
  const Points& points = b.points;
  slopes_.play({points.count, points.stride, points.q, b.trial, points.t}, b.slopes, b.scratch);
}

/// The first step of one momentum: its trial, the start, is accepted if H_p is a number there.
void MomentumSearch::begin_single(const Batch& b, int k) const {
  const int a = blocks_[k].momenta[0];
  const double *v = b.points.v + b.at(a, 0), *slope = b.slopes + b.at(a, 0);
  double *state = b.state + b.at(k, 0), *norm = b.norm + b.at(k, 0), *scale = b.scale + b.at(k, 0);
  double* damping = b.damping + b.at(k, 0);
  for (int i = 0; i < b.points.count; ++i) {
    state[i] = state[i] == solved ? solved : searching;
    norm[i] = std::numeric_limits<double>::infinity();
    scale[i] = std::abs(v[i] - slope[i]) + std::abs(v[i]);
    damping[i] = 0.5;
  }
  advance_single(b, k);
}

bool MomentumSearch::advance_single(const Batch& b, int k) const {
  const Block& block = blocks_[k];
  const int a = block.momenta[0];
  const MomentumRows rows{.v = b.points.v + b.at(a, 0),
                          .slope = b.slopes + b.at(a, 0),
                          .curvature = b.slopes + b.at(block.rows[0], 0),
                          .p = b.p + b.at(a, 0),
                          .trial = b.trial + b.at(a, 0),
                          .step = b.step + b.at(a, 0),
                          .state = b.state + b.at(k, 0),
                          .norm = b.norm + b.at(k, 0),
                          .scale = b.scale + b.at(k, 0),
                          .damping = b.damping + b.at(k, 0)};
  return kernel()(rows, b.points.count) > 0;
}

/// Puts what is not solved at a start.
void MomentumSearch::begin(const Batch& b, int start) const {
  const int count = b.points.count;
  for (int k = 0; k < static_cast<int>(blocks_.size()); ++k)
    for (const int a : blocks_[k].momenta)
      for (int i = 0; i < count; ++i)
        if (b.state[b.at(k, i)] != solved)
          b.trial[b.at(a, i)] = b.p[b.at(a, i)] = start_value(start, b.points.v[b.at(a, i)]);
  play(b);
  for (int k = 0; k < static_cast<int>(blocks_.size()); ++k) {
    const Block& block = blocks_[k];
    const int m = static_cast<int>(block.momenta.size());
    if (m == 1) {
      begin_single(b, k);
      continue;
    }
    for (int i = 0; i < count; ++i) {
      const std::ptrdiff_t at = b.at(k, i);
      if (b.state[at] == solved) continue;
      double of_v = 0;
      for (int e = 0; e < m; ++e) {
        const std::ptrdiff_t a = b.at(block.momenta[e], i);
        const int diagonal = block.rows[e * m + e];
        const double w = diagonal < 0 ? 1 : std::abs(b.slopes[b.at(diagonal, i)]);
        b.weight[a] = w > 0 && std::isfinite(w) ? w : 1;
        of_v += b.points.v[a] * b.points.v[a] / b.weight[a];
      }
      b.state[at] = searching;
      b.damping[at] = 1;
      b.norm[at] = residual(b, block, i);
      b.scale[at] = b.norm[at] + std::sqrt(of_v);
      step(b, k, i);
    }
  }
}

/// One step of all that are still searching; whether some are left.
bool MomentumSearch::advance(const Batch& b) const {
  const int count = b.points.count;
  play(b);
  bool left = false;
  for (int k = 0; k < static_cast<int>(blocks_.size()); ++k) {
    const Block& block = blocks_[k];
    if (block.momenta.size() == 1) {
      left = advance_single(b, k) || left;
      continue;
    }
    for (int i = 0; i < count; ++i) {
      const std::ptrdiff_t at = b.at(k, i);
      if (b.state[at] != searching) continue;
      const double norm = residual(b, block, i);
      double& damping = b.damping[at];
      if (norm <= (1 - damping / 4) * b.norm[at]) {  // a number
        for (const int a : block.momenta) b.p[b.at(a, i)] = b.trial[b.at(a, i)];
        b.norm[at] = norm;
        damping = std::min(1.0, 2 * damping);
        step(b, k, i);
      } else if ((damping /= 2) > smallest_damping) {
        for (const int a : block.momenta)
          b.trial[b.at(a, i)] = b.p[b.at(a, i)] + damping * b.step[b.at(a, i)];
      } else {
        b.state[at] = b.norm[at] <= unreduced_residual * b.scale[at] ? solved : lost;
        for (const int a : block.momenta) b.trial[b.at(a, i)] = b.p[b.at(a, i)];
      }
      left = left || b.state[at] == searching;
    }
  }
  return left;
}

std::size_t MomentumSearch::doubles(const Points& points) const {
  const std::size_t rows = 3 * static_cast<std::size_t>(n_) + slope_rows_ + 4 * blocks_.size(), m = largest_;
  const std::size_t used = rows * points.stride + m * (m + 2);
  return slopes_.doubles(points.count) + (used + most_lanes - 1) / most_lanes * most_lanes;
}

void MomentumSearch::find(const Points& points, double* p, Scratch& scratch) const {
  const std::ptrdiff_t n = n_, blocks = static_cast<std::ptrdiff_t>(blocks_.size()), m = largest_;
  double* next = scratch.reserve(doubles(points)) + slopes_.doubles(points.count);  // the tape's come first
  const auto rows = [&](std::ptrdiff_t count) { return std::exchange(next, next + count * points.stride); };
  Batch b{.points = points,
          .scratch = scratch,
          .p = p,
          .trial = rows(n),
          .step = rows(n),
          .weight = rows(n),
          .slopes = rows(slope_rows_),
          .state = rows(blocks),
          .norm = rows(blocks),
          .scale = rows(blocks),
          .damping = rows(blocks),
          .matrix = next,
          .vector = next + m * m,
          .pivots = next + m * m + m};
  const auto all = static_cast<std::size_t>(blocks * points.stride);
  std::fill_n(b.state, all, lost);
  for (int start = 0; start < starts; ++start) {
    begin(b, start);
    for (int k = 0; k < most_steps && advance(b); ++k) {
    }
    std::replace(b.state, b.state + all, searching, lost);
    bool left = false;
    for (std::ptrdiff_t k = 0; k < blocks; ++k)
      for (int i = 0; i < points.count; ++i) left = left || b.state[b.at(k, i)] == lost;
    if (!left) return;
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    for (int i = 0; i < points.count; ++i)
      if (b.state[b.at(static_cast<int>(k), i)] != solved)
        for (const int a : blocks_[k].momenta) p[b.at(a, i)] = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace extremal
