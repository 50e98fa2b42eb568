#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "analysis/limits.hpp"

/// \file Symmetric matrices that fall with time, and the times at which they are singular.

namespace extremal {

/// F(τ), symmetric, on 0 <= from < τ <= to: it falls strictly in the sense of quadratic forms, and τ F(τ) is
/// analytic. Each eigenvalue changes its sign once at most, so that the negative eigenvalues at τ are as many
/// as there were at `from` and zeros since. F is held by its values at Chebyshev's points.
class FallingForm {
 public:
  /// Points in (0, 1) at which forms are sampled.
  static std::span<const double> points();

  /// From samples at from + points()·(to − from), and the value at `to`; `before`: negative eigenvalues at
  /// `from`. Nothing where these samples do not give the value at `to`.
  static std::optional<FallingForm> of(double from, double to, int before,
                                       std::vector<Eigen::MatrixXd> samples, const Eigen::MatrixXd& last);

  /// The times at which F is singular, ascending, each as often as its multiplicity, as many as `count` (with
  /// `first_only` the first of them); nothing where they are not found.
  std::optional<std::vector<double>> zeros(int count, bool first_only) const;

 private:
  struct Search;
  struct Place {
    double tau;
    int negative;
  };
  using Shares = std::array<double, limits::falling_form::form_samples + 1>;
  int samples() const { return static_cast<int>(values_.size()) - 1; }
  double error() const;
  std::optional<FallingForm> part(Place low, Place high) const;
  Shares shares_at(double tau) const;
  Shares shares_of_slope(double tau) const;
  void sum(std::span<const Shares> shares, std::span<Eigen::VectorXd> sums) const;
  std::optional<int> negative_at(double tau, Search& search) const;
  bool find(Place low, Place high, Search& search) const;
  std::optional<double> single(Place low, Place high, Search& search) const;

  double from_ = 0, to_ = 1;
  int size_ = 0, before_ = 0;
  std::vector<Eigen::VectorXd> values_;  ///< τ F at each sample and at the end: rows of the upper triangle
};

}  // namespace extremal
