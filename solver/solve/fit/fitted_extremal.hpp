#pragma once

#include <span>
#include <vector>

#include "solve/fit/fit.hpp"

/// \file What a fit moves: an extremal, by values of its unknowns and along the family of others for these.

namespace extremal {

class FittedExtremal {
 public:
  virtual ~FittedExtremal() = default;

  /// Takes an extremal that was found for these values, on its mesh.
  virtual void take(const Solution& solution, std::span<const double> values) = 0;

  /// Unit steps along which `path()` moves to other extremals for the same values. Where each begins is
  /// nothing that is known: their coordinates follow those of the values, and only their changes tell.
  virtual const std::vector<Step>& members() const = 0;

  /// (observed − computed)/σ and, unless `jacobian` is empty, the derivatives by rows. False where there is
  /// no extremal near, or one is not finite. Coordinates stand for values where these are bad unknowns.
  virtual bool evaluate(std::span<const double> coordinates, std::span<double> residuals,
                        std::span<double> jacobian) = 0;

  /// The same derivatives by the values themselves, at the path there is.
  virtual bool evaluate_by_values(std::span<double> residuals, std::span<double> jacobian) = 0;

  /// Of the path there is; false where Newton's method does not converge on its elements.
  virtual bool converge_on_elements() = 0;
  virtual std::vector<double> coordinates() const = 0;
  virtual std::vector<double> values() const = 0;

  virtual const Path& path() const = 0;
  virtual int iterations() const = 0;
};

/// Elements of the scheme that was asked for, or of the degree of a trajectory, whose velocities are right to
/// the tolerance.
Scheme scheme_of(const Trajectory& trajectory, const SolveOptions& options);

/// A trajectory on its mesh as a path of so many coordinates: those of two copies are alike.
void put_trajectory(const Trajectory& trajectory, const ElementTables& tables, Path& path);

/// Of copies of so many coordinates the first.
Trajectory first_copy(Trajectory trajectory, int coordinates);

}  // namespace extremal
