#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/solve.hpp"
#include "study/continued.hpp"
#include "study/spectra.hpp"
#include "system/formula.hpp"

/// \file From a scene to a solution.

namespace extremal {

/// A scene made ready: tape, boundary relation and sampled guess stand.
struct Study {
  std::string scene;  ///< its path, as given
  std::string title;  ///< may be empty
  System system;
  Problem problem;
  SolveOptions options;
  int solutions = 0;  ///< so many extremals are wanted; 0: the one reached from the guess
  std::optional<Continued> continuation;
  std::optional<SpectrumRequest> spectrum;
  double seconds_read = 0;  ///< from opening the file until this was ready
};

/// Reads a scene and the changes "key=value" to it. Throws SceneError with file, line and column.
Study load(const std::string& path, const std::vector<std::string>& sets = {});

/// Solves `repeat` times from the same guess with one Solver. The solution is the last one's; its seconds
/// are the medians. Throws std::invalid_argument if repeat < 1 and std::length_error where the least
/// that the solve needs exceeds the memory there is.
Solution run(const Study& study, int repeat = 1);

/// The same for study.solutions extremals, as Solver::solve_all returns them.
std::vector<Solution> run_all(const Study& study, int repeat = 1);

/// Of times of repeated runs, at least one.
double median(std::vector<double> values);

}  // namespace extremal
