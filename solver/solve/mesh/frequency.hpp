#pragma once

#include <vector>

#include "action/discrete_action.hpp"
#include "problem/problem.hpp"
#include "solve/mesh/mesh.hpp"

/// \file How fast a system may oscillate along a path, and a mesh that follows it.

namespace extremal {

/// A local bound of the frequency, piecewise linear in τ = t/T.
class Frequency {
 public:
  void clear() {
    density_.clear();
    finite_ = true;
  }
  void add(double tau, double omega);

  /// Whether every ω was.
  bool finite() const { return finite_; }

  /// ∫ω dt; finite.
  double phase() const { return density_.integral() * duration_; }
  void set_duration(double duration) { duration_ = duration; }

  /// See Density.
  double grading(double floor) const { return density_.grading(floor); }
  std::vector<double> mesh(int elements, double floor) const { return density_.mesh(elements, floor); }

 private:
  Density density_;
  double duration_ = 1;
  bool finite_ = true;
};

/// ω² bounds M⁻¹ L_qq by its largest entry at each quadrature point of `path`. Keeps the memory of
/// `frequency`.
void measure_frequency(const Problem& problem, DiscreteAction& action, const ElementTables& tables,
                       const Path& path, Frequency& frequency);

}  // namespace extremal
