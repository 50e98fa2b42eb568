#include "analysis/dichotomy.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of the growth within a block that is formed: log of a factor by which it may cost accuracy.
const double allowed_spread = std::log(1e4);
/// Leading columns are periodic within this.
constexpr double periodic_within = 1e-13;
/// At the ratio 2 of growth roundoff is reached after 53.
constexpr int most_sweeps = 64;

class OrthogonalIteration {
 public:
  explicit OrthogonalIteration(const std::vector<MatrixXd>& factors)
      : factors_(factors), n_(factors.front().rows() / 2), bases_(factors.size() + 1), growth_(n_) {
    // Any basis that favours no direction.
    MatrixXcd start(n_, n_);
    for (Eigen::Index i = 0; i < start.size(); ++i)
      start.data()[i] = {std::cos(1 + 2.4 * i), std::sin(2 + 3.1 * i)};
    bases_.back() = unitary(start).q;
  }

  Dichotomy run() {
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      pass();
      find_groups();
      if (sweep > 0 && moderate()) break;
    }
    return blocks();
  }

 private:
  /// Once through the factors.
  void pass() {
    bases_.front() = bases_.back();
    growth_.setZero();
    for (std::size_t k = 0; k < factors_.size(); ++k) {
      const MatrixXd& factor = factors_[k];
      frame_.resize(2 * n_, n_);
      frame_.topRows(n_) = bases_[k].real();
      frame_.bottomRows(n_) = bases_[k].imag();
      image_.noalias() = factor * frame_;
      complex_.resize(n_, n_);
      complex_.real() = image_.topRows(n_);
      complex_.imag() = image_.bottomRows(n_);
      UnitaryBasis basis = unitary(complex_);
      bases_[k + 1] = std::move(basis.q);
      for (Eigen::Index j = 0; j < n_; ++j) {
        const std::complex<double> pivot = basis.pivots[j];
        const double size = std::abs(pivot);
        if (size > 0) bases_[k + 1].col(j) *= pivot / size;
        growth_[j] += std::log(size);
      }
    }
  }

  /// first_ begins each group of columns that the product maps into itself and those before.
  void find_groups() {
    shift_ = bases_.front().adjoint() * bases_.back();
    first_.assign(1, 0);
    for (Eigen::Index u = 1; u <= n_; ++u) {
      const double below = u < n_ ? shift_.bottomLeftCorner(n_ - u, u).cwiseAbs().maxCoeff() : 0;
      if (below <= periodic_within &&
          shift_.topLeftCorner(u, u).imag().cwiseAbs().maxCoeff() <= periodic_within)
        first_.push_back(u);
    }
  }

  bool moderate() const {
    for (std::size_t g = 0; g + 1 < first_.size(); ++g) {
      const auto growth = growth_.segment(first_[g], first_[g + 1] - first_[g]);
      if (growth.maxCoeff() - growth.minCoeff() > allowed_spread) return false;
    }
    const Eigen::Index rest = n_ - first_.back();
    return rest == 0 || growth_.tail(rest).cwiseAbs().maxCoeff() <= allowed_spread;
  }

  /// Factors in their bases, in the rows and columns of each group.
  Dichotomy blocks() {
    Dichotomy result;
    for (std::size_t g = 0; g + 1 < first_.size(); ++g) {
      const Eigen::Index from = first_[g], count = first_[g + 1] - from;
      result.growing.push_back(MatrixXd::Identity(count, count));
    }
    const Eigen::Index rest = n_ - first_.back();
    result.centre.setIdentity(2 * rest, 2 * rest);
    for (std::size_t k = 0; k < factors_.size(); ++k) {
      const MatrixXd factor = real(bases_[k + 1]).transpose() * factors_[k] * real(bases_[k]);
      multiply(factor, result);
    }
    multiply(real(shift_), result);
    return result;
  }

  void multiply(const MatrixXd& factor, Dichotomy& result) const {
    for (std::size_t g = 0; g < result.growing.size(); ++g) {
      MatrixXd& block = result.growing[g];
      block = factor.block(first_[g], first_[g], block.rows(), block.rows()) * block;
    }
    const Eigen::Index from = first_.back(), rest = n_ - from;
    if (rest == 0) return;
    MatrixXd part(2 * rest, 2 * rest);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        part.block(i * rest, j * rest, rest, rest) = factor.block(i * n_ + from, j * n_ + from, rest, rest);
    result.centre = part * result.centre;
  }

  /// X + iY as the real matrix (X −Y; Y X).
  MatrixXd real(const MatrixXcd& basis) const {
    MatrixXd matrix(2 * n_, 2 * n_);
    matrix.topLeftCorner(n_, n_) = matrix.bottomRightCorner(n_, n_) = basis.real();
    matrix.bottomLeftCorner(n_, n_) = basis.imag();
    matrix.topRightCorner(n_, n_) = -basis.imag();
    return matrix;
  }

  const std::vector<MatrixXd>& factors_;
  Eigen::Index n_;
  std::vector<MatrixXcd> bases_;  ///< before each factor in the last pass, and after all
  VectorXd growth_;               ///< log, of each column in the last pass
  MatrixXcd shift_;               ///< of the last basis against the first
  std::vector<Eigen::Index> first_;
  MatrixXd frame_, image_;
  MatrixXcd complex_;
};

}  // namespace

Dichotomy separate(const std::vector<MatrixXd>& factors) {
  MatrixXd product = factors.front();
  for (std::size_t k = 1; k < factors.size() && product.norm() <= std::exp(allowed_spread); ++k)
    product = factors[k] * product;
  if (product.norm() <= std::exp(allowed_spread)) return {{}, product};
  return OrthogonalIteration(factors).run();
}

}  // namespace extremal
