#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "analysis/variation.hpp"
#include "linear/chain.hpp"

/// \file The second variation by the values of fields where its pieces meet, under a relation of the ends.

namespace extremal {

/// A field along the path by its values where pieces meet, n × (pieces + 1).
using NodeValues = Eigen::MatrixXd;

/// δ²S of the fields that satisfy (η(0), η(T)) = Z y and are Jacobi fields within pieces. Pieces minimise, so
/// that it has the index and the nullity of δ²S. Each node is measured by the sizes of the pieces beside it:
/// errors of a piece, by roundoff or by the path, are relative to these, however short it is.
class NodeForm {
 public:
  /// `ends` is Z, 2n × f. If the variation does not keep its pieces they are evaluated again.
  NodeForm(SecondVariation& variation, const Eigen::MatrixXd& ends);

  /// How many eigenvalues are below `level`, which is known to `roundoff`; nothing if that cannot be told.
  std::optional<int> below(double level) const;
  static constexpr double roundoff = Chain::sign_error;

  /// The largest part of a node's size that the forces of L make of it: 0 where motions are free.
  double stiffness() const { return stiffness_; }

  /// |δ²S[η, η]| of a field that satisfies the relation, relative to its size: nothing of one that vanishes.
  std::optional<double> square(const NodeValues& field) const;

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows> diagonal(int block) { return {chain_.diagonal(block), 2 * n_, 2 * n_}; }
  Eigen::Map<Rows> lower(int block) { return {chain_.lower(block), 2 * n_, 2 * n_}; }
  int block_of(int node) const { return std::min(node, pieces_ - node); }
  int place_in(int node) const { return 2 * node <= pieces_ ? 0 : n_; }
  void add(int row, int column, const Eigen::MatrixXd& entries);
  void relate(const Eigen::MatrixXd& ends);
  void scale();

  int n_, pieces_;
  Eigen::MatrixXd ends_;
  Chain chain_;            ///< folded: block j has the nodes j and pieces − j, block 0 has y
  Eigen::VectorXd sizes_;  ///< of each unknown, squared, 0 where there is none
  double stiffness_ = 0;
};

}  // namespace extremal
