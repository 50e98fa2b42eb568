#pragma once

#include <functional>
#include <optional>
#include <string>

#include "action/rule.hpp"
#include "problem/closing.hpp"
#include "solve/adapt/workspace.hpp"
#include "solve/curve/move.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

/// \file The equations of a branch of extremals, linearised at one path of it.

namespace extremal {

/// The number that varies along a branch.
enum class Varied { duration, energy, parameter };

/// Problems that differ in one number.
struct ProblemFamily {
  Problem problem;  ///< where it begins
  Varied varied = Varied::duration;
  double from = 0, to = 1;  ///< the number there, and where the branch is to lead
  /// The problem with this value of a parameter, if it has one; for Varied::parameter. Its boundary relation
  /// has the same coefficients, its ends, duration and energy may differ.
  std::function<std::optional<Problem>(double)> at = {};
  /// Of orbits of twice the period: how those of the single one close.
  std::function<ClosingMap(double)> half = {};
  std::string name = varied == Varied::energy     ? "energy"
                     : varied == Varied::duration ? "duration"
                                                  : "parameter";
};

/// Curves through a path: with x the path, δS = 0 and the equation that closes a free duration leave of (x,
/// T) one direction where the duration or the energy varies, and of (x, T, p) one where a parameter p does.
class Branch {
 public:
  Branch(const ProblemFamily& family, Path& path, Workspace& workspace);

  /// Takes over the path as it is, on elements of its degree, with this value of the coordinate.
  bool set_coordinate(double coordinate);
  /// Binds the equations to the path after its elements changed.
  void bind();
  /// The coordinate that Move::parameter changes: the parameter, or the duration.
  double coordinate() const { return by_duration() ? path_.duration() : coordinate_; }
  /// Moves path and coordinate; false if there is no problem there, or corners cannot follow (see defined()).
  bool apply(const Move& move, double factor);
  /// Scalar product of a tangent with the nonlinear part of the last apply(): ends and durations that do not
  /// depend linearly on the parameter.
  double drift(const Move& tangent) const;

  Move correction, direction;
  /// Solves the linearised equations at the path: correction + α·direction. False where they cannot be.
  /// With the factors of the path that was linearised before, the direction stays that of there.
  bool linearise(Factors factors = Factors::anew);
  /// Whether there are factors of a path in the same problem and on the same elements.
  bool factored() const { return factored_; }
  /// Whether null directions of the equations are those of single points, as of folds, and not of a family
  /// that is degenerate; a branch that begins at such a point knows it from the branch that it leaves.
  bool regular() const { return folds_ == true; }
  /// How many directions the equations that were linearised at last leave open.
  int open() const { return w_.iteration.model().left_out(); }
  /// How many directions symmetries, or what is held, keep moves across.
  int phases() const { return phases_.count; }
  /// Leaves nothing of a move along these.
  void take_across_phases(Move& move) const;
  void set_regular() { folds_ = true; }
  /// The next linearisation tells it.
  void ask_regular() { folds_.reset(); }
  /// Whether there was a problem at the coordinate to which the path was moved last and, if it was linearised
  /// there, next to it, with L finite.
  bool defined() const { return defined_; }
  /// What had better close the equations near the path that was linearised at last, whose tangent is given:
  /// the energy, a displacement of the ends, or the duration.
  ClosingEquation closing(const Move& onward) const;
  void close_by(const ClosingEquation& closing) { closing_ = closing; }
  /// The response of the equations linearised last, with the tangent `onward` as their last row, to one of
  /// several loads without any symmetry: the nearer to a branch point, the longer, and along null directions
  /// there. Where these have one eigenvalue the response to a load has nothing across that to another.
  void respond(const Move& onward, Move& response, int which = 0);
  /// How far a node of the path that was linearised last moves across the direction, relative to the extent,
  /// to where the equations hold under another quadrature, on tables of the same degree: to first order.
  double step_under(const ElementTables& quadrature);
  /// Corrections have nothing along these directions from the next linearisation on: where the equations are
  /// singular along them, the others stay regular. On the elements of the path; empty for none.
  void hold(std::vector<Move> directions) { held_ = std::move(directions); }
  /// The same along directions in which the extremals of each value are a family: the branch goes across
  /// them.
  void hold_family(std::vector<Move> directions) { family_directions_ = std::move(directions); }
  const std::vector<Move>& held_family() const { return family_directions_; }

  /// Of the path that was linearised.
  double action() const { return action_; }
  double energy() const { return energy_; }
  /// The largest force left there, relative to the largest momentum.
  double residual() const { return residual_; }
  /// What is left of the forces there along a direction.
  double force_along(const Move& direction) const;
  /// −∂S/∂q(0), then ∂S/∂q(T).
  std::span<const double> momenta() const { return momenta_; }
  /// The number that varies.
  double varied() const;
  /// By how much a move makes it greater, correction and direction apart.
  double change(bool along) const;
  /// The size of that number: an error of the path changes it by about as much, relative.
  double varied_unit() const;
  /// The sign of the determinant of the equations with the tangent `onward`·direction as their last row: it
  /// changes where branches cross, but not at folds.
  int orientation(double onward) const;
  /// Of the second variation, duration and parameter held.
  const Inertia& inertia() const;
  /// Eigenvalues within `null` of zero, relative, are null; the path is known to `path`, relative.
  struct Errors {
    double null = zero_eigenvalue, path = 0;
  };
  void set_errors(const Errors& errors) { errors_ = errors; }

  /// ∂S/∂s along onward·direction from the derivatives of the action: −E ∂T/∂s + ∂S/∂p ∂p/∂s.
  double action_slope() const { return action_slope_; }

  const Problem& problem() const { return problem_; }
  const ElementTables& tables() const { return *tables_; }
  /// Mean over τ, by the nodes, relative to an extent of the path; durations relative to another, parameters
  /// to the distance wanted.
  double dot(const Move& a, const Move& b) const;
  /// The most that a node is moved, which short elements hide in the mean; inner nodes, too, as those of an
  /// element of half a period move far while its ends hardly do.
  double largest(const Move& move) const;
  struct Units {
    double extent = 1, duration = 1;
  };
  void set_units(const Units& units) { units_ = units; }

 private:
  bool by_duration() const { return family_.varied != Varied::parameter; }
  bool linearise_duration(Factors factors);
  bool solve_closed(Factors factors);
  ClosingEquation closed_by_duration() const;
  bool linearise_parameter();
  bool respond_to_parameter();
  bool evaluate(const ClosingEquation* closing, Factors factors);
  void hold_along(const Move& direction);
  void negate_second(std::vector<double>& nodes) const;
  double energy_change(const Move& move) const;
  bool ordered_by_energy() const;
  const Inertia& inertia_with_duration() const;
  double solve_beside(double by, Move& move);
  void fit_path(const Problem& problem);
  void note_action();
  double work_of_momenta(const Move& move) const;
  std::vector<double> ends() const;
  double weight(int k) const;

  const ProblemFamily& family_;
  Path& path_;
  Workspace& w_;
  Problem problem_;
  Levels beside_;
  const ElementTables* tables_ = nullptr;
  double coordinate_ = 0, unit_;
  Errors errors_;
  bool defined_ = true, factored_ = false;
  std::optional<bool> folds_;  ///< its null directions are those of folds, not of a degenerate family
  Units units_;
  ClosingEquation closing_;     ///< where the duration or the energy varies
  double along_ = 0, off_ = 0;  ///< changes of the energy by direction and correction
  double action_ = 0, energy_ = 0, residual_ = 0, energy_unit_ = 1, action_slope_ = 0;
  /// Along the extremals of all durations, the parameter held: relative, by a direction of length one along
  /// which the closing equation grows. NaN: not known, or the equations with it are singular.
  struct ByDuration {
    double duration = 1, energy = NAN;
  } free_;
  mutable std::optional<Inertia> inertia_, with_duration_;  ///< of the last linearisation, once asked for
  Path at_;
  PhaseConditions phases_;  ///< of the path that was linearised: moves have nothing along them
  std::vector<Move> held_, family_directions_;
  std::vector<double> momenta_;
  std::vector<double> forces_;  ///< (N + 1) × n
  std::vector<double> ends_;    ///< nonlinear part of the last apply(), 2n
  double stretch_ = 0;          ///< and the duration
};

}  // namespace extremal
