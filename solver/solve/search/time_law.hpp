#pragma once

#include <optional>
#include <vector>

#include "action/discrete_action.hpp"
#include "problem/problem.hpp"

/// \file The times at which a path passes its nodes with the least action.

namespace extremal {

/// A path on linear elements is a polygon with times at its corners. With the corners fixed the action is a
/// sum of functions of the lengths h_k of the elements, convex where L is in q'. Where it is least the energy
/// −∂L_d/∂h_k is the same in all elements. Where L is quadratic in q', L_d is a_k/h_k + c_k h_k + const, so
/// that h_k = √(a_k/(E + c_k)); other L are replaced by such functions at the present h_k. What lies between
/// two rests moves in time by any distance at once.
class TimeLaw {
 public:
  /// `tables` must outlive it.
  void reset(const Problem& problem, const ElementTables& tables, int elements);
  /// Moves the nodes of the path in time. Its duration becomes `duration`, or less: the energy above the
  /// least possible one is at least `least_energy` of the largest kinetic one. False, and nothing is done, if
  /// L depends on t or is not convex in q' along the path.
  bool apply(Path& path, double duration, double least_energy = 0);

 private:
  bool measure(const Path& path);
  double duration(double energy) const;
  std::optional<double> energy_for(double duration) const;

  DiscreteAction action_;
  std::vector<double> a_, c_;  ///< c less the least
  std::vector<double> lengths_, shifts_;
  bool autonomous_ = false;
};

}  // namespace extremal
