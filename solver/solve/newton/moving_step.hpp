#pragma once

#include <vector>

#include "action/path.hpp"
#include "linear/extended_rows.hpp"
#include "solve/newton/model.hpp"

/// \file Steps that move the nodes in time with the path.

namespace extremal {

/// Adds factor · step to a path. Where that shifts it in time by a good part of an element, as beside an
/// encounter that comes sooner or later, nodes go along: t_k moves by σ_k = −q'·δq/|q'|², and q by what
/// is left, δq + σ q'. To first order that is the same path. To second order it is not: values at fixed times
/// are linear in the shift only as far as the encounter lasts, values at times that move are linear much
/// farther. The ends stay, and so do all nodes where the shift is small or elements would be turned over.
class MovingStep {
 public:
  void add(const Step& step, double factor, Path& path);

 private:
  bool measure_shift(const Step& step, double factor, const Path& path);
  bool keeps_elements(const Path& path) const;
  void shift_inner(const Path& path);

  std::vector<double> slopes_;  ///< N × (s + 1) × n, q'
  std::vector<double> shift_;   ///< N + 1, in t/T
  AlignedDoubles inner_;
  ExtendedRows nodes_;
  std::vector<double> zero_;
};

}  // namespace extremal
