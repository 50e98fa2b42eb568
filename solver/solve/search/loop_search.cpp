#include "solve/search/loop_search.hpp"

#include "machine/simd.hpp"
#include "solve/search/deflation.hpp"
#include "solve/search/guess_mesh.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::loop_search;

namespace {

constexpr const char* from_loop = "newton from a random loop";
constexpr const char* from_symmetric_loop = "newton from a random symmetric loop";

}  // namespace

LoopSearch::LoopSearch(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                       Pursuit& whole)
    : problem_(problem),
      options_(options),
      w_(workspace),
      whole_(whole),
      loops_(problem, problem),
      source_(problem) {}

bool LoopSearch::pursue(const Problem& problem, Pursuit& pursuit, Loops& loops, const char* strategy) {
  pursuit.renew(share);
  const unsigned seed = loops.count++;
  loops.draw(seed);
  const ElementTables& coarse =
      pursuit.open(uniform_mesh(limits::guess_mesh::sketch_elements), Refinement::first_degree);
  loops.fit_size(w_.iteration.action(), coarse, pursuit.path);
  if (!open_fitting(pursuit, [&](const ElementTables& tables, Path& path) { loops.fill(tables, path); }))
    return false;
  if (seed % 2) {
    DeflatedNewton bounded(problem, pursuit.path, w_, [&] { return pursuit.count_step(); });
    if (!bounded.run(pursuit.tables(), {})) return false;
  }
  return pursuit.refine(pursuit.tables(), strategy);
}

/// The orbit of which a path is a segment becomes the path of the whole.
const ElementTables& LoopSearch::reconstruct_orbit(const Segment& segment, const Path& path) {
  const Trajectory part = trajectory_of(path);
  const double T = part.duration();
  const auto n = static_cast<std::size_t>(part.coordinates);
  std::vector<double> mesh;
  for (int k = 0; k < segment.parts; ++k)
    for (int e = 0; e < part.elements(); ++e) mesh.push_back((k + part.times[e] / T) / segment.parts);
  mesh.push_back(1);
  const ElementTables& tables = whole_.open(mesh, part.degree);
  Path& whole = whole_.path;
  whole.set_duration(segment.parts * T);
  const std::size_t size = (part.degree + 1) * n;
  Eigen::MatrixXd moved = Eigen::Map<const Eigen::MatrixXd>(part.nodes.data(), part.coordinates,
                                                            std::ssize(part.nodes) / part.coordinates);
  for (int k = 0; k < segment.parts; ++k, moved = segment.map.r * moved)
    for (int e = 0; e < part.elements(); ++e)
      whole.set_element(k * part.elements() + e, moved.data() + e * size);
  whole.load_ends();
  return tables;
}

bool LoopSearch::next() {
  if (more_ && parts_.size() < most_symmetries) {
    std::optional<Segment> drawn = source_.draw();
    more_ = drawn.has_value();
    if (drawn) {
      parts_.push_back(std::make_unique<Part>(std::move(*drawn), problem_, options_, w_));
      parts_.back()->pursuit.be_like(whole_);
    }
  }
  // Either kind in turn, the one that leads to orbits more often three times of four.
  const auto rate = [&](bool kind) { return (orbits_[kind] + 1) / (tries_[kind] + 1); };
  const unsigned turn = turn_++;
  symmetric_ = turn % 4 == 3 ? rate(true) < rate(false) : rate(true) >= rate(false);
  if (parts_.empty()) symmetric_ = false;
  ++tries_[symmetric_];
  if (!symmetric_) return pursue(problem_, whole_, loops_, from_loop);
  Part& part = *parts_[static_cast<std::size_t>(tries_[1]) % parts_.size()];
  if (!pursue(part.segment.problem, part.pursuit, part.loops, from_symmetric_loop)) return false;
  whole_.renew(share);
  const ElementTables& tables = reconstruct_orbit(part.segment, part.pursuit.path);
  return whole_.refine(tables, from_symmetric_loop);
}

}  // namespace extremal
