#pragma once

#include <memory>
#include <vector>

#include "solve/guess/loop.hpp"
#include "solve/periodic/segment.hpp"
#include "solve/search/pursuit.hpp"

/// \file Periodic orbits from random loops.

namespace extremal {

/// Loops in turn: without symmetry, and with one that is drawn at random. The latter are solved for on a
/// segment alone, where few unknowns are left and Newton's method comes to rest more often, and the orbit
/// that the symmetry makes of it is the start for the whole. Every other loop is first led by steps of
/// bounded length, whether or not they lower anything: these find saddles that damped steps do not come to.
class LoopSearch {
 public:
  /// `whole` is the pursuit of the problem itself, which has run.
  LoopSearch(const Problem& problem, const SolveOptions& options, Workspace& workspace, Pursuit& whole);
  /// Not for a problem that is not periodic.
  bool usable() const { return loops_.usable(); }

  /// From the next loop; whether that leads to an extremal of the problem, which is then the path of the
  /// whole.
  bool next();
  /// That it led to an orbit, perhaps a known one: more of its kind are then tried.
  void credit() { ++orbits_[symmetric_]; }

 private:
  struct Part {
    Segment segment;
    Pursuit pursuit;
    Loops loops;
    Part(Segment drawn, const Problem& whole, const SolveOptions& options, Workspace& workspace)
        : segment(std::move(drawn)),
          pursuit(segment.problem, options, workspace),
          loops(segment.problem, whole) {}
  };
  bool pursue(const Problem& problem, Pursuit& pursuit, Loops& loops, const char* strategy);
  const ElementTables& reconstruct_orbit(const Segment& segment, const Path& part);

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Pursuit& whole_;
  Loops loops_;
  SegmentSource source_;
  bool more_ = true;  ///< symmetries
  std::vector<std::unique_ptr<Part>> parts_;
  unsigned turn_ = 0;
  bool symmetric_ = false;                 ///< the last loop
  double tries_[2] = {}, orbits_[2] = {};  ///< without symmetry and with one
};

}  // namespace extremal
