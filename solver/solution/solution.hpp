#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "action/scheme.hpp"
#include "problem/problem.hpp"
#include "solution/floquet.hpp"

/// \file What a solve returns.

namespace extremal {

class Path;
struct ExtensionValues;
struct PathContacts;

enum class Status {
  converged,
  not_converged,
  collision,
  lost_convexity,
  no_solution_near,
  conjugate_ends,
  iteration_limit,
};

/// As written in a result: "converged", "not-converged", …
const char* name(Status status);

/// What is known of each window, among the paths with its ends: nothing where there are no windows; a strict
/// local minimum, by the second variation sampled along the trajectory; the only minimum there is.
enum class Certificate { none, sampled, global };

/// "none", "sampled", "global".
const char* name(Certificate certificate);

/// Piecewise polynomial q(t) on [0, T].
struct Trajectory {
  int coordinates = 0;
  int degree = 0;             ///< s of every element
  std::vector<double> times;  ///< N + 1 ends of elements, 0 … T
  std::vector<double> nodes;  ///< (s + 1) values an element at its Lobatto points: [(k*(s+1) + j)*n + a]
  /// q' likewise: values rounded to double tell derivatives only to ε|q|s²/h. Empty: taken from the values.
  std::vector<double> slopes = {};
  std::vector<double> lengths = {};  ///< of elements, to more digits than times tell. Empty: taken from those

  int elements() const { return static_cast<int>(times.size()) - 1; }
  double duration() const { return times.empty() ? 0 : times.back(); }
  double length(int element) const {
    return lengths.empty() ? times[element + 1] - times[element] : lengths[element];
  }
  /// q and q' at t in [0, T], n entries each; between two elements of the later one. Throws
  /// std::invalid_argument for other t.
  void at(double t, std::span<double> q, std::span<double> v) const;
  /// The same where tau of an element has passed, which may be told better than t.
  void in_element(int element, double tau, std::span<double> q, std::span<double> v) const;
};

/// The trajectory of a path, to the last digit.
Trajectory trajectory_of(const Path& path);

/// One step of the iteration, for the history.
struct Iteration {
  int elements = 0, degree = 0;
  double residual = 0;  ///< largest component of δS divided by the largest momentum
  double step = 0;      ///< largest change of q
  double damping = 1;
};

/// Of the approach to equilibria at infinite ends: the slowest rate of decay, absent where an end is finite.
struct DecayRates {
  std::optional<double> start, end;
};

/// Pessimistic until proved otherwise.
struct Solution {
  Status status = Status::not_converged;
  std::string message = "nothing has been solved";
  std::string strategy;
  Trajectory trajectory;

  double action = 0;
  std::optional<double> energy, energy_drift;  ///< absent where L depends on t
  std::optional<double> work;                  ///< with forces: theirs, ∫ F·q' dt
  double error_estimate = 0;                   ///< supremum over [0, T] of the error of q, in units of q
  double residual = 0;
  std::optional<int> morse_index, nullity;
  bool minimizing = false;
  /// Abutting, from 0 to T: each minimising with its ends fixed, the union of two neighbours not. Empty where
  /// L_vv is not positive definite, so that no path is a minimum, and where coordinates are too many.
  std::vector<std::array<double, 2>> windows;
  /// In (0, T), to the start as fixed, ascending, repeated by multiplicity.
  std::vector<double> conjugate_times;
  bool conjugate_times_known = false;  ///< only where there are windows, and coordinates not too many
  Certificate certificate = Certificate::none;
  std::optional<Floquet> floquet;        ///< of a periodic problem that has windows, coordinates not too many
  std::optional<double> minimal_period;  ///< of a path with q(T) = q(0) that is periodic; T, or a part of it
  std::optional<DecayRates> rates;       ///< of a problem with infinite ends
  std::vector<double> momentum_start, momentum_end;  ///< canonical, −∂S/∂q(0) and ∂S/∂q(T)

  /// Constants, multipliers and impulses of a problem that asks for them.
  std::shared_ptr<const ExtensionValues> extension;
  /// With inequalities along the path: where they are equalities, and the forces there; else null.
  std::shared_ptr<const PathContacts> contacts;

  bool pinned = false;  ///< the scheme of its elements was asked for
  /// Of those elements: the discrete energy −∂L_d/∂h of each. Empty as element_energies() (observe.hpp) is.
  std::vector<double> element_energies;

  int degree = 0;  ///< of the elements that were solved for; the trajectory's may be higher
  int unknowns = 0, iterations = 0;
  std::vector<Iteration> history;
  double seconds_solve = 0, seconds_analyse = 0;

  bool converged() const { return status == Status::converged; }
  double duration() const { return trajectory.duration(); }
};

}  // namespace extremal
