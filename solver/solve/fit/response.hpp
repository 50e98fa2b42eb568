#pragma once

#include <functional>
#include <span>
#include <vector>

#include "solve/newton/iteration.hpp"

/// \file How an extremal changes with its problem, to first order.

namespace extremal {

/// By what the data of a problem change, to first order, with one unknown of a fit.
struct ProblemChange {
  std::vector<double> parameters;  ///< of each active parameter of the Lagrangian
  std::vector<double> ends;        ///< of EndMap::offset, 2n
  std::vector<double> momenta;     ///< of BoundaryRelation::momenta, 2n; or empty
  double duration = 0;             ///< of a fixed duration
  double energy = 0;               ///< of the energy that closes a free duration
  /// Of the function that closes it, at given ends; or empty.
  std::function<double(std::span<const double> start, std::span<const double> end)> where = {};
};

/// Adds a multiple of one step to another.
void add(Step& to, const Step& step, double factor);

/// Changes of an extremal from the factors of its second variation K. With z the unknowns and θ what changes,
/// δS(z, θ) = 0 gives K ∂z/∂θ = −∂²S/∂z∂θ; ends that move are part of z, and their column of K is a load.
class ExtremalResponse {
 public:
  /// Factors at an extremal of `problem`, on whose elements `newton` is. False where K is singular to working
  /// precision.
  bool factor(NewtonIteration& newton, const Problem& problem, const Path& path, const ElementTables& tables,
              std::span<const ProblemChange> changes);

  /// The change of the path that belongs to a change of the problem.
  void to(const ProblemChange& change, Step& step);

 private:
  struct Mixed {
    AlignedDoubles load;     ///< ∂²S/∂x∂p over the local unknowns of the elements
    double on_duration = 0;  ///< ∂²S/∂T∂p
  };
  void move_copies_alike(Step& step) const;
  void keep_columns();
  void add_parameters(const ProblemChange& change);
  void add_ends(const ProblemChange& change);
  double closing_value(const ProblemChange& change, const ClosingEquation& closing) const;

  NewtonIteration* newton_ = nullptr;
  const Problem* problem_ = nullptr;
  const Path* path_ = nullptr;
  const ElementTables* tables_ = nullptr;
  int n_ = 0, lanes_ = simd_lanes();
  std::vector<Mixed> mixed_;          ///< of each active parameter
  bool columns_ = false;              ///< some change moves the ends or a fixed duration
  DiscreteAction plain_;              ///< T is an unknown
  std::vector<double> first_, last_;  ///< Hessian of the first and the last element, m × m
  AlignedDoubles by_duration_;        ///< ∂²S/∂x∂T, laid out as a load
  double corner_ = 0;                 ///< ∂²S/∂T²
  AlignedDoubles load_;
  double on_duration_ = 0;
};

}  // namespace extremal
