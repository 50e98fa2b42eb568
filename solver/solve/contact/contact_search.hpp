#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solve/contact/arcs.hpp"
#include "solve/contact/coarse_minimum.hpp"
#include "solve/contact/contact_check.hpp"
#include "solve/contact/junctions.hpp"

/// \file From one first path to a minimiser.

namespace extremal {

/// One start of the search for a minimiser.
class ContactSearch {
 public:
  /// With `several`, whether a solution belongs to a continuum. Keeps references to options and `solve`.
  ContactSearch(const Problem& problem, const SolveOptions& options, const ArcSolve& solve, bool several);

  /// From the nodes of a path of the coarsest elements.
  Solution run(std::vector<double> z);

  /// Coarse minima from which it was tried to go on.
  int attempts() const { return attempts_; }
  /// Whether what was found last is stationary, but no minimum.
  bool saddle() const { return saddle_; }
  /// Whether minima of no duration satisfy what closes it; others may.
  bool no_duration() const { return no_duration_; }
  /// Whether momenta do not determine all junctions of what was found: it belongs to a continuum.
  bool singular() const { return singular_; }

 private:
  struct Joined {
    std::optional<Solution> solution = {};
    std::optional<Violation> missed = {};  ///< by the last path on the way to none
  };
  Joined join(std::vector<Interval> intervals);
  bool take_away_touch(const Junctions& path, std::vector<Interval>& intervals) const;
  std::string describe(const Violation& violation) const;
  std::optional<Solution> accept(Junctions& path);
  std::optional<Solution> accept_free(const Junctions& path);
  struct Attempt {
    std::optional<Solution> solution = {};
    bool final = false;             ///< other elements would lead to nothing else
    std::vector<Stretch> few = {};  ///< where contacts, or what is forbidden, are no longer than few elements
  };
  Attempt from_elements(const CoarseElements& elements);
  std::vector<double> first_nodes(const CoarseElements& elements) const;
  std::vector<Interval> coarse_intervals(CoarseMinimum minimum);
  void refuse(Status status, std::string message);

  Problem problem_;  ///< a free duration, free times and unknowns are those of the path found last
  const SolveOptions& options_;
  const ArcSolve& solve_;
  Arcs arcs_;
  bool several_;
  Guess guess_;
  std::vector<double> constants_;  ///< k and ν of the path found last
  Solution failure_;
  int attempts_ = 0;
  bool singular_ = false, saddle_ = false, no_duration_ = false;
};

}  // namespace extremal
