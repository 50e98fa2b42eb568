#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "machine/deadline.hpp"

/// \file A minimum among points that keep inequalities, by Ipopt.

namespace extremal {

/// A place in a sparse matrix.
struct SparseEntry {
  int row, column;
};

/// f(z) is to be made least where a_i(z) >= 0 for the first constraints, and a_i(z) = 0 for the others. Each
/// function returns false where its values do not exist.
struct InequalityMinimum {
  int variables = 0, inequalities = 0, equations = 0;
  std::vector<double> lower = {}, upper = {};  ///< bounds of z; empty: none
  /// Units of z, f and each a: with them the iteration does not depend on those of the problem. Those of a
  /// may be left out: all one.
  double unit = 1, value_unit = 1;
  std::vector<double> constraint_units = {};
  std::vector<SparseEntry> slopes;  ///< entries of ∂a/∂z, (constraint, variable)
  std::vector<SparseEntry> curvature;  ///< entries of ∂²(f + Σ λ a)/∂z², row >= column, repeated ones add up
  std::function<bool(std::span<const double> z, double& f)> value = {};
  std::function<bool(std::span<const double> z, std::span<double> f_z)> gradient = {};
  std::function<bool(std::span<const double> z, std::span<double> a)> constraints = {};
  std::function<bool(std::span<const double> z, std::span<double> a_z)> constraint_slopes = {};
  std::function<bool(std::span<const double> z, double factor, std::span<const double> multipliers,
                     std::span<double> entries)>
      hessian = {};
  /// Called after each iteration; false ends them.
  std::function<bool()> count = {};
};

struct MinimumReport {
  bool converged = false;
  bool unbounded = false;            ///< points went beyond all bounds
  std::vector<double> multipliers;   ///< >= 0 of the inequalities: ∂f/∂z = Σ μ ∂a/∂z + …
  std::vector<double> of_equations;  ///< λ of the equations: … − Σ λ ∂a/∂z
};

/// Takes z to a local minimum. Throws std::invalid_argument where this build lacks Ipopt.
MinimumReport minimise(const InequalityMinimum& problem, std::vector<double>& z, const Deadline& deadline);

}  // namespace extremal
