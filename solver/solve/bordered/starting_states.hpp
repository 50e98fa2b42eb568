#pragma once

#include <vector>

#include "action/tables.hpp"
#include "problem/extension.hpp"
#include "problem/problem.hpp"
#include "solve/bordered/state.hpp"
#include "solve/guess/first_path.hpp"

/// \file The states that solves with further unknowns start from.

namespace extremal {

/// A starting path: the guess, perhaps bent; and whether the integrals and conditions that it has are led to
/// those that are given, or the action is minimised.
struct Start {
  double size = 0;  ///< of the waves, by the extent; 0: the guess itself
  int first = 1, last = 3;
  unsigned seed = 0;
  bool led = false;
  bool downhill = false;  ///< to a minimiser first
  int ends = -1;  ///< of the ends that are drawn where conditions hold between them; the guess's: −1
  int zero = -1;  ///< of the jump at a waypoint, beside which a state was found

  const char* strategy() const {
    if (zero >= 0) return "newton from a time of the waypoint next to which the jump of the energy vanishes";
    if (ends >= 0) return "newton from other ends that meet the conditions";
    if (downhill) return "minimisation from the guess";
    if (size == 0)
      return led ? "newton from the guess, integrals and conditions led to what is given"
                 : "newton from the guess";
    return led ? "newton from the guess with waves added, integrals and conditions led to what is given"
               : "newton from the guess with waves added";
  }
};

/// Elements of one degree for the Lagrangian of all coordinates and that of the path.
struct Elements {
  const ElementTables *tables, *own;
};

/// The guess of a problem, bent as a start asks for, and led through the waypoints.
class StartingStates {
 public:
  /// `problem` must outlive it.
  explicit StartingStates(const Problem& problem);

  int legs() const { return static_cast<int>(times_.size()); }
  const std::vector<double>& times() const { return times_; }
  LegMesh equal_elements(int elements) const { return extremal::equal_elements(times_, elements); }
  /// On these elements, constants at their guesses and multipliers zero.
  BorderedState at(const LegMesh& mesh, const Elements& elements, const Start& start) const;
  /// The values at waypoints that are given.
  void set_waypoints(BorderedState& state) const;

 private:
  std::vector<double> moved_ends(double size, const std::vector<double>& extent, Noise& noise) const;
  std::vector<double> drawn_ends(const Start& start, const Path& path) const;
  void move_ends(const std::vector<double>& moved, const ElementTables& tables, Path& path) const;
  void bend(const Start& start, const ElementTables& tables, Path& path) const;
  void pass_waypoints(const ElementTables& tables, Path& path) const;

  const Problem& problem_;
  const Extension& extension_;
  int n_;
  std::vector<double> times_;  ///< of the waypoints, then T: guesses where free
};

}  // namespace extremal
