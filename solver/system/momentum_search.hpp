#pragma once

#include <cstddef>
#include <vector>

#include "system/momentum_step.hpp"
#include "system/tape_lagrangian.hpp"

namespace extremal {

/// Solves H_p(q, p, t) = v for p by damped Newton at each point of a batch. H_pp falls into blocks of momenta
/// that it couples; each block is solved for by itself.
class MomentumSearch {
 public:
  /// Throws SingularHamiltonian where a momentum has no entry of H_pp, and std::invalid_argument where more
  /// than most_coupled_momenta are coupled.
  explicit MomentumSearch(const LagrangianGraph& hamiltonian);

  /// The blocks, by coordinate.
  const std::vector<std::vector<int>>& blocks() const { return members_; }

  /// Writes p, n rows of the stride of the points (whose velocities are v); not a number where there is none
  /// that is found.
  void find(const Points& points, double* p, Scratch& scratch) const;
  /// Of scratch memory, that find() takes from its beginning.
  std::size_t doubles(const Points& points) const;

 private:
  struct Block {
    std::vector<int> momenta;
    std::vector<int> rows;  ///< of slopes_ with H_pp, size × size; -1: zero
    CoupledMomenta coupled() const { return {static_cast<int>(momenta.size()), momenta.data(), rows.data()}; }
  };
  struct Batch;
  void play(const Batch& batch) const;
  void begin(const Batch& batch, int start) const;
  bool advance(const Batch& batch) const;

  int n_ = 0, largest_ = 0;
  std::vector<std::vector<int>> members_;
  std::vector<Block> blocks_;
  Tape slopes_;  ///< H_p, then entries of H_pp
  int slope_rows_ = 0;
};

/// In the lanes of the level in use.
void invert(const InverseRows& rows, const CoupledMomenta& coupled);

}  // namespace extremal
