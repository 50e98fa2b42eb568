#pragma once

#include <array>
#include <vector>

#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "motion/lanes.hpp"
#include "system/lagrangian.hpp"

/// \file The motion of the states in all lanes at once, as a flow in (q, p), p = ∂L/∂q'.

namespace extremal {

/// What Flow computes for one point: one play of the tape serves all lanes. A state is a block of 2n rows,
/// q then p; blocks of variations (δq, δp) may follow, the same number in every lane.
class LaneFlow {
 public:
  /// `lagrangian` must outlive it. Throws std::invalid_argument for a singular constant mass. For `copies`
  /// see Flow.
  explicit LaneFlow(const Lagrangian& lagrangian, int copies = 1);
  LaneFlow(const LaneFlow&) = delete;
  LaneFlow& operator=(const LaneFlow&) = delete;

  int coordinates() const { return n_; }
  const LaneKernels& kernels() const { return kernels_; }

  /// The slope of a state with `columns` variations, at one time a lane. Lanes where it cannot be evaluated
  /// hold what is not finite.
  void slope(const double* t, const double* y, int columns, double* slope);

 private:
  void list_entries();
  void list_entry(int row, int column, const double* value);
  void invert_mass();
  void evaluate(const double* t, const double* y, Order order);
  void solve_velocity(const double* t, const double* y, Order order);
  bool correct_velocity(const double* p, double& before);
  void write_force(double* force);
  void vary(const double* y, int columns, double* slope);

  const Lagrangian& lagrangian_;
  const Lagrangian* hamiltonian_;  ///< where L is made of it: q' = ∂H/∂p; rows of its gradient are those of L
  const Structure& structure_;
  const int all_, n_, lanes_ = simd_lanes();  ///< coordinates of the Lagrangian, and of the motion
  LaneKernels kernels_;
  std::vector<LaneEntry> mass_inverse_, qq_, qv_, vq_, vv_;
  int constant_qv_ = 0, constant_vq_ = 0;  ///< the first entries
  std::vector<double> linear_;
  std::vector<int> gradient_q_, gradient_v_;  ///< rows of output, or −1
  AlignedDoubles constants_, v_, out_, work_, factors_, copies_;
  std::array<double, most_lanes> residual_ = {};  ///< of p = ∂L/∂q', by its size
  Scratch scratch_;
};

/// The kernels of this machine.
LaneKernels lane_kernels();

}  // namespace extremal
