#pragma once

#include <vector>

#include "solve/newton/model.hpp"

/// \file Changes of a path that take its mesh along.

namespace extremal {

/// A change δq(τ) of a path is also one of the nodes themselves: they move by δτ, and the path at them by
/// δq + q' δτ. To first order the path becomes the same; but where a sharp bend comes earlier or later the
/// values hardly change, and a step may be as long as the bend moves, not as it is wide. Of all δτ that are
/// zero at both ends and linear in each element this takes the least change: (δq + q' δτ)²/extent², its mean
/// over mesh nodes and coordinates, plus a weight times the mean over the elements of (δh/h)².
class Comoving {
 public:
  /// Rewrites a step of the path; `times` becomes δτ at the mesh nodes.
  void take_along(const Path& path, double extent, Step& step, std::vector<double>& times);

 private:
  void measure_slopes(const Path& path);
  void find_times(const Path& path, double extent, const Step& step, std::vector<double>& times);

  std::vector<double> slopes_;  ///< dq/dτ at the nodes of the elements, elements × (s + 1) × n
  std::vector<double> ends_;    ///< and at the mesh nodes, means of both sides, (N + 1) × n
  std::vector<double> upper_;
};

/// Mean over the elements of the product of δh/h of two movements of the mesh; zero where one is empty.
double strain_product(const Path& path, const std::vector<double>& a, const std::vector<double>& b);

}  // namespace extremal
