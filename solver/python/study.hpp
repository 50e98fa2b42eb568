#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "python/arrays.hpp"
#include "report/result.hpp"
#include "study/study.hpp"

/// \file A scene made ready, as Python holds it. Immutable but for memory; several threads may solve at once.

namespace extremal::python {

/// A solution with the study that it solves.
struct Solved {
  std::shared_ptr<const Study> study;
  Solution solution;
  std::shared_ptr<const Fitted> fit = {};  ///< or null
};

/// Constants that the solution found, or a fit, become those of its study; a solution that was pickled has no
/// Lagrangian.
std::shared_ptr<Solved> solved_by(std::shared_ptr<const Study> study, Solution solution,
                                  std::shared_ptr<const Fitted> fit = {});

/// Solvers that are not in use, with their memory.
class Solvers {
 public:
  Solver take();
  void give_back(Solver solver);

 private:
  std::mutex mutex_;
  std::vector<Solver> waiting_;
};

class PyStudy {
 public:
  /// Throws SceneError; `name` is shown in errors, and files are looked up beside it.
  PyStudy(const std::string& text, const std::string& name, bool family);

  const Study& study() const { return *study_; }

  /// With another tolerance where one is given. `progress` is called with an Iteration, of a fit with a
  /// FitStep, or None.
  std::shared_ptr<Solved> solve(std::optional<double> tolerance, const py::object& progress) const;
  /// Up to `most` extremals.
  std::vector<std::shared_ptr<Solved>> search(int most, std::optional<double> tolerance,
                                              const py::object& progress) const;
  std::shared_ptr<FollowedBranch> follow(const py::object& progress) const;

  /// One problem for each row: ends (m, n) and durations (m) in place of the scene's, None: the scene's. The
  /// ends that are replaced are fixed in the scene. A dict of arrays with m rows.
  py::dict solve_many(const std::optional<Doubles>& start, const std::optional<Doubles>& end,
                      const std::optional<Doubles>& duration, std::optional<double> tolerance,
                      int threads) const;

  /// Of a solution: its study.
  std::shared_ptr<const Study> shared() const { return study_; }

 private:
  std::shared_ptr<Solved> fit(std::optional<double> tolerance, const py::object& progress) const;

  std::shared_ptr<const Study> study_;
  std::shared_ptr<Solvers> solvers_;
};

void bind_study(py::module_& module);

}  // namespace extremal::python
