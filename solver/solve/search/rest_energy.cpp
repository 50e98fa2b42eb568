#include "solve/search/rest_energy.hpp"

#include <algorithm>
#include <cmath>

#include "problem/rest_point.hpp"
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

double RestEnergy::log_size(double length) const {
  double log = -INFINITY;
  for (const Term& term : terms_)
    if (term.weight != 0.0)
      log = std::max(
          log, std::log(std::abs(term.weight)) + term.power * std::log(length) - term.rate.real() * length);
  return log;
}

double RestEnergy::fastest_rate() const {
  double fastest = 0;
  for (const Term& term : terms_) fastest = std::max(fastest, std::abs(term.rate));
  return fastest;
}

RestEnergy RestEnergy::known() const {
  double largest = 0;
  for (const Term& term : terms_) largest = std::max(largest, std::abs(term.weight));
  std::vector<Term> result;
  for (Term term : terms_) {
    const double size = std::abs(term.weight);
    const bool hidden = size < doubtful * term.doubt;
    if (hidden && std::max(size, term.doubt) < roundoff_of_weights * largest) continue;
    if (size < term.doubt) term.weight = 0;
    result.push_back(term);
  }
  return RestEnergy(std::move(result));
}

bool RestEnergy::doubt_changes(const RestEnergy& other) {
  if (other.terms_.size() != terms_.size()) return false;
  for (std::size_t i = 0; i < terms_.size(); ++i)
    terms_[i].doubt = std::max(terms_[i].doubt, std::abs(terms_[i].weight - other.terms_[i].weight));
  return true;
}

RestEnergy::Action RestEnergy::action(double length, double exponent) const {
  Action sum;
  for (const Term& term : terms_) {
    const Complex fall = std::exp(exponent - term.rate * length) * std::pow(length, term.power);
    sum.doubt += std::abs(fall) * term.doubt;
    if (term.weight == 0.0) continue;  // by an overflow this is no number
    const Complex part = term.weight * fall;
    Complex integral = part / term.rate;  // from the length on
    for (int p = term.power; p > 0; --p) {
      sum.value += integral.real();
      integral *= static_cast<double>(p) / (term.rate * length);
    }
    sum.value += integral.real();
    sum.energy += part.real();
    sum.stiffness += (part * (term.rate - term.power / length)).real();
    sum.most_stiffness += std::abs(part * term.rate);
  }
  return sum;
}

RestEnergy::Value RestEnergy::at(double length) const {
  const double log = log_size(length);
  const Action scaled = action(length, -log);
  return {std::log(std::abs(scaled.energy)) + log, scaled.stiffness / scaled.energy, scaled.energy > 0};
}

bool RestEnergy::held_at(double length) const {
  const Value value = at(length);
  return value.positive && value.stiffness > 0;
}

/// The action of the rest falls on the way: longer where the energy rises, shorter where it is negative.
std::optional<double> RestEnergy::held_near(double length) const {
  const double step = (at(length).positive ? length_step : -length_step) / fastest_rate();
  for (int k = 0; k < most_lengths && length > 0; ++k, length += step)
    if (held_at(length)) return length;
  return std::nullopt;
}

namespace {

/// Lagrange's weights for the value at 0 of a polynomial given at 2^(count − 1), …, 2, 1.
std::vector<double> weights_at_zero(std::size_t count) {
  std::vector<double> weights(count, 1.0);
  const auto node = [&](std::size_t i) { return std::ldexp(1.0, static_cast<int>(count - 1 - i)); };
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      if (j != i) weights[i] *= node(j) / (node(j) - node(i));
  return weights;
}

}  // namespace

/// (length + excess)^p e^−rate·(length + excess) by powers of the length.
std::vector<Complex> RestEnergy::OfTail::weights() const {
  std::vector<Complex> weights(energy->terms_.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Term& term = energy->terms_[i];
    Complex part = term.weight * std::exp(-term.rate * excess);
    for (int p = term.power; p >= 0; --p) {
      weights[i - static_cast<std::size_t>(term.power - p)] += part;
      part *= excess * p / static_cast<double>(term.power - p + 1);
    }
  }
  return weights;
}

std::optional<RestEnergy> RestEnergy::extrapolated(std::span<const OfTail> tails, double roundoff) {
  const std::size_t count = tails.size(), terms_of_each = tails[0].energy->terms_.size();
  for (const OfTail& tail : tails)
    if (tail.energy->terms_.size() != terms_of_each) return std::nullopt;
  std::vector<std::vector<Complex>> found;
  for (const OfTail& tail : tails) found.push_back(tail.weights());
  std::vector<Term> terms;
  for (std::size_t i = 0; i < terms_of_each; ++i) {
    const Term& like = tails[0].energy->terms_[i];
    // Of the last `used` tails: the value at no speed, and how much errors of the last tail count in it.
    const auto value = [&](std::size_t used) {
      const std::vector<double> weights = weights_at_zero(used);
      Complex sum = 0;
      double amplified = 0;
      for (std::size_t k = 0; k < used; ++k) {
        sum += weights[k] * found[count - used + k][i];
        amplified += std::ldexp(std::abs(weights[k]), static_cast<int>(k) - static_cast<int>(used - 1));
      }
      return std::pair(sum, amplified * roundoff * std::abs(sum));
    };
    auto [weight, noise] = value(2);
    double change = INFINITY;
    for (std::size_t used = 3; used <= count; ++used) {
      const auto [next, next_noise] = value(used);
      const double next_change = std::abs(next - weight);
      if (next_change > least_fall * change || next_change + next_noise > change + noise) break;
      weight = next, noise = next_noise, change = next_change;
    }
    terms.push_back({weight, like.rate, change + noise, like.power});
  }
  return RestEnergy(std::move(terms));
}

NearEquilibrium::NearEquilibrium(const Lagrangian& lagrangian, std::span<const double> q)
    : lagrangian_(lagrangian), q_(q.begin(), q.end()) {
  const auto n = static_cast<Eigen::Index>(q_.size());
  const std::vector<double> none(q_.size(), 0);
  Scratch scratch;
  for (int step = 0;; ++step) {
    values_ = evaluate_at(lagrangian, q_, none, 0, Order::hessian, scratch);
    if (step == newton_steps) break;
    const Eigen::Map<const Eigen::VectorXd> force(values_.dq.data(), n);
    Eigen::Map<Eigen::VectorXd>(q_.data(), n) -= solved(Rows(values_.qq.data(), n, n), force).col(0);
  }
  const MatrixXd system = linear_motion(values_, n);
  form_.resize(2 * n, 2 * n);
  form_ << -system.bottomRows(n), system.topRows(n);
  if (!system.allFinite()) return;
  const ComplexEigen eigen = complex_eigen(system, 0);
  const double fastest = eigen.values.cwiseAbs().maxCoeff();
  std::vector<Eigen::Index> falling, rising;
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const double rate = eigen.values[i].real();
    if (std::abs(rate) > least_rate * fastest) (rate < 0 ? falling : rising).push_back(i);
  }
  if (static_cast<Eigen::Index>(falling.size()) != n || static_cast<Eigen::Index>(rising.size()) != n) return;
  stable_ = motions(system, eigen, falling, false);
  unstable_ = motions(system, eigen, rising, true);
}

/// Eigenvectors of a rate that has fewer than its multiplicity m are parallel, to the root of roundoff. Then
/// the null space of (A − rate)^m takes their place.
NearEquilibrium::Motions NearEquilibrium::motions(const MatrixXd& system, const ComplexEigen& eigen,
                                                  const std::vector<Eigen::Index>& of, bool leaving) {
  const double sign = leaving ? 1 : -1, fastest = eigen.values.cwiseAbs().maxCoeff();
  const auto n = std::ssize(of);
  Motions found{.columns = eigen.vectors(Eigen::all, of),
                .rates = sign * eigen.values(of),
                .mixing = MatrixXcd::Zero(n, n)};
  std::vector<bool> done(of.size());
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (done[i]) continue;
    std::vector<Eigen::Index> group;
    for (std::size_t j = i; j < of.size(); ++j)
      if (!done[j] && std::abs(found.rates[j] - found.rates[i]) <= coinciding * fastest)
        group.push_back(static_cast<Eigen::Index>(j));
    const auto m = std::ssize(group);
    const Complex rate = VectorXcd(found.rates(group)).mean();
    const MatrixXcd own = found.columns(Eigen::all, group).colwise().normalized();
    const bool parallel = m > 1 && hermitian_eigenvalues(own.adjoint() * own).minCoeff() < parallel_vectors;
    if (!parallel || std::abs(rate.imag()) > coinciding * fastest) continue;
    MatrixXd off = system - sign * rate.real() * MatrixXd::Identity(2 * n, 2 * n), power = off;
    for (Eigen::Index k = 1; k < m; ++k) power *= off;
    const MatrixXd basis = singular_value_decomposition(power).v.rightCols(m);
    found.columns(Eigen::all, group) = basis.cast<Complex>();
    found.mixing(group, group) = (sign * basis.transpose() * off * basis).cast<Complex>();
    found.powers = std::max(found.powers, static_cast<int>(m));
    for (const Eigen::Index j : group) {
      found.rates[j] = rate.real();
      done[static_cast<std::size_t>(j)] = true;
    }
  }
  return found;
}

std::vector<VectorXcd> NearEquilibrium::Motions::fading(const VectorXcd& c) const {
  std::vector<VectorXcd> left{c};
  for (int p = 1; p < powers; ++p) left.push_back(mixing * left.back() / -static_cast<double>(p));
  return left;
}

bool NearEquilibrium::turns() const {
  Eigen::Index slowest = 0;
  stable_.rates.real().minCoeff(&slowest);
  const Complex rate = stable_.rates[slowest];
  return std::abs(rate.imag()) > least_rate * rate.real();
}

VectorXcd NearEquilibrium::deviation(const Passage& passage) const {
  const auto n = static_cast<Eigen::Index>(q_.size());
  Scratch scratch;
  const PointValues values = evaluate_at(lagrangian_, passage.q, passage.v, 0, Order::gradient, scratch);
  VectorXcd z(2 * n);
  for (Eigen::Index a = 0; a < n; ++a) {
    z[a] = passage.q[a] - q_[a];
    z[n + a] = values.dv[a] - values_.dv[a];
  }
  return z;
}

/// A rest that begins `displaced` by q: what comes back is e^−rate·length of `leaving`, of the motions
/// `away`, and those `back` make up for what it lacks of q there. A rest that ends is the same backwards in
/// time.
std::vector<RestEnergy::Term> NearEquilibrium::from_end(const VectorXcd& leaving, const Motions& away,
                                                        const Motions& back, const VectorXcd& displaced,
                                                        double nonlinear) const {
  const Eigen::Index n = away.rates.size();
  const auto positions = back.columns.topRows(n).partialPivLu();
  const MatrixXcd left = away.columns.transpose() * form_.cast<Complex>() * back.columns;
  const VectorXcd fixed = left * positions.solve(displaced);
  const MatrixXcd made_up = -left * positions.solve(MatrixXcd(away.columns.topRows(n)));
  const double error = nonlinear * leaving.cwiseAbs().maxCoeff();
  const std::vector<VectorXcd> c = away.fading(leaving);
  std::vector<RestEnergy::Term> terms;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (int p = 0; p < away.powers && !displaced.isZero(0); ++p)
      terms.push_back({c[p][j] * fixed[j], away.rates[j], error * std::abs(fixed[j]), p});
    for (Eigen::Index k = 0; k <= j; ++k) {
      const Complex both = j == k ? made_up(j, j) : made_up(j, k) + made_up(k, j);
      const double off = error * (std::abs(leaving[j]) + std::abs(leaving[k]));
      for (int p = 0; p <= 2 * (away.powers - 1); ++p) {
        Complex product = 0;
        for (int a = std::max(0, p - away.powers + 1); a <= std::min(p, away.powers - 1); ++a)
          product += c[a][j] * c[p - a][k];
        terms.push_back({both * product, away.rates[j] + away.rates[k], off * std::abs(both), p});
      }
    }
  }
  return terms;
}

RestEnergy NearEquilibrium::energy(const Passage& before, const Passage& after, double roundoff,
                                   double nonlinear) const {
  const auto n = static_cast<Eigen::Index>(q_.size());
  MatrixXcd columns(2 * n, 2 * n);
  columns << stable_.columns, unstable_.columns;
  const VectorXcd in = coefficients(columns, deviation(before)).head(n),
                  out = coefficients(columns, deviation(after)).tail(n);
  const auto displaced = [&](const Passage& end) -> VectorXcd {
    const VectorXcd q = deviation(end).head(n);
    return q.cwiseAbs().maxCoeff() * stable_.rates.real().maxCoeff() > roundoff ? q : VectorXcd::Zero(n);
  };
  if (before.end) return RestEnergy(from_end(out, unstable_, stable_, displaced(before), nonlinear));
  if (after.end) return RestEnergy(from_end(in, stable_, unstable_, displaced(after), nonlinear));
  std::vector<RestEnergy::Term> terms;
  // W pairs a motion that approaches with that which leaves at its rate.
  const MatrixXcd pairs = unstable_.columns.transpose() * form_.cast<Complex>() * stable_.columns;
  const VectorXcd leaving = pairs.transpose() * out;
  const std::vector<VectorXcd> c = stable_.fading(in);
  const double in_error = nonlinear * in.cwiseAbs().maxCoeff(),
               out_error = nonlinear * out.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double size = pairs.col(i).cwiseAbs().maxCoeff();
    for (int p = 0; p < stable_.powers; ++p)
      terms.push_back({leaving[i] * c[p][i], stable_.rates[i],
                       std::abs(leaving[i]) * in_error + size * out_error * std::abs(in[i]), p});
  }
  return RestEnergy(std::move(terms));
}

}  // namespace extremal
