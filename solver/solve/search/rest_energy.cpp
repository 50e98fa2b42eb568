#include "solve/search/rest_energy.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::balance;

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Complex = std::complex<double>;
using Rows = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

VectorXcd coefficients(const MatrixXcd& columns, const VectorXcd& right) {
  return columns.partialPivLu().solve(right);
}

}  // namespace

RestEnergy::RestEnergy(std::vector<Term> terms) {
  double largest = 0;
  for (const Term& term : terms) largest = std::max(largest, std::abs(term.weight));
  for (const Term& term : terms)
    if (std::abs(term.weight) > tail_speed * tail_speed * largest) terms_.push_back(term);
}

RestEnergy::Value RestEnergy::at(double length) const {
  double slowest = INFINITY;
  for (const Term& term : terms_) slowest = std::min(slowest, term.rate.real());
  double sum = 0, fall = 0;
  for (const Term& term : terms_) {
    const Complex part = term.weight * std::exp((slowest - term.rate) * length);
    sum += part.real();
    fall += (part * term.rate).real();
  }
  return {std::log(std::abs(sum)) - slowest * length, fall / sum, sum > 0};
}

bool RestEnergy::held_at(double length, bool positive) const {
  const Value value = at(length);
  return value.positive == positive && value.stiffness > 0;
}

/// The action of the rest falls on the way: longer where the energy rises, shorter where its sign is wrong.
std::optional<double> RestEnergy::held_near(double length, bool positive) const {
  double fastest = 0;
  for (const Term& term : terms_) fastest = std::max(fastest, std::abs(term.rate));
  const double step = (at(length).positive == positive ? length_step : -length_step) / fastest;
  for (int k = 0; k < most_length_steps && length > 0; ++k, length += step)
    if (held_at(length, positive)) return length;
  return std::nullopt;
}

NearEquilibrium::NearEquilibrium(const Lagrangian& lagrangian, std::span<const double> q)
    : q_(q.begin(), q.end()) {
  const auto n = static_cast<Eigen::Index>(q_.size());
  const std::vector<double> none(q_.size(), 0);
  Scratch scratch;
  for (int step = 0;; ++step) {
    values_ = evaluate_at(lagrangian, q_, none, 0, Order::hessian, scratch);
    if (step == newton_steps) break;
    const Eigen::Map<const Eigen::VectorXd> force(values_.dq.data(), n);
    Eigen::Map<Eigen::VectorXd>(q_.data(), n) -= solved(Rows(values_.qq.data(), n, n), force).col(0);
  }
  const Rows mass(values_.vv.data(), n, n), stiffness(values_.qq.data(), n, n), turn(values_.vq.data(), n, n);
  MatrixXd system = MatrixXd::Zero(2 * n, 2 * n);
  system.topRightCorner(n, n).setIdentity();
  system.bottomLeftCorner(n, n) = solved(mass, stiffness);
  system.bottomRightCorner(n, n) = solved(mass, turn.transpose() - MatrixXd(turn));
  form_ = MatrixXd::Zero(2 * n, 2 * n);
  form_.topLeftCorner(n, n) = -stiffness;
  form_.bottomRightCorner(n, n) = mass;
  if (!system.allFinite()) return;
  const ComplexEigen eigen = complex_eigen(system, 0);
  const double fastest = eigen.values.cwiseAbs().maxCoeff();
  std::vector<Eigen::Index> falling, rising;
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const double rate = eigen.values[i].real();
    if (std::abs(rate) > slowest_rate * fastest) (rate < 0 ? falling : rising).push_back(i);
  }
  if (static_cast<Eigen::Index>(falling.size()) != n || static_cast<Eigen::Index>(rising.size()) != n) return;
  stable_ = eigen.vectors(Eigen::all, falling);
  unstable_ = eigen.vectors(Eigen::all, rising);
  decays_ = -eigen.values(falling);
  growths_ = eigen.values(rising);
}

VectorXcd NearEquilibrium::deviation(const Passage& passage) const {
  const auto n = static_cast<Eigen::Index>(q_.size());
  VectorXcd z(2 * n);
  for (Eigen::Index a = 0; a < n; ++a) {
    z[a] = passage.q[a] - q_[a];
    z[n + a] = passage.v[a];
  }
  return z;
}

/// A rest that begins `displaced` by q: what comes back is e^−rate·length of `leaving`, in columns `away`,
/// and columns `back` make up for what it lacks of q there. A rest that ends is the same backwards in time.
std::vector<RestEnergy::Term> NearEquilibrium::from_end(const VectorXcd& leaving, const VectorXcd& rates,
                                                        const MatrixXcd& away, const MatrixXcd& back,
                                                        const VectorXcd& displaced) const {
  const Eigen::Index n = rates.size();
  const auto positions = back.topRows(n).partialPivLu();
  const MatrixXcd parts = away * leaving.asDiagonal(), left = form_.cast<Complex>() * parts;
  const VectorXcd fixed = left.transpose() * (back * positions.solve(displaced));
  const MatrixXcd made_up = left.transpose() * (back * positions.solve(MatrixXcd(-parts.topRows(n))));
  std::vector<RestEnergy::Term> terms;
  for (Eigen::Index j = 0; j < n; ++j) {
    terms.push_back({fixed[j], rates[j]});
    for (Eigen::Index k = 0; k < n; ++k) terms.push_back({made_up(j, k), rates[j] + rates[k]});
  }
  return terms;
}

RestEnergy NearEquilibrium::energy(const Passage& before, const Passage& after, double roundoff) const {
  const auto n = static_cast<Eigen::Index>(q_.size());
  MatrixXcd columns(2 * n, 2 * n);
  columns << stable_, unstable_;
  const VectorXcd in = coefficients(columns, deviation(before)).head(n),
                  out = coefficients(columns, deviation(after)).tail(n);
  const auto displaced = [&](const Passage& end) -> VectorXcd {
    const VectorXcd q = deviation(end).head(n);
    return q.cwiseAbs().maxCoeff() * decays_.real().maxCoeff() > roundoff ? q : VectorXcd::Zero(n);
  };
  if (before.end) return RestEnergy(from_end(out, growths_, unstable_, stable_, displaced(before)));
  if (after.end) return RestEnergy(from_end(in, decays_, stable_, unstable_, displaced(after)));
  std::vector<RestEnergy::Term> terms;
  const VectorXcd leaving = form_.cast<Complex>() * (unstable_ * out);
  for (Eigen::Index i = 0; i < n; ++i)
    terms.push_back({leaving.cwiseProduct(stable_.col(i)).sum() * in[i], decays_[i]});
  return RestEnergy(std::move(terms));
}

}  // namespace extremal
