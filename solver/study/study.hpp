#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "solution/solution.hpp"
#include "solve/solve.hpp"
#include "study/continued.hpp"
#include "study/spectra.hpp"
#include "study/units.hpp"
#include "system/formula.hpp"

/// \file From a scene to a solution.

namespace extremal {

struct FitRequest;

/// A scene made ready: tape, boundary relation and sampled guess stand.
struct Study {
  std::string scene;               ///< its path, as given
  std::vector<std::string> files;  ///< that it was read from: itself, a system file, a guess
  std::string title;               ///< may be empty
  System system;
  Problem problem;
  SolveOptions options;
  double budget = 60;  ///< seconds after which a verb tries nothing further; options.deadline may be earlier
  int solutions = 0;   ///< so many extremals are wanted; 0: the one reached from the guess
  std::optional<Continued> continuation;
  std::vector<Assignment> forces;   ///< as written; none: the problem has none
  std::vector<Text> constraints;    ///< likewise
  std::vector<Text> integrals;      ///< likewise
  std::vector<Text> inequalities;   ///< along the path, likewise
  std::vector<Text> axes, centres;  ///< of the system's [about], see annotation()
  std::optional<SpectrumRequest> spectrum;
  std::optional<Units> units;
  std::shared_ptr<const FitRequest> fit;  ///< or null. run() and follow() leave it aside
  double seconds_read = 0;                ///< from opening the file until this was ready
};

/// What a scene is read for: [continuation] is left aside where no family is wanted.
enum class Purpose { solution, family, comparison };

/// When work on a study that begins now is to end.
Deadline deadline_of(const Study& study);

/// Reads a scene and the changes "key=value" to it. Throws SceneError with file, line and column, also where
/// the least that a solve needs exceeds the memory there is.
Study load(const std::string& path, const std::vector<std::string>& sets = {},
           Purpose purpose = Purpose::family);

/// The same of a text. Files that it names are looked up beside its name.
Study load(const std::shared_ptr<const Source>& text, const std::vector<std::string>& sets = {},
           Purpose purpose = Purpose::family);

/// Solves `repeat` times from the same guess with one Solver, each time within the budget; where that is
/// spent, no more times. The solution is the last one's; its seconds are the medians. Throws
/// std::invalid_argument if repeat < 1.
Solution run(const Study& study, int repeat = 1);

/// The same for study.solutions extremals, as Solver::solve_all returns them.
std::vector<Solution> run_all(const Study& study, int repeat = 1);

/// Of a solution with constants that were asked for, L + Σ ν g at these becomes the study's Lagrangian:
/// momenta and energies are read off with it. Others leave it as it is.
void use_constants(const Solution& solution, Study& study);

/// Conditions of zero momentum that stationarity adds at the ends. Periodic ends and momenta given otherwise
/// are none.
int natural_conditions(const Problem& problem);

/// Of times of repeated runs, at least one.
double median(std::vector<double> values);

}  // namespace extremal
