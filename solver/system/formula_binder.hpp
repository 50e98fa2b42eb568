#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "system/formula_number.hpp"
#include "system/formula_term.hpp"

/// \file From the syntax tree to the graph.

namespace extremal::formula {

/// A factor or divisor of a summand, with the indices known where it stands.
struct Factor {
  const Formula* formula;
  std::uint32_t node;
  bool inverse;
  Scope scope;
};

/// Builds the nodes of resolved formulas for a term. Parts that are numbers are evaluated; where they
/// differ between rows they become uniforms. Global inputs are numbered as in Term; start and end values
/// of a condition stand where coordinates and velocities do.
class Binder {
 public:
  Binder(const Names& names, LagrangianGraph& target);

  NodeId bind(TermBuilder& builder, const Formula& formula, std::uint32_t node, const Scope& scope);

  /// child ± child …
  NodeId total(TermBuilder& builder, const Formula& formula, std::span<const Link> links, const Scope& scope);

  /// The product of `seed` and the factors. Its numbers are gathered before anything else.
  NodeId product(TermBuilder& builder, std::span<const Factor> factors, NodeId seed);

  Evaluator& evaluator() { return evaluator_; }

  /// While one lives, operations are counted as those of a sum that is written out, and refused beyond
  /// a bound.
  struct Unrolling {
    explicit Unrolling(Binder& binder) : binder(binder) { ++binder.unrolling_; }
    ~Unrolling() { --binder.unrolling_; }
    Unrolling(const Unrolling&) = delete;
    Binder& binder;
  };

 private:
  NodeId reference(TermBuilder& builder, const Formula& formula, const Syntax& node, const Scope& scope);
  NodeId definition(TermBuilder& builder, int id, bool at_end);
  NodeId velocity(TermBuilder& builder, NodeId value);
  NodeId coordinate(TermBuilder& builder, const Formula& formula, const Syntax& node, const Scope& scope);
  NodeId element(TermBuilder& builder, const Formula& formula, const Syntax& node, std::uint32_t first,
                 int count, const Scope& scope);
  NodeId series(TermBuilder& builder, const Formula& formula, const Syntax& node, const Scope& scope);
  NodeId same_input(TermBuilder& builder, std::uint32_t global);
  template <class ValueOfRow>
  std::vector<double> numbers(TermBuilder& builder, const Formula& formula, const Syntax& node,
                              ValueOfRow value);
  NodeId uniform(TermBuilder& builder, std::span<const double> values);

  const Names& names_;
  LagrangianGraph& target_;
  Evaluator evaluator_;
  bool at_end_ = false;                                        ///< in a definition at T
  std::unordered_map<std::uint64_t, std::uint32_t> uniforms_;  ///< bits of a number -> global input
  std::vector<double> indices_;
  int unrolling_ = 0;
  std::size_t unrolled_ = 0;
};

}  // namespace extremal::formula
