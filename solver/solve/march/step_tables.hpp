#pragma once

#include <vector>

#include "action/tables.hpp"
#include "machine/aligned.hpp"
#include "solve/march/step_kernels.hpp"
#include "system/lagrangian.hpp"

/// \file A scheme and a Lagrangian as numbers for marching.

namespace extremal {

class StepTables {
 public:
  /// `points` counts only where scheme.quadrature is `exact`. `lagrangian` must outlive the tables.
  StepTables(const Scheme& scheme, int points, const Lagrangian& lagrangian);
  StepTables(const StepTables&) = delete;

  const StepShape& shape() const { return shape_; }
  const SchemeTables& scheme() const { return scheme_; }
  const Lagrangian& lagrangian() const { return lagrangian_; }
  int coordinates() const { return shape_.n; }
  int degree() const { return shape_.s; }
  int unknowns() const { return shape_.n * shape_.s; }

 private:
  void arrange_basis();
  void list_pairs();

  SchemeTables scheme_;
  const Lagrangian& lagrangian_;
  AlignedDoubles node_, weight_, value_, slope_, sum_value_, sum_slope_, test_value_, test_slope_, stiffness_;
  std::vector<double> trial_value_, trial_slope_, linear_;
  std::vector<MassView> mass_, gyroscopic_;
  std::vector<CoupledPair> pairs_;
  StepShape shape_{};
};

}  // namespace extremal
