#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "system/formula_syntax.hpp"
#include "system/tape.hpp"

/// \file A term of L while its formula is read: the body grows in the graph, the table column by column.

namespace extremal::formula {

/// An index of an enclosing sum: a column of the term's rows, or one value where the sum is unrolled.
struct Slot {
  int column = -1;
  double value = 0;
};

/// The indices known at a place of a formula, outermost first.
using Scope = std::vector<Slot>;

class TermBuilder {
 public:
  /// One row, no index: a plain summand.
  explicit TermBuilder(Graph& graph) : graph_(graph), body_(graph.constant(0)) {}

  /// One row for each entry of `indices`, rows × depth, row-major.
  TermBuilder(Graph& graph, std::size_t rows, std::size_t depth, std::vector<double> indices)
      : graph_(graph), body_(graph.constant(0)), rows_(rows), depth_(depth), indices_(std::move(indices)) {}

  std::size_t rows() const { return rows_; }
  std::size_t depth() const { return depth_; }
  std::size_t columns() const { return columns_.size(); }
  const std::vector<std::uint32_t>& column(std::uint32_t input) const { return columns_[input]; }
  NodeId body() const { return body_; }

  /// The values that the indices of `scope` have in a row.
  void read(const Scope& scope, std::size_t row, std::vector<double>& indices) const;

  /// The same scope with the values of one row.
  Scope fixed(const Scope& scope, std::size_t row) const;

  /// The local input that reads global input column[r] in row r; equal columns are one input.
  NodeId input(std::vector<std::uint32_t> column);

  void add(NodeId summand, bool negative) {
    body_ = negative ? graph_.sub(body_, summand) : graph_.add(body_, summand);
  }

  /// The term, with inputs that the body does not use left out and the others in the order of the first
  /// row of the table.
  Term finish() const;

  /// Those that have been bound: id, and whether at T of a condition.
  std::map<std::pair<int, bool>, NodeId> definitions;

 private:
  Graph& graph_;
  NodeId body_;
  std::size_t rows_ = 1, depth_ = 0;
  std::vector<double> indices_;
  std::vector<std::vector<std::uint32_t>> columns_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> known_;  ///< hash of a column -> local input
};

}  // namespace extremal::formula
