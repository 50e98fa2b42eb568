#pragma once

#include <span>
#include <vector>

#include "solve/newton/model.hpp"

namespace extremal {

/// S_h as a function of the lengths h_k of its elements as well, T being their sum.
struct LengthDerivatives {
  std::vector<double> slope;     ///< ∂L_d/∂h_k, the discrete energy of element k with the sign changed
  std::vector<double> corner;    ///< ∂²L_d/∂h_k²
  std::vector<Triplet> entries;  ///< (unknown, k, a part of ∂²L_d/∂x∂h_k); parts of one place add up
};

/// δS_h = 0 under the boundary relation in all unknowns at once, nothing condensed: gradient and sparse
/// Hessian. Unknowns are numbered: nodes 1 … N − 1, then the free unknowns of the ends,
/// then the inner ones element by element. The duration, where it is free, is not among them.
class Equations {
 public:
  void reset(const Problem& problem, const ElementTables& tables, int elements);
  /// Lists the places of the Hessian's entries; before that rows() and columns() are empty, and only
  /// gradients may be evaluated. False, and nothing is listed, if the deadline passes before.
  bool list_entries(const Deadline& deadline = {});

  int unknowns() const { return unknowns_; }
  /// Those of nodes and ends, which are numbered first.
  int nodal() const { return (elements_ - 1) * n_ + ends_->free; }
  /// Places of the Hessian's entries, in one triangle or the other; those that share a place add up.
  const std::vector<int>& rows() const { return rows_; }
  const std::vector<int>& columns() const { return columns_; }

  /// Gradient at a path and, unless `entries` is empty, the Hessian's entries. Values that are not finite
  /// show in `action` (see DiscreteAction::finite).
  void evaluate(DiscreteAction& action, const Path& path, std::span<double> entries);

  /// Derivatives by the lengths of the elements at a path, with an action for which T is an unknown. As many
  /// entries in the same places each time.
  void evaluate_lengths(DiscreteAction& action, const Path& path, LengthDerivatives& to) const;

  const std::vector<double>& gradient() const { return gradient_; }
  /// ∂S/∂T; its derivatives by the unknowns, empty where T is fixed, and by T.
  double slope_duration() const { return slope_; }
  const std::vector<double>& by_duration() const { return by_duration_; }
  double corner() const { return corner_; }
  /// The time that belongs to each unknown, roughly: a gradient by it is a force.
  void share_time(const Path& path, std::span<double> to) const;
  /// The number of the unknown q_a at node k between two elements, 0 < k < N, and of inner unknown u of
  /// element k.
  int node_unknown(int k, int a) const { return (k - 1) * n_ + a; }
  int inner_unknown(int k, int u) const { return nodal() + k * inner_ + u; }
  /// A row over (q(0), q(T)), 2n, in the unknowns.
  void express_row(std::span<const double> row, std::vector<double>& to) const;
  /// A direction at the nodes, (N + 1) × n, in the unknowns; only nodal() of them differ from zero.
  void express_direction(std::span<const double> direction, std::span<double> to) const;
  /// The step of a path in which the unknowns change by x, T as it is.
  void expand(std::span<const double> x, Step& step) const;

  /// In place of the gradient that was evaluated last, another: add_gradient() for each batch of elements,
  /// over their local unknowns in lanes.
  void clear_gradient();
  /// Derivatives by q(0) and q(T) (2n, or empty), as those that momenta and costs of the ends make.
  void add_at_ends(std::span<const double> parts);
  void add_gradient(int batch, const double* gradient);
  /// Or a load on the nodes, (N + 1) × n, that on the ends left out.
  void load(std::span<const double> nodes);
  void set_slope_duration(double slope) { slope_ = slope; }

 private:
  /// A share of an unknown: local unknowns at the ends may be combinations of free ones, or none.
  struct Share {
    int unknown;
    double factor;
  };
  struct Source {
    int group;  ///< entry × lane in the batch of the element
    double factor;
  };
  std::span<const Share> shares(int element, int local) const;
  void number_ends();
  void list_entries_of(int element);
  void list_entries_of_costs(std::span<const EndCost> costs);
  void spread(std::vector<double>& to, int first, int last, const double* batch) const;

  const ElementTables* tables_ = nullptr;
  const EndMap* ends_ = nullptr;
  int lanes_ = simd_lanes();
  int n_ = 0, elements_ = 0, inner_ = 0, unknowns_ = 0;
  std::vector<Share> all_, end_shares_;
  std::vector<int> end_start_;
  std::vector<int> rows_, columns_;
  std::vector<int> source_start_;  ///< of each element
  std::vector<Source> sources_;
  std::span<const EndCost> costs_;   ///< of the problem
  std::vector<double> end_entries_;  ///< of the costs of the ends
  std::vector<double> gradient_, by_duration_;
  double corner_ = 0, slope_ = 0;
};

}  // namespace extremal
