#include "analysis/node_form.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"

namespace extremal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The nodes make a ring, or a chain with coupled ends. Folded, they are a chain again.
NodeForm::NodeForm(SecondVariation& variation, const MatrixXd& ends)
    : n_(variation.coordinates()), pieces_(variation.count()), ends_(ends) {
  chain_.resize(pieces_ / 2 + 1, 2 * n_);
  for (int k = 0; k < chain_.blocks(); ++k) {
    diagonal(k).setZero();
    if (k + 1 < chain_.blocks()) lower(k).setZero();
  }
  sizes_.setZero(chain_.order());
  VectorXd forces = VectorXd::Zero(chain_.order());
  for (int k = 0; k < pieces_; ++k) {
    variation.hold(k);
    const Piece piece = variation.piece(k);
    const MatrixXd a = piece.a, b = piece.b, d = piece.d;
    add(k, k, a);
    add(k + 1, k + 1, d);
    add(k + 1, k, b);
    add(k, k + 1, b.transpose());
    const VectorXd start = (a.cwiseAbs() + b.transpose().cwiseAbs()).rowwise().sum(),
                   end = (d.cwiseAbs() + b.cwiseAbs()).rowwise().sum();
    const VectorXd rigid = (a + b + b.transpose() + d).cwiseAbs().rowwise().sum();
    for (const int node : {k, k + 1}) {
      const int first = 2 * n_ * block_of(node) + place_in(node);
      sizes_.segment(first, n_) += node == k ? start : end;
      forces.segment(first, n_) += rigid;
    }
  }
  for (Eigen::Index i = 0; i < sizes_.size(); ++i)
    if (sizes_[i] > 0) stiffness_ = std::max(stiffness_, forces[i] / sizes_[i]);
  relate(ends);
  scale();
}

/// Above the diagonal there are mirror images.
void NodeForm::add(int row, int column, const MatrixXd& entries) {
  const int r = block_of(row), c = block_of(column);
  if (r < c) return;
  (r == c ? diagonal(r) : lower(c)).block(place_in(row), place_in(column), n_, n_) += entries;
}

/// The ends by y.
void NodeForm::relate(const MatrixXd& ends) {
  MatrixXd z = MatrixXd::Zero(2 * n_, 2 * n_);
  z.leftCols(ends.cols()) = ends;
  diagonal(0) = (z.transpose() * diagonal(0) * z).eval();
  if (chain_.blocks() > 1) lower(0) = (lower(0) * z).eval();
  sizes_.head(2 * n_) = (z.cwiseAbs2().transpose() * sizes_.head(2 * n_)).eval();
}

/// To sizes of one. Places where there is no unknown get the eigenvalue 1, away from the others.
void NodeForm::scale() {
  VectorXd unit = sizes_.unaryExpr([](double size) { return size > 0 ? 1 / std::sqrt(size) : 0; });
  for (int k = 0; k < chain_.blocks(); ++k) {
    const auto here = unit.segment(2 * n_ * k, 2 * n_).asDiagonal();
    diagonal(k) = (here * diagonal(k) * here).eval();
    for (int i = 0; i < 2 * n_; ++i)
      if (unit[2 * n_ * k + i] == 0) diagonal(k)(i, i) = 1;
    if (k + 1 < chain_.blocks())
      lower(k) = (unit.segment(2 * n_ * (k + 1), 2 * n_).asDiagonal() * lower(k) * here).eval();
  }
}

std::optional<int> NodeForm::below(double level) const {
  Chain shifted = chain_;
  for (int i = 0; i < shifted.order(); ++i)
    if (sizes_[i] > 0) shifted.diagonal(i / (2 * n_))[i % (2 * n_) * (2 * n_ + 1)] -= level;
  const std::optional<Inertia> found = shifted.signs();
  return found ? std::optional(found->negative) : std::nullopt;
}

std::optional<double> NodeForm::square(const NodeValues& field) const {
  VectorXd values = VectorXd::Zero(chain_.order()), both(2 * n_);
  both << field.col(0), field.col(pieces_);
  values.head(ends_.cols()) = least_norm(ends_, both);
  for (int k = 1; k < pieces_; ++k) values.segment(2 * n_ * block_of(k) + place_in(k), n_) = field.col(k);
  values.array() *= sizes_.array().sqrt();
  const double size = values.squaredNorm();
  if (!(size > 0)) return std::nullopt;
  VectorXd image(values.size());
  chain_.multiply(values.data(), image.data(), 1);
  return std::abs(values.dot(image)) / size;
}

}  // namespace extremal
