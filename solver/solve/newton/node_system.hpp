#pragma once

#include <optional>
#include <span>
#include <vector>

#include "action/discrete_action.hpp"
#include "linear/border.hpp"
#include "problem/problem.hpp"
#include "solve/newton/model.hpp"

/// \file The linear system of one Newton step, after condensation: the nodes between elements as a
/// chain, bordered by the free unknowns of the ends, and by the duration.

namespace extremal {

class NodeSystem {
 public:
  void reset(const EndMap& ends, int elements, int coordinates, bool free_duration);

  /// Factors the second variation that `nodes` holds, with the directions that are held. False if singular to
  /// working precision.
  bool factor(NodeEquations& nodes, const ClosingEquation* closing, const PhaseConditions* phases = nullptr);

  /// Eigenvalues of the Schur complement of the ends so small, relative, or smaller are null: a step has
  /// nothing along them. For 0 none is, however small. From now until reset(), for the present factors too.
  void set_null_below(double threshold);
  /// How many directions the last step had nothing along.
  int left_out() const { return left_out_; }

  /// Newton step of the nodes, (N + 1) × n, and of T, from the gradient that `nodes` holds; `refine` as
  /// QuadraticModel::set_refining.
  void solve(const NodeEquations& nodes, const ClosingEquation* closing, std::vector<double>& step,
             double& duration_step, bool refine = true);

  /// Of the second variation under the boundary relation; the inner unknowns' negative pivots are counted by
  /// NodeEquations. Eigenvalues within `threshold` of zero, of the chain or of the scaled
  /// Schur complement that remains, are null. So are the directions that are held: counted is the
  /// form across them.
  Inertia inertia(double threshold, VariedBy by = VariedBy::path) const;

 private:
  /// Of end coordinate e among the nodes.
  std::size_t end_index(int e) const { return e < n_ ? e : std::size_t(elements_) * n_ + e - n_; }
  bool factor_schur(const ClosingEquation* closing);
  void factor_border();
  bool factor_exactly(const ClosingEquation* closing);
  void border_right(const NodeEquations& nodes, const ClosingEquation* closing);
  void solve_schur(bool own_row, bool refine);
  void solve_exactly();
  void assemble_border(const NodeEquations& nodes);
  void assemble_phases();
  void scale_border(bool own_row);
  void scale_ends();
  void add_end(double* column, int stride, int e, double factor, const NodeEquations& nodes) const;

  const EndMap* ends_ = nullptr;
  int n_ = 0, elements_ = 0, free_ = 0;
  const PhaseConditions* phases_ = nullptr;
  int held_ = 0, border_ = 0;  ///< columns: free ends, the duration, directions that are held
  bool free_duration_ = false;
  double null_below_ = 0;
  Chain* chain_ = nullptr;
  std::vector<double> columns_, solved_, right_;
  Eigen::MatrixXd corner_, schur_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  std::optional<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>>
      least_norm_;  ///< where LU is singular
  Eigen::VectorXd small_, permuted_;
  Eigen::VectorXd row_units_, column_units_;  ///< that schur_ was multiplied by

  bool exact_ = false, regular_ = false;  ///< the chain is singular, so that system_ is used; system_ is not
  Border system_;
  double smallest_ = 0;  ///< singular value of the Schur complement of system_
  int left_out_ = 0;
};

}  // namespace extremal
