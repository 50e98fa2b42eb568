#pragma once

#include <span>
#include <vector>

#include "system/minimal_expressions.hpp"
#include "system/tape_lagrangian.hpp"

namespace extremal {

/// What these expressions are, a row of output for each.
Tape tape_of(const std::shared_ptr<const Kernel>& kernel, const std::vector<Scaled>& roots);

/// L̂(u, u', t) of minimal_expressions.hpp. w is found at each point by Newton's method from the same start:
/// nothing is kept between evaluations. Not a number beyond the chart, where a pivot of A vanishes.
class MinimalLagrangian final : public Lagrangian {
 public:
  MinimalLagrangian(const MinimalExpressions& expressions, Chart chart);

  const Chart& chart() const { return chart_; }
  int constraints() const { return chart_.coordinates - chart_.free; }

  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  /// Parameters are numbers: throws std::logic_error.
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override;

  /// Of some points, one after the other.
  struct Lifted {
    std::vector<double> q, v;     ///< n each; v is empty where no u' is given
    std::vector<double> stretch;  ///< |∂q/∂u|: the largest sum of a row
  };
  /// u and u' of the points, n − m each, or no u'; and their times.
  Lifted lift(std::span<const double> u, std::span<const double> du, std::span<const double> t) const;

  /// The rows y, with w found for the first rows of the points, and `further` rows. They are in scratch
  /// memory beyond so many doubles, and beyond what the tapes here take.
  double* dependent(const Points& points, std::size_t doubles, std::size_t further, Scratch& scratch) const;

 private:
  void find(const Points& points, double* y, double* moves, Scratch& scratch) const;

  Chart chart_;
  Tape orders_[3];
  Tape start_;   ///< w where the search begins
  Tape moves_;   ///< steps of w, then pivots
  Tape rates_;   ///< w'
  Tape slopes_;  ///< ∂w/∂u
};

}  // namespace extremal
