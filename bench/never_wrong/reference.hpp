#pragma once

#include <optional>

#include "study/study.hpp"

/// \file The true error of a solution, as far as it can be told.

namespace bench {

/// Suprema over [0, T] and coordinates.
struct TrueError {
  double q = 0, v = 0, p = 0;
  double q_unknown = 0;  ///< error of the reference itself
  double q_range = 0, v_range = 0, p_range = 0;
  extremal::Trajectory reference = {};
};

/// Against a solution for the tightest tolerance that is reached from this one. Absent where there is none,
/// and where extremals come in families, so that they would differ by more than errors.
std::optional<TrueError> error_by_reference(const extremal::Study& study, const extremal::Solution& solution);

/// The same from the nearest of a family, where there is one.
std::optional<TrueError> distance_from_nearest(const extremal::Study& study,
                                               const extremal::Solution& solution);

/// Error of q in units of q by one step of multiple shooting, integrated as precisely as can be.
std::optional<double> error_by_shooting(const extremal::Study& study, const extremal::Solution& solution);

double largest_of(const std::vector<double>& values);  ///< in modulus; 0 without values
/// Largest value of path, ends and guess.
double magnitude(const extremal::Problem& problem, const extremal::Trajectory& trajectory);
/// Whether ranges are nothing beside the values of the path, or what is left of guess and ends.
bool rests(const extremal::Problem& problem, const extremal::Trajectory& trajectory);

/// The size that a tolerance is relative to.
double size_of(const extremal::Study& study, const extremal::Trajectory& trajectory);

}  // namespace bench
