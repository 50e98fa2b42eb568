#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/external/inequality_minimum.hpp"

/// \file Minima of the coarse action for values of the duration and the unknown constants.

namespace extremal {

/// Nodes and their times, which those of free waypoints change.
struct CoarsePath {
  std::vector<double> z, times;
};

/// Minima on such elements, each continued from the last one. Free times of waypoints are those by which
/// the action is least too.
class CoarseMinima {
 public:
  struct Minimum {
    Problem problem;  ///< with the values that belong to the path
    CoarsePath path;
    MinimumReport report = {};
    double closing = 0;              ///< what a free duration makes zero
    std::vector<double> where = {};  ///< what unknowns make zero
  };

  /// From the nodes z of a path at coarse_times(). Keeps a reference to the deadline.
  CoarseMinima(const Problem& problem, CoarseElements elements, std::vector<double> z,
               const Deadline& deadline);

  /// The minimum for these values; nothing where there is none, or only one on another side of an obstacle
  /// than the last.
  std::optional<Minimum> at(double duration, const std::vector<double>& unknowns);
  /// The same, which becomes the last; whether there is one.
  bool find(double duration, const std::vector<double>& unknowns);
  void take(Minimum minimum) { last_ = std::move(minimum); }

  const Minimum& last() const { return last_; }
  const MinimumReport& failure() const { return failure_; }  ///< of the first attempt
  const Deadline& deadline() const { return deadline_; }

 private:
  CoarseElements elements_;
  const Deadline& deadline_;
  Minimum last_;
  MinimumReport failure_;
};

}  // namespace extremal
