#pragma once

#include <vector>

#include "system/tape_program.hpp"

/// \file Which instruction computes a node, with products fused into the sums that use them.

namespace extremal {

/// An instruction whose operands are still nodes.
struct Selection {
  Code code;
  int reads = 0;
  NodeId arguments[3] = {};
  Scaled scalar = {};
  bool has_scalar = false;
};

/// How many of the operands a, b, c an instruction reads.
int reads(Code code);

/// Chooses instructions for the nodes that a set of roots needs.
class Selector {
 public:
  Selector(const Kernel& kernel, std::span<const Root> roots);

  bool needed(NodeId node) const { return uses_[node] > 0; }
  bool used_once(NodeId node) const { return uses_[node] == 1; }
  /// The same at all points.
  bool uniform(NodeId node) const { return uniform_[node]; }
  /// A product that a sum which needs it can absorb.
  bool fusable(NodeId node) const;
  Selection select(NodeId node) const;
  /// c ± node for a fusable node.
  Selection accumulate(NodeId node, double sign, NodeId c) const;

 private:
  Selection select_sum(NodeId a, NodeId b) const;
  Selection select_difference(NodeId a, NodeId b) const;
  Selection select_product(NodeId a, NodeId b) const;
  bool fusable_plain(NodeId node) const;

  const Graph& graph_;
  std::vector<int> uses_;
  std::vector<bool> uniform_;
};

/// Turns the instruction into one for the opposite sign, if there is one.
bool negate(Selection& selection);

}  // namespace extremal
