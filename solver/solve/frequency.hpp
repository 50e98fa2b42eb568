#pragma once

#include <vector>

#include "action/discrete_action.hpp"
#include "problem/problem.hpp"

/// \file How fast a system may oscillate along a path, and a mesh that follows it.

namespace extremal {

/// A local bound of the frequency, piecewise linear in τ = t/T.
class Frequency {
 public:
  void clear();
  void add(double tau, double omega);

  /// Whether every ω was.
  bool finite() const { return finite_; }

  /// ∫ω dt; finite.
  double phase() const { return sum_ * duration_; }
  void set_duration(double duration) { duration_ = duration; }

  /// Longest against shortest element of such a mesh, at most.
  double grading(double floor) const;

  /// Elements of equal ∫(ω + floor·mean ω) dt.
  std::vector<double> mesh(int elements, double floor) const;

 private:
  std::vector<double> tau_, omega_;
  double sum_ = 0, duration_ = 1, least_ = 0, most_ = 0;
  bool finite_ = true;
};

/// ω² bounds M⁻¹ L_qq by its largest entry at each quadrature point of `path`. Keeps the memory of
/// `frequency`.
void measure_frequency(const Problem& problem, DiscreteAction& action, const ElementTables& tables,
                       const Path& path, Frequency& frequency);

std::vector<double> uniform_mesh(int elements);
std::vector<double> halved(const std::vector<double>& mesh);

}  // namespace extremal
