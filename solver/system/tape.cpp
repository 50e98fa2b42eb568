#include <algorithm>
#include <stdexcept>
#include <string>

#include "machine/simd.hpp"
#include "system/tape_lagrangian.hpp"

namespace extremal {

namespace {

/// Batches played together: enough to pay for the dispatch of an instruction, and no more than lets
/// what they read and write stay in the second-level cache.
constexpr int fewest_batches = 8, most_batches = 16;
constexpr int cache_doubles = 256 * 1024 / sizeof(double);

Player player() { return at_simd_level(EXTREMAL_AT_EACH_LEVEL(play)); }

}  // namespace

/// Some consecutive points of a call.
struct Tape::Chunk {
  Player player;
  const double* q;
  const double* v;
  const double* t;
  double* out;
  std::ptrdiff_t stride;
  int batches;
  double* memory;
  double** operands;
};

Tape::Tape(std::span<const Contribution> contributions, int outputs, std::span<const double> uniforms) {
  std::vector<bool> touched(outputs);
  std::vector<Track> tracks;
  for (const Contribution& c : contributions) {
    tracks.push_back(track(c, touched));
    slots_ = std::max(slots_, tracks.back().program.slots);
    operands_ = std::max(operands_, tracks.back().program.operands());
  }
  tracks_ = std::make_shared<const std::vector<Track>>(std::move(tracks));
  put(uniforms);
  widest_ = std::clamp(cache_doubles / simd_lanes() / std::max(operands_, 1), fewest_batches, most_batches);
  for (int row = 0; row < outputs; ++row)
    if (!touched[row]) untouched_.push_back(row);
}

void Tape::put(std::span<const double> uniforms) {
  scalars_.clear();
  for (const Track& track : *tracks_) {
    scalars_.push_back(row_numbers(*track.kernel, track.program.scalars, uniforms));
    if (scalars_.back().values.empty()) scalars_.back().values.push_back(0);
  }
}

Tape Tape::with(std::span<const double> uniforms) const {
  Tape other = *this;
  other.put(uniforms);
  return other;
}

/// A root is direct if every row of the kernel is the first to reach its row of output.
Tape::Track Tape::track(const Contribution& c, std::vector<bool>& touched) {
  const std::size_t width = c.roots.size();
  std::vector<bool> first(c.rows.size()), direct(width, true);
  for (std::size_t e = 0; e < c.rows.size(); ++e) {
    first[e] = !touched[c.rows[e]];
    touched[c.rows[e]] = true;
    direct[e % width] = direct[e % width] && first[e];
  }
  std::vector<Root> roots;
  for (std::size_t k = 0; k < width; ++k) roots.push_back({c.roots[k], direct[k]});
  Track result{.kernel = c.kernel, .program = lower(*c.kernel, roots), .targets = {}};
  for (std::size_t e = 0; e < c.rows.size(); ++e)
    result.targets.push_back({c.rows[e], first[e] && !direct[e % width]});
  return result;
}

int Tape::width(int batches) const {
  if (batches <= widest_) return batches;
  const int chunks = (batches + widest_ - 1) / widest_;
  return (batches + chunks - 1) / chunks;
}

void Tape::fit(const Tape& other) {
  slots_ = std::max(slots_, other.slots_);
  operands_ = std::max(operands_, other.operands_);
  widest_ = std::min(widest_, other.widest_);
}

void Tape::play(const Track& track, const RowNumbers& scalars, const Chunk& chunk) {
  const Program& program = track.program;
  const Kernel& kernel = *track.kernel;
  const std::size_t length = static_cast<std::size_t>(chunk.batches) * simd_lanes();
  double** const outputs = chunk.operands + program.inputs;
  double** const slots = outputs + program.outputs;
  for (int k = 0; k < program.slots; ++k) slots[k] = chunk.memory + k * length;
  for (int r = 0; r < kernel.rows; ++r) {
    const std::uint32_t* source = kernel.table.data() + static_cast<std::size_t>(r) * program.inputs;
    const Target* target = track.targets.data() + static_cast<std::size_t>(r) * program.outputs;
    for (int k = 0; k < program.inputs; ++k) {
      const Variable kind = kernel.kinds[k];
      const double* base = kind == Variable::coordinate ? chunk.q
                           : kind == Variable::velocity ? chunk.v
                           : kind == Variable::time     ? chunk.t
                                                        : chunk.memory;
      const bool row = kind == Variable::coordinate || kind == Variable::velocity;
      chunk.operands[k] = const_cast<double*>(row ? base + source[k] * chunk.stride : base);
    }
    for (int k = 0; k < program.outputs; ++k) {
      outputs[k] = chunk.out + target[k].row * chunk.stride;
      if (target[k].clear) std::fill_n(outputs[k], length, 0.0);
    }
    chunk.player(program.code.data(), static_cast<int>(program.code.size()), chunk.operands, scalars.row(r),
                 chunk.batches);
  }
}

std::size_t Tape::doubles(int points) const {
  const int lanes = simd_lanes();
  const std::size_t used = static_cast<std::size_t>(slots_ + 1) * width(points / lanes) * lanes;
  return (used + most_lanes - 1) / most_lanes * most_lanes;
}

void Tape::play(const Points& points, double* out, Scratch& scratch) const {
  const int lanes = simd_lanes();
  if (points.count % lanes != 0)
    throw std::invalid_argument("a batch of " + std::to_string(points.count) +
                                " points; need a multiple of " + std::to_string(lanes));
  const int batches = points.count / lanes, width = this->width(batches);
  double* const memory = scratch.reserve(static_cast<std::size_t>(slots_ + 1) * width * lanes);
  if (scratch.operands.size() < static_cast<std::size_t>(operands_)) scratch.operands.resize(operands_);
  for (int begin = 0; begin < batches; begin += width) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(begin) * lanes;
    const auto from = [&](const double* rows) { return rows ? rows + at : memory; };
    const Chunk chunk{.player = player(),
                      .q = from(points.q),
                      .v = from(points.v),
                      .t = from(points.t),
                      .out = out + at,
                      .stride = points.stride,
                      .batches = std::min(width, batches - begin),
                      .memory = memory,
                      .operands = scratch.operands.data()};
    for (std::size_t k = 0; k < tracks_->size(); ++k) play((*tracks_)[k], scalars_[k], chunk);
    for (const int row : untouched_) std::fill_n(chunk.out + row * chunk.stride, chunk.batches * lanes, 0.0);
  }
}

TapeSummary Tape::summary() const {
  TapeSummary s{.kernels = static_cast<int>(tracks_->size())};
  for (const Track& track : *tracks_) {
    const auto length = static_cast<int>(track.program.code.size());
    s.rows += track.kernel->rows;
    s.instructions += length;
    s.slots = std::max(s.slots, track.program.slots);
    s.played += static_cast<long long>(track.kernel->rows) * length;
  }
  return s;
}

}  // namespace extremal
