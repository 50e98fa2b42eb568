#pragma once

#include <span>
#include <vector>

#include "action/path.hpp"

/// \file Values at nodes, interpolated without new extrema.

namespace extremal {

/// Cubic Hermite interpolation of n coordinates whose slopes at the nodes are the weighted harmonic means of
/// those beside them, and zero at extrema: each coordinate is monotone where its values are (Fritsch and
/// Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300).
class MonotoneCubic {
 public:
  /// Through the values of a path at the nodes of its mesh.
  void fit(const Path& path);
  /// Fills a path, already reset, but keeps the ends that were fitted.
  void fill(const ElementTables& tables, Path& path) const;
  /// The nodes were fitted at these τ, ascending.
  std::span<const double> mesh() const { return tau_; }
  double node(std::size_t k, int a) const { return q_[k * n_ + a]; }
  int coordinates() const { return static_cast<int>(n_); }

 private:
  std::size_t n_ = 0;
  std::vector<double> tau_, q_, slope_;
};

}  // namespace extremal
