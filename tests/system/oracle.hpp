#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <span>
#include <vector>

#include "system/expression_evaluate.hpp"
#include "system/tape.hpp"

/// \file What a Lagrangian and its derivatives are, from the graph as written, in 50 digits.

namespace extremal::oracle {

using Long = boost::multiprecision::cpp_bin_float_50;

/// A function of many variables with central differences: with steps of 1e-13 in 50 digits the first
/// differences are exact to 1e-26, the second to 1e-24, relative to the higher derivatives.
template <class Function>
class Differences {
 public:
  Differences(Function function, std::vector<Long> point) : function_(function), point_(std::move(point)) {}

  Long value() { return function_(point_); }
  Long first(std::size_t k) { return (shifted(k, 1) - shifted(k, -1)) / (2 * step_); }
  Long second(std::size_t j, std::size_t k) {
    point_[j] += step_;
    const Long above = first(k);
    point_[j] -= 2 * step_;
    const Long below = first(k);
    point_[j] += step_;
    return (above - below) / (2 * step_);
  }

 private:
  Long shifted(std::size_t k, int sign) {
    const Long before = point_[k];
    point_[k] += sign * step_;
    const Long result = function_(point_);
    point_[k] = before;
    return result;
  }
  const Long step_ = Long("1e-13");
  Function function_;
  std::vector<Long> point_;
};

/// L over the global inputs: q, q', t, uniforms.
inline Long lagrangian(const LagrangianGraph& l, const std::vector<Long>& inputs) {
  Long sum = 0;
  for (const Term& term : l.terms) {
    for (int r = 0; r < term.rows(); ++r) {
      std::vector<Long> local(term.arity);
      for (int m = 0; m < term.arity; ++m) local[m] = inputs[term.table[r * term.arity + m]];
      sum += evaluate(l.graph, term.body, std::span<const Long>(local));
    }
  }
  return sum;
}

inline std::vector<Long> widened(std::span<const double> state, double t, std::span<const double> uniforms) {
  std::vector<Long> result(state.begin(), state.end());
  result.emplace_back(t);
  result.insert(result.end(), uniforms.begin(), uniforms.end());
  return result;
}

/// L with differences by its global inputs.
inline auto differences(const LagrangianGraph& l, std::span<const double> state, double t) {
  const auto function = [&l](const std::vector<Long>& inputs) { return lagrangian(l, inputs); };
  return Differences<decltype(function)>(function, widened(state, t, l.uniforms));
}

}  // namespace extremal::oracle
