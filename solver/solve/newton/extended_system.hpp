#pragma once

#include <optional>
#include <vector>

#include "action/extended_variation.hpp"
#include "linear/extended_chain.hpp"
#include "solve/newton/model.hpp"

/// \file The linear system of one Newton step with 106 bits: nodes between elements as a chain, bordered as
/// in node_system.hpp.

namespace extremal {

class ExtendedSystem {
 public:
  void reset(const EndMap& ends, int elements, int coordinates, bool free_duration);

  /// From the elements' second variation, and from what `nodes` has of the duration, whose column doubles
  /// know well enough. False if it is singular.
  bool factor(const ExtendedVariation& variation, const NodeEquations& nodes, const ClosingEquation* closing,
              const PhaseConditions* phases);

  /// The right side, (N + 1) × n on the nodes: a gradient, condensed, which the step is to take back.
  struct Load {
    ExtendedRows nodes;      ///< (N + 1) n × 1
    double on_duration = 0;  ///< ∂S/∂T, condensed
  };
  /// Step of the nodes and of T.
  void solve(const Load& load, const ClosingEquation* closing, Step& step) const;

  /// Of the second variation under the boundary relation across the directions that are held, as
  /// NodeSystem::inertia.
  Inertia inertia(double threshold, VariedBy by) const;

 private:
  std::size_t end_index(int e) const { return e < n_ ? e : std::size_t(elements_) * n_ + e - n_; }
  void assemble_chain(const ExtendedVariation& variation);
  void assemble_border(const NodeEquations& nodes, const PhaseConditions* phases);
  ExtendedRows schur(const ExtendedRows& rows) const;
  bool factor_corner();
  void solve_corner(ExtendedRows& x) const;

  const EndMap* ends_ = nullptr;
  int n_ = 0, elements_ = 0, free_ = 0, border_ = 0;
  bool free_duration_ = false, own_row_ = false;
  ExtendedChain chain_;
  ExtendedRows first_, last_, first_lower_, last_lower_;  ///< as NodeEquations has them
  ExtendedRows columns_, rows_, solved_, corner_;         ///< C, Rᵀ, A⁻¹C and D
  ExtendedRows lu_;                                       ///< of the scaled D − R A⁻¹ C
  std::vector<double> row_units_, column_units_;
  std::vector<int> row_at_, column_at_;  ///< pivots in turn
  int rank_ = 0;                         ///< a solution has nothing along the columns beyond
};

}  // namespace extremal
