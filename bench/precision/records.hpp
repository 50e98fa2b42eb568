#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

/// \file What is measured.

namespace bench {

/// The errors that the means are taken over.
inline constexpr std::array<double, 2> mean_errors{1e-8, 1e-11};
/// The errors at which programs are compared: where peers' figures exist, and the hardest one without them.
inline constexpr std::array<double, 4> compared_errors{1e-4, 1e-8, 1e-11, 1e-14};

/// A program at one setting.
struct Run {
  double tolerance = 0;
  std::string failure = "not run";  ///< empty where it converged
  int segments = 0;                 ///< of shooting
  double loose = 0;                 ///< its tolerance far from the solution; 0: the same
  double seconds = 0;               ///< median
  double error = 0;                 ///< of q, in its units: largest over coordinates and reference times
  bool converged() const { return failure.empty(); }
};

/// A run of this library, with what it says of itself.
struct Cell : Run {
  int elements = 0, degree = 0, unknowns = 0, iterations = 0, repeats = 0;
  double allowed = 0;         ///< what the tolerance allows: tolerance times the largest range
  double estimate = 0;        ///< error_estimate
  double velocity_error = 0;  ///< relative to the largest range of a velocity
  double honesty() const { return estimate / error; }
};

/// Runs of another program on a scene, or why there are none.
struct Rival {
  std::string name;
  std::string absence = {};
  std::vector<Run> runs = {};
};

struct SceneRecord {
  std::string name;
  std::string refusal;   ///< why it was not solved; empty where it was
  bool boundary = true;  ///< counts in the means over boundary problems
  std::vector<Cell> cells;
  Rival single_by_hand{.name = "single shooting by hand"},
      multiple_by_hand{.name = "multiple shooting by hand"};
  Rival single{.name = "single shooting"}, multiple{.name = "multiple shooting"}, scipy{.name = "scipy"};

  std::array<const Rival*, 5> rivals() const {
    return {&single_by_hand, &multiple_by_hand, &single, &multiple, &scipy};
  }
};

/// Seconds of the fastest run whose true error is at most `error`.
template <class Runs>
std::optional<double> time_at_error(const Runs& runs, double error) {
  std::optional<double> best;
  for (const auto& run : runs)
    if (run.converged() && run.error <= error) best = std::min(run.seconds, best.value_or(run.seconds));
  return best;
}

/// The fastest of several, where there is one.
inline std::optional<double> least(std::initializer_list<std::optional<double>> times) {
  std::optional<double> best;
  for (const auto& time : times)
    if (time) best = std::min(*time, best.value_or(*time));
  return best;
}

/// Seconds of the fastest rival of this run.
inline std::optional<double> best_rival(const SceneRecord& scene, double error) {
  std::optional<double> best;
  for (const Rival* rival : scene.rivals()) best = least({best, time_at_error(rival->runs, error)});
  return best;
}

}  // namespace bench
