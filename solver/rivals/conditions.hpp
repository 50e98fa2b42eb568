#pragma once

#include <Eigen/Dense>
#include <vector>

#include "problem/problem.hpp"

/// \file What a motion must satisfy at its ends, in the phase space (q, p), p = ∂L/∂q'.

namespace extremal {

/// Both ends of a motion, n entries each. The velocity at the start serves the energy.
struct EndStates {
  Eigen::VectorXd q_start, p_start, v_start, q_end, p_end;
};

/// Sizes that an error is measured by.
struct PhaseScales {
  double q = 1, p = 1, v = 1;
};

/// The rows of the boundary relation, B0 q(0) + B1 q(T) − c; the natural conditions for what it leaves
/// free, Zᵀ (−p(0), p(T)) less that of momenta that are given, or p(0) of initial data; and, for a free
/// duration, the equation that closes it.
class EndConditions {
 public:
  /// `problem` must outlive it.
  explicit EndConditions(const Problem& problem);

  int rows() const { return rows_; }
  int relation_rows() const { return problem_.boundary.rows; }

  struct Values {
    Eigen::VectorXd residual;
    std::vector<Triplet> derivatives;  ///< columns: q(0), p(0), q(T), p(T), n each
    Eigen::VectorXd size;              ///< Σ |derivative| × scale: what a row counts for one unit of error
    Eigen::VectorXd magnitude;         ///< of what a row was summed from
    bool finite = false;
  };
  Values at(const EndStates& ends, const PhaseScales& scales) const;

 private:
  void add_relation(const EndStates& ends, Values& values) const;
  void add_natural(const EndStates& ends, Values& values) const;
  void add_initial(const EndStates& ends, Values& values) const;
  void add_closing(const EndStates& ends, Values& values) const;

  const Problem& problem_;
  const int n_, rows_;
};

}  // namespace extremal
