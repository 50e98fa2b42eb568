#pragma once

#include <span>
#include <vector>

#include "linear/sparse.hpp"
#include "solve/model.hpp"
#include "solve/sparse_border.hpp"

namespace extremal {

/// All unknowns at once in a sparse matrix: many coordinates, few of them coupled.
/// Unknowns are numbered: nodes 1 … N − 1, then what the boundary relation leaves free of the ends, then
/// the inner ones element by element.
class SparseModel final : public QuadraticModel {
 public:
  void reset(const Problem& problem, const ElementTables& tables, int elements) override;
  bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) override;
  void evaluate_gradient(DiscreteAction& action, const Path& path) override;
  void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) override;
  void respond(DiscreteAction& action, const ClosingEquation* closing, std::span<const double> load,
               Step& step) override;
  Inertia inertia(double) override { return border_.inertia(matrix_); }

  /// In place of the gradient that was evaluated last, another: add_gradient() for each batch of elements,
  /// over their local unknowns in lanes.
  void clear_gradient();
  void add_gradient(int batch, const double* gradient);
  void set_slope_duration(double slope) { slope_ = slope; }

 private:
  /// A share of an unknown: local unknowns at the ends may be combinations of free ones, or none.
  struct Share {
    int unknown;
    double factor;
  };
  std::span<const Share> shares(int element, int local) const;
  void build_pattern();
  void gather(DiscreteAction& action, const Path& path, bool hessian);
  void spread(std::vector<double>& to, int first, int last, const double* batch) const;
  void hold_phases();

  const ElementTables* tables_ = nullptr;
  const EndMap* ends_ = nullptr;
  int n_ = 0, elements_ = 0, inner_ = 0, unknowns_ = 0;
  bool free_duration_ = false;
  std::vector<Share> all_, end_shares_;
  std::vector<int> end_start_;
  struct Source {
    int group;  ///< entry × lane in the batch of the element
    double factor;
  };
  std::vector<int> source_start_;  ///< of each element
  std::vector<Source> sources_;
  SparseSymmetric matrix_;
  SparseBorder border_;
  std::vector<double> gradient_, by_duration_, row_, right_;
  double corner_ = 0, slope_ = 0;
};

}  // namespace extremal
