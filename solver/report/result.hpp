#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "solution/solution.hpp"
#include "study/annotation.hpp"
#include "study/obstacles.hpp"
#include "study/spectra.hpp"

/// \file What is reported: a solution with the names of its coordinates and, on request, samples.

namespace extremal {

/// One value a time.
using Column = std::vector<double>;

/// A trajectory at given times: a column for each coordinate, in the order of the names.
struct Samples {
  Column t;               ///< times in [0, T]
  std::vector<Column> q;  ///< coordinates
  std::vector<Column> v;  ///< velocities dq/dt
  std::vector<Column> p;  ///< canonical momenta ∂L/∂q'
  /// With constraints: λ_k(t) of each, d/dt ∂L/∂q' − ∂L/∂q = Σ λ_k ∂g_k/∂q.
  std::vector<Column> constraint_forces = {};
  /// With inequalities g_k >= 0 along the path: μ_k(t) >= 0, ∂L/∂q − d/dt ∂L/∂q' = Σ μ_k ∂g_k/∂q.
  std::vector<Column> path_forces = {};
  /// L is infinite at an end that is in the first or the last row: velocities and momenta there are NaN.
  bool open_start = false, open_end = false;

  std::size_t count() const { return t.size(); }
  std::size_t coordinates() const { return q.size(); }
};

/// Index of the first entry that is not finite, else the size. NaN is allowed at ends that are open.
std::size_t first_not_finite(const Column& column, bool open_start = false, bool open_end = false);

/// What a fit found beside its trajectory.
struct Fitted {
  std::vector<std::string> parameters, open_ends;  ///< names
  std::vector<double> values;                      ///< of both, parameters first
  std::vector<std::vector<double>> covariance;     ///< rows, in the same order
  bool scaled = false;                             ///< by chi squared, as no sigma is given
  double chi_squared = 0;
  int freedom = 0;  ///< values observed less unknowns
  /// Column by column, one value a time: what was observed and what is left; nothing where it was not.
  std::vector<double> t;
  struct Column {
    std::string name;
    std::vector<std::optional<double>> observed, residual, sigma;
  };
  std::vector<Column> columns;
};

struct Result {
  std::string title;               ///< may be empty
  std::vector<std::string> names;  ///< of the coordinates: "x", "x[1]"
  Solution solution = {};
  double seconds_read = 0;              ///< from opening the scene until the problem was ready
  std::optional<Samples> samples = {};  ///< never written where the solution has not converged
  /// Those of a search, by action; `solution` is the first of them, or tells why there is none.
  std::optional<std::vector<Result>> solutions = {};
  std::optional<SolutionSpectrum> spectrum = {};  ///< where it was asked for
  std::optional<Fitted> fit = {};                 ///< likewise
  /// What pictures show beside the samples: units and centres of the system, boundaries of inequalities.
  Annotation annotation = {};
  std::vector<PlaneCurve> boundaries = {};
  int natural_conditions = 0;  ///< at the ends, of a problem that is not periodic
};

/// Keys in JSON and CSV: "x[1]'" and "p_x[1]".
std::string velocity_key(const std::string& coordinate);
std::string momentum_key(const std::string& coordinate);

/// Throws std::invalid_argument, with the numbers, unless there is one q, v and p column a name and each has
/// one value a time.
void check_shape(const Samples& samples, const std::vector<std::string>& names);

}  // namespace extremal
