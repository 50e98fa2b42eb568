#pragma once

#include <string>
#include <vector>

#include "distance.hpp"
#include "report/temporary_folder.hpp"
#include "study/study.hpp"

/// \file AUTO-07p on one scene: built, started from the scene's guess, and read.

namespace bench {

/// Where AUTO-07p and what it needs are looked for.
struct AutoInstallation {
  std::string folder = "/usr/lib/auto-07p";  ///< of Debian's package auto-07p
  std::string compiler = "gfortran";         ///< AUTO is linked with the equations
};

/// A file of bench/periodic/auto.
struct AutoEquations {
  std::string name;   ///< without .f90
  int unfolding = 1;  ///< parameters from par(2) on, one for each conserved quantity
};

/// NTST, NCOL, EPSL = EPSU, and NWTN of its manual.
struct AutoSetting {
  int intervals = 20, degree = 4;
  double tolerance = 1e-7;  ///< on the last step of Newton's iteration
  int factored = 3;         ///< iterations with a Jacobian of their own
};

/// Piecewise polynomial with `degree` + 1 equally spaced states an interval, neighbours sharing one.
struct AutoOrbit {
  double seconds = 0;  ///< of the iterations that led to it
  double period = 0;
  int degree = 0;
  std::vector<double> times;           ///< intervals + 1, from 0 to `period`
  std::vector<Eigen::VectorXd> nodes;  ///< (q, q')

  Eigen::VectorXd state(double t) const;
};

class AutoProgram {
 public:
  /// Compiles the equations in a temporary folder, which lives as long as this. `study` gives closed ends, a
  /// sampled guess, and duration or energy. Throws std::runtime_error where AUTO-07p is not installed or does
  /// not compile.
  AutoProgram(const AutoInstallation& installation, const AutoEquations& equations,
              const extremal::Study& study);

  /// The orbits after one, two and three solves, each but the first from the one before on a mesh that was
  /// adapted to it; ends early where Newton's iteration does not converge. Time is processor time of AUTO's
  /// one thread from the first evaluation to the end of the iteration, summed over the solves: without the
  /// start, whose first tangent has warmed the caches, without meshes and files.
  std::vector<AutoOrbit> run(const AutoSetting& setting) const;

 private:
  void write_guess(const extremal::Study& study, int unfolding);

  extremal::TemporaryFolder folder_;
  std::string constants_;
  int states_ = 0;
};

}  // namespace bench
