#pragma once

#include <functional>
#include <span>
#include <string>

/// \file A scalar equation between the ends of a path.

namespace extremal {

struct Vocabulary;

/// g(q(0), q(T)) of N coordinates.
struct EndCondition {
  /// g; writes its gradient over (q(0), q(T)), 2N entries, and, unless `hessian` is empty, its second
  /// derivatives, 2N × 2N.
  std::function<double(std::span<const double> start, std::span<const double> end, std::span<double> gradient,
                       std::span<double> hessian)>
      function;
};

/// An equation "left = right" as end_equation() (formula.hpp) takes it: g = left − right. Throws
/// FormulaError.
EndCondition end_condition(const std::string& text, const Vocabulary& vocabulary, const std::string& where);

}  // namespace extremal
