#pragma once

#include <span>
#include <vector>

#include "linear/sparse.hpp"
#include "solve/newton/equations.hpp"
#include "solve/newton/sparse_border.hpp"

namespace extremal {

/// All unknowns at once in a sparse matrix: many coordinates, few of them coupled.
class SparseModel final : public SecondVariationModel {
 public:
  void reset(const Problem& problem, const ElementTables& tables, int elements) override;
  bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) override;
  void evaluate_gradient(DiscreteAction& action, const Path& path) override;
  void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) override;
  void add_at_ends(DiscreteAction&, std::span<const double> parts) override { equations_.add_at_ends(parts); }
  void respond(DiscreteAction& action, const ClosingEquation* closing, std::span<const double> load,
               Step& step) override;
  void put_load(DiscreteAction& action, const Path& path, const AlignedDoubles& load,
                double on_duration) override;
  Inertia inertia(double, VariedBy by) override;

  Equations& equations() { return equations_; }

 private:
  bool set_pattern(const Deadline& deadline);
  void hold_phases();

  Equations equations_;
  SparseSymmetric matrix_;
  SparseBorder border_;
  std::vector<double> row_, right_;
  bool ordered_ = false;  ///< the pattern, since reset()
};

}  // namespace extremal
