#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problem/end_cost.hpp"
#include "problem/symmetry.hpp"
#include "system/lagrangian.hpp"

/// \file A problem: a Lagrangian, what its ends satisfy, its duration and a guess. Checked once, when it
/// is made; everything after may rely on it.

namespace extremal {

/// B0 q(0) + B1 q(T) = c, given row by row. An end coordinate is numbered e = a for q_a(0) and
/// e = n + a for q_a(T).
struct BoundaryRelation {
  int coordinates = 0;
  int rows = 0;
  std::vector<Triplet> matrix;  ///< (row, e, coefficient)
  std::vector<double> value;    ///< c
  /// The momenta ∂L/∂q' (2n) that the natural conditions of the ends left free ask for; empty: all zero. They
  /// are those of the action S + p(0)·q(0) − p(T)·q(T), whose second variation is that of S.
  std::vector<double> momenta;
  /// Costs of the ends, of the start and of the end; empty: none. The action is S with them.
  std::vector<EndCost> costs;

  /// Adds q_a(0) = x (at_end = false) or q_a(T) = x.
  void fix(int coordinate, bool at_end, double x);
  /// Gives the momentum of an end left free.
  void give_momentum(int coordinate, bool at_end, double p);
  /// Adds a row; returns its number.
  int add_row(double c);
  void add(int row, int e, double coefficient) { matrix.push_back({row, e, coefficient}); }
};

/// The relation solved for as many ends as it fixes: x_e = offset_e + Σ_f Z(e, f) y_f, y free.
struct EndMap {
  int free = 0;
  std::vector<double> offset;  ///< 2n
  std::vector<Triplet> z;      ///< (e, f, coefficient); identity for an end coordinate that is free
  std::vector<char> fixed;     ///< 2n: the coordinate does not depend on y
  std::vector<int> home;       ///< y_f is this end coordinate

  /// Whether it fixes every coordinate of an end.
  bool fixes(bool at_end) const;
};

/// Throws RelationError if the rows contradict each other or one follows from the others.
EndMap solve_relation(const BoundaryRelation& relation);

struct RelationError : std::exception {
  int row;  ///< the row that is redundant or contradicts the earlier ones
  bool contradiction;
  RelationError(int row, bool contradiction) : row(row), contradiction(contradiction) {}
  const char* what() const noexcept override {
    return contradiction ? "boundary conditions contradict each other" : "boundary conditions are redundant";
  }
};

/// A scalar function g of the ends; writes ∂g/∂(q(0), q(T)), 2n entries, and returns g.
using EndFunction = std::function<double(std::span<const double> start, std::span<const double> end,
                                         std::span<double> gradient)>;

/// Fixed: value. Free: value is the guess, and exactly one of energy, where closes it.
struct Duration {
  double value = 0;
  bool free = false;
  std::optional<double> energy;
  EndFunction where;
};

/// q at ascending times tau in [0, 1] (t/T), row by row: q[k*n + a]. Empty: the default guess.
struct Guess {
  std::vector<double> tau;
  std::vector<double> q;
  /// Of an integrator, where it solves the equations of motion but for its ends; else 0.
  int samples_a_step = 0;
  bool given() const { return !tau.empty(); }
  bool motion() const { return samples_a_step > 0; }
  /// Local cubic interpolation, through the samples; constant before the first and after the last.
  void at(double tau, std::span<double> q) const;
};

/// q(0) and the canonical momentum −∂S_h/∂q(0), n each: the motion is marched from there.
struct InitialData {
  std::vector<double> q, p;
  bool paired = false;  ///< of two copies of the coordinates, see copies.hpp
};

class Manifold;

/// Ends at infinity: there the path approaches an equilibrium of L exponentially. The problem leaves such an
/// end free, and its duration is that of the first guess.
struct InfiniteEnds {
  std::vector<double> start, end;  ///< the equilibria, n each; empty: this end is finite
  bool both() const { return !start.empty() && !end.empty(); }
};

struct Reduction;
struct Extension;
struct Inequalities;
struct PhaseSpace;

/// q(T) = R q(0) + c, with R and c in EndMap; kept to tell a periodic problem from other coupled ends.
struct Problem {
  std::shared_ptr<const Lagrangian> lagrangian;
  /// With forces: the Lagrangian of two copies of the coordinates (system/copies.hpp). Null: there are none.
  std::shared_ptr<const Lagrangian> copies;
  std::shared_ptr<const Problem> pair;  ///< with forces: the problem of both copies, which is solved
  bool paired = false;                  ///< the coordinates are two copies, which agree along a solution
  /// With constraints: their manifold. `lagrangian` is then L̃ of system/constraints.hpp. Null: there are
  /// none.
  std::shared_ptr<const Manifold> manifold;
  /// In phase space: the coordinates are (q, p), and `lagrangian` is that of phase_space.hpp. Null: they are
  /// not.
  std::shared_ptr<const PhaseSpace> phase;
  std::vector<std::string> names;  ///< of the coordinates: "x", "q[1]"
  BoundaryRelation boundary;
  EndMap ends;                        ///< of `boundary`
  bool periodic = false;              ///< closed, perhaps up to a symmetry
  std::vector<Generator> symmetries;  ///< of a periodic problem
  Duration duration;
  Guess guess;
  std::shared_ptr<const Reduction> reduction;  ///< of a periodic problem with a symmetric guess, else null
  std::optional<double> curvature;             ///< a bound of M⁻¹V'' known to hold everywhere
  /// In place of conditions at the ends: `boundary` fixes q(0) alone. The duration is then fixed.
  std::optional<InitialData> initial;
  /// Unknown constants, integrals, nonlinear conditions, waypoints; null: there are none. `lagrangian` is
  /// then L + Σ g_j, the constants at their guesses; what closes the duration is part of the extension.
  std::shared_ptr<const Extension> extension;
  std::optional<InfiniteEnds> infinite;
  /// What holds along the path; null: nothing. Sought is a local minimiser of the action.
  std::shared_ptr<const Inequalities> inequalities;

  int coordinates() const { return boundary.coordinates; }
  /// Coordinates without momenta, which follow them in phase space.
  int degrees_of_freedom() const { return phase ? coordinates() / 2 : coordinates(); }
  /// What the equations of motion are made of: they depend on t where this does.
  const Lagrangian& motion() const { return copies ? *copies : *lagrangian; }
  int motion_copies() const { return copies ? 2 : 1; }  ///< of the coordinates there
  /// Whether shifts in time move one extremal to others.
  bool shifts_in_time() const;
  /// Whether both ends are at finite times, and apart.
  bool has_ends() const { return !periodic && !infinite; }
};

/// The problem whose motion starts at (q, p) and lasts that long. Throws as make_problem().
Problem initial_problem(std::shared_ptr<const Lagrangian> lagrangian, InitialData initial, double duration);

/// Checks dimensions, durations and relations, and fills `ends`, `symmetries`, `reduction` and `pair`. Throws
/// std::invalid_argument, which a RecurrenceError is, or RelationError. With forces a free period needs
/// nothing that closes it.
Problem make_problem(Problem problem);

}  // namespace extremal
