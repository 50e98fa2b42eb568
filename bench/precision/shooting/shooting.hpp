#pragma once

#include <memory>
#include <span>
#include <vector>

/// \file Single and multiple shooting as one writes it for one system: equations and their derivatives by
/// hand, sizes that the compiler knows, all memory taken beforehand. Compiled for this processor.
///
/// Only plain data passes: these sources are compiled with other flags than the library.

namespace bench::shooting {

enum class SystemName { pendulum, kepler, henon_heiles, double_pendulum, restricted_three_body, chain };

/// A system with the values of its parameters, in the order of its constructor.
struct SystemChoice {
  SystemName name;
  int coordinates;
  std::vector<double> parameters;
};

/// Components of a state are numbered (q, q').
struct BoundaryProblem {
  double duration = 0;         ///< where free, a guess
  bool free_duration = false;  ///< then the first state has one unknown less
  std::vector<int> unknown;    ///< components of the first state that are sought
  std::vector<int> given;      ///< components of the last state: n
  std::vector<double> value;   ///< of these
  double q_scale = 1, v_scale = 1;
};

/// How to solve it.
struct Setting {
  double tolerance = 1e-9;  ///< of a step and of the last correction, in units of the scales
  double loose = 0;         ///< of a step as long as corrections are large
  int segments = 1;
};

class Shooter {
 public:
  virtual ~Shooter() = default;
  /// From states at the beginning of each segment, row by row; what is not unknown in the first one is exact.
  virtual bool solve(std::span<const double> guess) = 0;
  virtual double duration() const = 0;
  /// States at ascending times, of the solution found, followed at this tolerance. Empty on failure.
  virtual std::vector<double> states(std::span<const double> times, double tolerance) = 0;
};

std::unique_ptr<Shooter> make_shooter(const SystemChoice& system, const BoundaryProblem& problem,
                                      const Setting& setting);

/// q'' of the hand-written equations.
std::vector<double> acceleration(const SystemChoice& system, std::span<const double> q,
                                 std::span<const double> v);

}  // namespace bench::shooting
