#include "analysis/falling_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/limits.hpp"
#include "linear/dense.hpp"
#include "linear/symmetric_elimination.hpp"

namespace extremal {

using namespace limits::falling_form;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int most_nodes = form_samples + 1;

/// The points, zeros of Chebyshev's polynomial, and 1 after them; their barycentric weights, and those of the
/// points without 1.
struct Chebyshev {
  int samples;
  std::array<double, most_nodes> points;
  std::array<double, most_nodes> weights, weights_inside;
  explicit Chebyshev(int count) : samples(count) {
    static_assert(form_samples % 2 == 0 && part_samples % 2 == 0);
    for (int j = 0; j < samples; ++j) {
      const double angle = (j + 0.5) * std::numbers::pi / samples;
      points[j] = (1 - std::cos(angle)) / 2;
      weights_inside[j] = (j % 2 == 0 ? 1 : -1) * std::sin(angle);
      weights[j] = weights_inside[j] / (2 * samples * (1 - points[j]));
    }
    points[samples] = weights[samples] = 1;
    weights_inside[samples] = 0;
  }
};

const Chebyshev& chebyshev(int samples) {
  static const Chebyshev whole(form_samples), part(part_samples);
  return samples == form_samples ? whole : part;
}

/// Shares of the nodes in the value at `at` in (0, 1].
std::array<double, most_nodes> shares(double at, const Chebyshev& c, const double* weights) {
  std::array<double, most_nodes> result{};
  double sum = 0;
  for (int j = 0; j <= c.samples; ++j) {
    if (at == c.points[j] && weights[j] != 0) {
      result.fill(0);
      result[j] = 1;
      return result;
    }
    if (weights[j] != 0) sum += result[j] = weights[j] / (at - c.points[j]);
  }
  for (double& share : result) share /= sum;
  return result;
}

/// The rows of the upper triangle, one after the other.
VectorXd packed(const MatrixXd& m) {
  const Eigen::Index n = m.rows();
  VectorXd rows(n * (n + 1) / 2);
  for (Eigen::Index i = 0, at = 0; i < n; at += n - i++) rows.segment(at, n - i) = m.col(i).tail(n - i);
  return rows;
}

MatrixXd unpacked(const VectorXd& rows, int n) {
  MatrixXd m(n, n);
  for (Eigen::Index i = 0, at = 0; i < n; at += n - i++) m.col(i).tail(n - i) = rows.segment(at, n - i);
  return m;
}

/// xᵀMx.
double quadratic_form(const VectorXd& rows, const VectorXd& x) {
  const Eigen::Index n = x.size();
  double sum = 0;
  for (Eigen::Index i = 0, at = 0; i < n; at += n - i++)
    sum += x[i] * (2 * rows.segment(at, n - i).dot(x.tail(n - i)) - rows[at] * x[i]);
  return sum;
}

void load(const VectorXd& rows, int n, SymmetricElimination& to, int rest) {
  to.resize(n, rest);
  const double* from = rows.data();
  for (int i = 0; i < n; from += n - i++) std::copy_n(from, n - i, to.pivot_row(i) + i);
}

}  // namespace

struct FallingForm::Search {
  SymmetricElimination elimination;
  std::array<VectorXd, 2> form_and_slope;
  std::vector<double> found;
  bool first_only = false;
};

std::span<const double> FallingForm::points() {
  return {chebyshev(form_samples).points.data(), form_samples};
}

std::optional<FallingForm> FallingForm::of(double from, double to, int before, std::vector<MatrixXd> samples,
                                           const MatrixXd& last) {
  FallingForm form;
  form.from_ = from;
  form.to_ = to;
  form.before_ = before;
  form.size_ = static_cast<int>(last.rows());
  const Chebyshev& c = chebyshev(form_samples);
  for (int j = 0; j < c.samples; ++j)
    form.values_.push_back((from + c.points[j] * (to - from)) * packed(samples[j]));
  form.values_.push_back(to * packed(last));
  if (!(form.error() <= most_form_error)) return std::nullopt;
  return form;
}

/// Of what the samples give at the end.
double FallingForm::error() const {
  VectorXd inside;
  const Chebyshev& c = chebyshev(samples());
  const Shares of_inside = shares(1, c, c.weights_inside.data());
  sum({&of_inside, 1}, {&inside, 1});
  return (inside - values_.back()).cwiseAbs().maxCoeff();
}

/// The same form by fewer samples between two times, if they give it to roundoff.
std::optional<FallingForm> FallingForm::part(Place low, Place high) const {
  FallingForm form;
  form.from_ = low.tau;
  form.to_ = high.tau;
  form.before_ = low.negative;
  form.size_ = size_;
  const Chebyshev& c = chebyshev(part_samples);
  std::array<Shares, part_samples + 1> shares;
  for (int j = 0; j <= part_samples; ++j) {
    const double tau = low.tau + c.points[j] * (high.tau - low.tau);
    shares[j] = shares_at(tau);
    for (double& share : shares[j]) share *= tau;
  }
  form.values_.resize(shares.size());
  sum(shares, form.values_);
  if (!(form.error() <= most_part_error)) return std::nullopt;
  return form;
}

/// Of the nodes in F(tau).
FallingForm::Shares FallingForm::shares_at(double tau) const {
  const Chebyshev& c = chebyshev(samples());
  Shares result = shares((tau - from_) / (to_ - from_), c, c.weights.data());
  for (double& share : result) share /= tau;
  return result;
}

/// Of the nodes in F'(tau), by a difference: its error slows the iteration to a zero, but not more.
FallingForm::Shares FallingForm::shares_of_slope(double tau) const {
  const double step = slope_step * (tau - from_);
  Shares result = shares_at(tau + step);
  const Shares before = shares_at(tau - step);
  for (int j = 0; j <= samples(); ++j) result[j] = (result[j] - before[j]) / (2 * step);
  return result;
}

/// Sums over the nodes with these shares. Part by part, so that what is read serves all of them.
void FallingForm::sum(std::span<const Shares> shares, std::span<VectorXd> sums) const {
  static_assert(form_samples % 4 == 0 && part_samples % 4 == 0);
  constexpr Eigen::Index part = 256;
  const Eigen::Index all = values_[0].size();
  for (VectorXd& s : sums) s.resize(all);
  for (Eigen::Index from = 0; from < all; from += part) {
    const Eigen::Index count = std::min(part, all - from);
    const auto value = [&](int j) { return values_[j].segment(from, count); };
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const Shares& share = shares[k];
      auto to = sums[k].segment(from, count);
      to = share[samples()] * value(samples());
      for (int j = 0; j < samples(); j += 4)
        to += share[j] * value(j) + share[j + 1] * value(j + 1) + share[j + 2] * value(j + 2) +
              share[j + 3] * value(j + 3);
    }
  }
}

std::optional<int> FallingForm::negative_at(double tau, Search& search) const {
  VectorXd& form = search.form_and_slope[0];
  const Shares shares = shares_at(tau);
  sum({&shares, 1}, {&form, 1});
  load(form, size_, search.elimination, 0);
  if (search.elimination.eliminate()) return search.elimination.inertia().negative;
  if (!form.allFinite()) return std::nullopt;
  return static_cast<int>((symmetric_eigenvalues(unpacked(form, size_)).array() < 0).count());
}

/// One zero between two times: the time at which the form of an approximate null vector vanishes is off by
/// the square of the vector's error (Voss, BIT Numer. Math. 44 (2004) 387, on safeguarded iteration). With
/// F z = x the form of z at tau is zᵀx. After a step d the error is about d² over the distance of other
/// zeros, and so over the width of the interval, if the vector has settled.
std::optional<double> FallingForm::single(Place low, Place high, Search& search) const {
  const double enough = zero_resolution * to_ * (high.tau - low.tau);
  double tau = (low.tau + high.tau) / 2;
  SymmetricElimination& elimination = search.elimination;
  const auto& [form, slope] = search.form_and_slope;
  VectorXd x(size_), z(size_);
  for (int i = 0; i < size_; ++i) x[i] = std::cos(1 + (2.4 + 0.37 * i) * i);  // of no frequency
  x.normalize();
  for (int step = 0; step < most_zero_steps; ++step) {
    const std::array both = {shares_at(tau), shares_of_slope(tau)};
    sum(both, search.form_and_slope);
    load(form, size_, elimination, 1);
    for (int i = 0; i < size_; ++i) elimination.coupled_row(i)[0] = x[i];
    const bool trusted = elimination.eliminate();
    if (!elimination.completed()) return step > 0 ? std::optional(tau) : std::nullopt;
    if (trusted) (elimination.inertia().negative > low.negative ? high : low).tau = tau;
    elimination.substitute();
    for (int i = 0; i < size_; ++i) z[i] = elimination.coupled_row(i)[0];
    if (!z.allFinite()) return std::nullopt;
    const double along = z.dot(x), length = z.norm();
    double next = tau - along / quadratic_form(slope, z);
    if (!(next >= low.tau && next <= high.tau)) next = (low.tau + high.tau) / 2;
    if ((next - tau) * (next - tau) <= enough && std::abs(along) > least_along * length) return next;
    x = z / length;
    tau = next;
  }
  return std::nullopt;
}

bool FallingForm::find(Place low, Place high, Search& search) const {
  const int count = high.negative - low.negative;
  if (count <= 0) return count == 0;
  if (samples() > part_samples && count >= part_zeros)
    if (const std::optional<FallingForm> form = part(low, high)) return form->find(low, high, search);
  const double middle = (low.tau + high.tau) / 2;
  if (high.tau - low.tau <= zero_resolution * to_) {
    search.found.insert(search.found.end(), count, middle);
    return true;
  }
  if (count == 1)
    if (const std::optional<double> zero = single(low, high, search)) {
      search.found.push_back(*zero);
      return true;
    }
  const std::optional<int> negative = negative_at(middle, search);
  if (!negative || *negative < low.negative || *negative > high.negative) return false;
  if (!find(low, {middle, *negative}, search)) return false;
  return (search.first_only && !search.found.empty()) || find({middle, *negative}, high, search);
}

std::optional<std::vector<double>> FallingForm::zeros(int count, bool first_only) const {
  Search search;
  search.first_only = first_only;
  if (!find({from_, before_}, {to_, before_ + count}, search)) return std::nullopt;
  if (first_only && !search.found.empty()) search.found = {search.found.front()};
  std::sort(search.found.begin(), search.found.end());
  return std::move(search.found);
}

}  // namespace extremal
