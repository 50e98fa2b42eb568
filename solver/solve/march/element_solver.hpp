#pragma once

#include <memory>
#include <span>
#include <vector>

#include "machine/long_sum.hpp"
#include "solve/march/step_tables.hpp"

/// \file One element of a motion: the discrete Euler-Lagrange equations solved forwards.

namespace extremal {

/// (q, p) at a time.
struct MotionState {
  std::vector<LongSum> q, p;
  double time = 0;
};

/// Solves p_k = −∂L_d/∂q_k and 0 = ∂L_d/∂d for the displacement Δ = q_{k+1} − q_k and the deviations d, n s
/// unknowns, by Newton's method with a matrix that is kept as long as it serves. Then p_{k+1} = ∂L_d/∂q_{k+1}
/// is p_k + h Σ b_i ∂L/∂q, because the derivatives of L_d by a common shift of all its nodes are these.
class ElementSolver {
 public:
  explicit ElementSolver(const StepTables& tables);
  ~ElementSolver();
  ElementSolver(const ElementSolver&) = delete;

  enum class Result {
    solved,
    not_finite,  ///< L is not finite where the iteration came to
    singular,
    not_converged,
  };
  /// From `state` over h; x() is the first guess and then the solution, x[a*s + K] as in step_kernels.hpp.
  Result solve(const MotionState& state, double h);
  /// The same by cheap steps alone where there are such: with the kinetic energy's matrix, which asks for h
  /// below the periods of all frequencies, but costs a fraction of one that is factored.
  Result solve_cheaply(const MotionState& state, double h) { return iterate(state, h); }
  bool cheap() const { return kinetic_; }
  void give_up_cheap_steps() { kinetic_ = false; }
  std::span<double> x() { return {x_.data(), static_cast<std::size_t>(size_)}; }

  /// L_d of any element of the degree.
  double action_of(const MotionState& state, std::span<const double> x, double h);

  /// Of the element that was solved.
  double action() const { return action_; }
  /// p_{k+1} − p_k.
  std::span<const double> force() const { return force_; }
  /// The largest component of δS_h that is left, and its place in the iteration.
  double residual() const { return residual_; }
  int steps() const { return steps_; }
  /// Whether steps did not shrink at first: equations may have several solutions, and the one that was found
  /// may be another than that which the motion tends to for small h.
  bool wandered() const { return wandered_; }

  /// To the end of the element.
  void advance(MotionState& state, double time) const;

  const StepTables& tables() const { return tables_; }

 private:
  Result iterate(const MotionState& state, double h);
  bool evaluate(const MotionState& state, double h, Order order);
  bool factor(double h);
  void correct();
  void correct_by_kinetic_energy();
  struct Step {
    double by_extent = 0, by_value = 0;
    bool leaps = false;  ///< farther than any element before
  };
  Step measure();
  bool within_roundings(const MotionState& state);

  const StepTables& tables_;
  const StepShape& shape_;
  const StepKernels& kernels_;
  int size_, stride_;
  bool dense_, velocities_, times_;
  AlignedDoubles points_, rows_, sums_, matrix_, residuals_, correction_, work_;
  StepPoints at_{};
  std::vector<double> x_, q_, force_, extent_, largest_;
  Scratch scratch_;
  double action_ = 0, residual_ = 0;
  bool wandered_ = false;
  int steps_ = 0;
  bool factored_ = false, reuse_ = false;
  double push_ = 0, momentum_ = 0;  ///< largest change of p in an element, relative; largest |p|
  double widest_ = 0;               ///< largest extent of a coordinate
  double factored_h_ = 0;
  bool kinetic_ = false;  ///< the matrix is that of the kinetic energy alone
  int kinetic_failures_ = 0;
  struct Sparse;
  std::unique_ptr<Sparse> sparse_;
};

}  // namespace extremal
