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

using BeginMomenta = void (*)(const MomentumRows&, const CoupledMomenta&);
using AdvanceMomenta = double (*)(const MomentumRows&, const CoupledMomenta&);
using InvertCoupled = void (*)(const InverseRows&, const CoupledMomenta&);

BeginMomenta begin_kernel() { return at_simd_level(EXTREMAL_AT_EACH_LEVEL(begin_momenta)); }
AdvanceMomenta advance_kernel() { return at_simd_level(EXTREMAL_AT_EACH_LEVEL(advance_momenta)); }
InvertCoupled invert_kernel() { return at_simd_level(EXTREMAL_AT_EACH_LEVEL(invert_coupled)); }

}  // namespace

void invert(const InverseRows& rows, const CoupledMomenta& coupled) { invert_kernel()(rows, coupled); }

/// Rows of the batch, each of the stride of the points.
struct MomentumSearch::Batch {
  const Points& points;
  Scratch& scratch;
  double *p, *trial, *step, *unit;         ///< n rows, as in MomentumRows
  double* slopes;                          ///< what the tape writes
  double *state, *norm, *scale, *damping;  ///< a row for each block
  double* work;                            ///< of the largest block
  MomentumRows rows(int block) const {
    const std::ptrdiff_t at = block * points.stride;
    return {.count = points.count,
            .stride = points.stride,
            .v = points.v,
            .slopes = slopes,
            .p = p,
            .trial = trial,
            .step = step,
            .unit = unit,
            .state = state + at,
            .norm = norm + at,
            .scale = scale + at,
            .damping = damping + at,
            .work = work};
  }
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
  for (const auto& shared : analysis.kernels) {
    const Kernel& kernel = *shared;
    Tape::Contribution c{shared, {}, {}};
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

void MomentumSearch::play(const Batch& b) const {
  const Points& points = b.points;
  slopes_.play({points.count, points.stride, points.q, b.trial, points.t}, b.slopes, b.scratch);
}

/// Puts what is not solved at a start.
void MomentumSearch::begin(const Batch& b, int start) const {
  const std::ptrdiff_t stride = b.points.stride;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const double* state = b.state + k * stride;
    for (const int a : blocks_[k].momenta) {
      double *p = b.p + a * stride, *trial = b.trial + a * stride;
      const double* v = b.points.v + a * stride;
      for (int i = 0; i < b.points.count; ++i)
        if (state[i] != solved) trial[i] = p[i] = start_value(start, v[i]);
    }
  }
  play(b);
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    begin_kernel()(b.rows(static_cast<int>(k)), blocks_[k].coupled());
}

/// One step of all that are still searching, from the slopes at their trials; whether some are left.
bool MomentumSearch::advance(const Batch& b) const {
  double left = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    left += advance_kernel()(b.rows(static_cast<int>(k)), blocks_[k].coupled());
  return left > 0;
}

std::size_t MomentumSearch::doubles(const Points& points) const {
  const std::size_t rows = 3 * static_cast<std::size_t>(n_) + slope_rows_ + 4 * blocks_.size(), m = largest_;
  return slopes_.doubles(points.count) + rows * points.stride + m * (m + 1) * most_lanes;
}

void MomentumSearch::find(const Points& points, double* p, Scratch& scratch) const {
  const std::ptrdiff_t n = n_, blocks = static_cast<std::ptrdiff_t>(blocks_.size());
  double* next = scratch.reserve(doubles(points)) + slopes_.doubles(points.count);  // the tape's come first
  const auto rows = [&](std::ptrdiff_t count) { return std::exchange(next, next + count * points.stride); };
  Batch b{.points = points,
          .scratch = scratch,
          .p = p,
          .trial = rows(n),
          .step = rows(n),
          .unit = rows(n),
          .slopes = rows(slope_rows_),
          .state = rows(blocks),
          .norm = rows(blocks),
          .scale = rows(blocks),
          .damping = rows(blocks),
          .work = next};
  const auto all = static_cast<std::size_t>(blocks * points.stride);
  std::fill_n(b.state, all, solved);  // beyond the points as well
  for (std::ptrdiff_t k = 0; k < blocks; ++k) std::fill_n(b.state + k * points.stride, points.count, lost);
  for (int start = 0; start < starts; ++start) {
    begin(b, start);
    for (int k = 0; k <= most_steps && advance(b); ++k) play(b);
    std::replace(b.state, b.state + all, searching, lost);
    if (std::find(b.state, b.state + all, lost) == b.state + all) return;
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    for (int i = 0; i < points.count; ++i)
      if (b.state[k * points.stride + i] != solved)
        for (const int a : blocks_[k].momenta)
          p[a * points.stride + i] = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace extremal
