#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "action/discrete_action.hpp"
#include "solve/bordered/state.hpp"
#include "solve/periodic/phase.hpp"

/// \file Stationarity of S_h with further unknowns: constants, multipliers and times.

namespace extremal {

/// The equations of a problem with an extension on one discretisation. Unknowns are numbered: those of the
/// path (inner ones, nodes, free ends), then k, ν, η, the free times, and the multipliers of the directions
/// that a periodic path is held across. With
///
///   Ŝ = S_h[L + Σ ν g] − Σ ν c + Σ η r,
///
/// each equation is ∂Ŝ/∂x = 0 of its unknown; but those of k, and of T where no energy is given, are replaced
/// by the conditions w = 0. All derivatives with respect to k, ν and times are entries of one sparse matrix.
class BorderedEquations {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// Both must outlive it. `tables` are those of the extension's Lagrangian, `own` those of the n
  /// coordinates.
  void reset(const Problem& problem, const ElementTables& tables, const ElementTables& own,
             const LegMesh& mesh);

  /// From now on the integrals, the conditions r and w, in this order, are to have these values beside what
  /// is given; empty: none. Kept by reset().
  void set_offsets(std::vector<double> offsets) { offsets_ = std::move(offsets); }
  /// Their rows, in this order.
  std::vector<int> target_rows() const;
  /// The sizes of their terms, of the state evaluated last.
  const std::vector<double>& target_sizes() const { return target_sizes_; }
  /// The values that they have, of the state evaluated last.
  std::vector<double> targets() const;

  /// Whether the free times of waypoints stay as they are, for now. Kept by reset().
  void hold_times(bool on) { times_held_ = on; }

  const Extension& extension() const { return *problem_->extension; }
  int coordinates() const { return n_; }
  int unknowns() const { return unknowns_; }
  int of_path() const { return of_path_; }                                     ///< unknowns of the path
  int first_constant() const { return of_path_; }                              ///< k, then ν
  int first_multiplier() const { return of_path_ + extension().constants(); }  ///< η
  int first_time() const { return first_multiplier() + conditions(); }
  int first_held() const { return first_time() + static_cast<int>(free_times_.size()); }
  int conditions() const { return static_cast<int>(extension().conditions.size()); }
  const std::vector<int>& free_times() const { return free_times_; }  ///< as BorderedState::times counts them

  /// The left sides at a state and, with `matrix`, their derivatives. False where they are not finite.
  bool evaluate(const BorderedState& state, bool matrix);
  const Eigen::VectorXd& values() const { return values_; }
  /// The derivatives, one entry a place; parts of one place add up.
  const std::vector<Eigen::Triplet<double>>& entries() const { return entries_; }
  Matrix matrix() const;

  /// state + factor·step. False where times would be out of order.
  bool apply(BorderedState& state, const Eigen::VectorXd& step, double factor) const;

  /// Where the state was evaluated last.
  const DiscreteAction& action() const { return action_; }
  /// ∂S_h/∂q of coordinate a at node k between two elements: the momentum before less that after.
  double node_gradient(int k, int a) const { return node_gradient_[static_cast<std::size_t>(k) * n_ + a]; }
  /// The largest at an end of an element. Of a path that rests at least the one that would take it as far as
  /// its size in its duration.
  double momentum() const { return std::max(momentum_, momentum_of_rest_); }
  /// The largest of the equations of the path, by the largest momentum.
  double residual() const;
  /// Of the integrals, the conditions r and w, by the sizes of their terms.
  double mismatch() const;
  /// The largest that is left of the equations of the free times: energies.
  double energy_jump() const;

  /// What δS_h = 0 makes stationary with fixed times: S_h and, where momenta are given, p(0)·q(0) −
  /// p(T)·q(T).
  double minimised(const BorderedState& state) const;
  /// The time that each unknown of the path stands for.
  Eigen::VectorXd node_times(const BorderedState& state) const;

  /// Index and nullity of the second variation where constants and the duration are held: on the paths that
  /// keep the integrals, the conditions and the waypoints, those without a given time at any time. The matrix
  /// was evaluated last.
  Inertia inertia() const;

 private:
  struct Share {
    int unknown;
    double factor;
  };
  std::span<const Share> shares(int element, int local) const {
    const std::size_t place = static_cast<std::size_t>(element) * local_ + local;
    return {shares_.data() + start_[place], static_cast<std::size_t>(start_[place + 1] - start_[place])};
  }
  /// Of end coordinate e of 2N.
  std::span<const Share> end_shares(int e) const {
    return e < all_ ? shares(0, inner_ + e) : shares(elements_ - 1, inner_ + e);
  }
  void number_unknowns();
  int leg_of(int element) const;
  void add(int row, int column, double value);
  void add_both(int row, int column, double value);
  bool couples_ends(int row, int column) const;
  void add_elements(const BorderedState& state, bool matrix);
  void add_element(int k, int lane, const BatchValues& values, const BorderedState& state, bool matrix);
  void add_conditions(const BorderedState& state, bool matrix);
  void add_gradient(double factor);
  void add_hessian(double factor);
  void add_closing(const BorderedState& state, bool matrix);
  double size_of_terms(std::span<const double> start, std::span<const double> end) const;
  void add_held(const BorderedState& state);
  /// Of each unknown, so that entries in the rows of times are as large as those of the path.
  std::vector<double> units_of_times() const;
  double unite_conditions(int varied, const std::vector<int>& number, std::vector<double>& units) const;

  const Problem* problem_ = nullptr;
  const ElementTables *tables_ = nullptr, *own_ = nullptr;
  LegMesh mesh_;
  std::vector<int> leg_;  ///< of each element
  int n_ = 0, all_ = 0, elements_ = 0, inner_ = 0, local_ = 0, of_path_ = 0, unknowns_ = 0, held_ = 0;
  std::vector<int> free_times_, time_unknown_;  ///< −1: that time is given
  std::vector<char> replaced_;                  ///< rows that conditions take
  std::vector<int> closing_rows_;               ///< of each condition w
  std::vector<Share> shares_;
  std::vector<int> start_;
  DiscreteAction action_;
  Eigen::VectorXd values_;
  std::vector<Eigen::Triplet<double>> entries_, symmetric_;
  std::vector<double> offsets_;
  std::vector<double> node_gradient_, gradient_, hessian_;
  double momentum_ = 0, momentum_of_rest_ = 0, mass_ = 0;
  bool times_held_ = false;
  std::vector<double> target_sizes_;  ///< of the terms of each integral, r and w
  Path own_path_;
  PhaseConditions phases_;
};

}  // namespace extremal
