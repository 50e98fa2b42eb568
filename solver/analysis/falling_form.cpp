#include "analysis/falling_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/limits.hpp"
#include "linear/dense.hpp"

namespace extremal {

using namespace limits::falling_form;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int nodes = form_samples + 1;

/// The points, zeros of Chebyshev's polynomial, and 1 after them; their barycentric weights, and those of the
/// points without 1.
struct Chebyshev {
  std::array<double, nodes> points;
  std::array<double, nodes> weights, weights_inside;
  Chebyshev() {
    static_assert(form_samples % 2 == 0);
    for (int j = 0; j < form_samples; ++j) {
      const double angle = (j + 0.5) * std::numbers::pi / form_samples;
      points[j] = (1 - std::cos(angle)) / 2;
      weights_inside[j] = (j % 2 == 0 ? 1 : -1) * std::sin(angle);
      weights[j] = weights_inside[j] / (2 * form_samples * (1 - points[j]));
    }
    points[form_samples] = weights[form_samples] = 1;
    weights_inside[form_samples] = 0;
  }
};

const Chebyshev& chebyshev() {
  static const Chebyshev points;
  return points;
}

using Shares = std::array<double, nodes>;

/// Shares of the nodes in the value at `at` in (0, 1].
Shares shares(double at, const Shares& weights) {
  const Chebyshev& c = chebyshev();
  Shares result{};
  double sum = 0;
  for (int j = 0; j < nodes; ++j) {
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

void load(const MatrixXd& m, SymmetricElimination& to, int rest) {
  const int n = static_cast<int>(m.rows());
  to.resize(n, rest);
  for (int i = 0; i < n; ++i) std::copy_n(m.col(i).data() + i, n - i, to.pivot_row(i) + i);
}

void load_coupled(const MatrixXd& columns, SymmetricElimination& to) {
  for (int i = 0; i < columns.rows(); ++i)
    for (int j = 0; j < columns.cols(); ++j) to.coupled_row(i)[j] = columns(i, j);
}

MatrixXd coupled(SymmetricElimination& from, int rows, int columns) {
  MatrixXd m(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) m(i, j) = from.coupled_row(i)[j];
  return m;
}

/// Columns that favour no direction.
MatrixXd spread(int rows, int columns) {
  MatrixXd m(rows, columns);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i) m(i, j) = std::cos(1 + 2.4 * i + 0.7 * j + 1.3 * i * j);
  return m;
}

}  // namespace

struct FallingForm::Search {
  SymmetricElimination elimination;
  std::vector<double> found;
  bool first_only = false;
};

std::span<const double> FallingForm::points() { return chebyshev().points; }

std::optional<FallingForm> FallingForm::of(double from, double to, int before, std::vector<MatrixXd> samples,
                                           const MatrixXd& last) {
  FallingForm form;
  form.from_ = from;
  form.to_ = to;
  form.before_ = before;
  form.values_ = std::move(samples);
  form.last_ = last;
  for (int j = 0; j < form_samples; ++j) form.values_[j] *= form.time(j);
  form.values_.push_back(to * last);
  const Shares inside = shares(1, chebyshev().weights_inside);
  const double error = (form.sum(inside) / to - last).cwiseAbs().maxCoeff();
  if (!(error * to <= most_form_error)) return std::nullopt;
  return form;
}

MatrixXd FallingForm::sum(std::span<const double> share) const {
  static_assert(nodes % 4 == 1);
  MatrixXd sum = share[form_samples] * values_[form_samples];
  for (int j = 0; j < form_samples; j += 4)
    sum += share[j] * values_[j] + share[j + 1] * values_[j + 1] + share[j + 2] * values_[j + 2] +
           share[j + 3] * values_[j + 3];
  return sum;
}

MatrixXd FallingForm::at(double tau) const {
  return sum(shares((tau - from_) / (to_ - from_), chebyshev().weights)) / tau;
}

std::optional<int> FallingForm::negative_at(double tau, Search& search) const {
  const MatrixXd form = at(tau);
  load(form, search.elimination, 0);
  if (search.elimination.eliminate()) return search.elimination.inertia().negative;
  if (!form.allFinite()) return std::nullopt;
  return static_cast<int>((symmetric_eigenvalues(form).array() < 0).count());
}

/// One zero between two times: the time at which the form of an approximate null vector vanishes is off by
/// the square of the vector's error (Voss, BIT Numer. Math. 44 (2004) 387, on safeguarded iteration).
std::optional<double> FallingForm::single(Place low, Place high, Search& search) const {
  double tau = (low.tau + high.tau) / 2;
  MatrixXd x = spread(size(), 1);
  for (int step = 0; step < most_zero_steps; ++step) {
    load(at(tau), search.elimination, 1);
    load_coupled(x, search.elimination);
    const bool trusted = search.elimination.eliminate();
    if (!search.elimination.completed()) return step > 0 ? std::optional(tau) : std::nullopt;
    if (trusted) (search.elimination.inertia().negative > low.negative ? high : low).tau = tau;
    search.elimination.substitute();
    x = coupled(search.elimination, size(), 1).normalized();
    if (!x.allFinite()) return std::nullopt;
    Shares along;
    for (int j = 0; j < nodes; ++j) along[j] = x.col(0).dot(values_[j] * x.col(0));
    const auto value = [&](double t) {
      const Shares share = shares((t - from_) / (to_ - from_), chebyshev().weights);
      double sum = 0;
      for (int j = 0; j < nodes; ++j) sum += share[j] * along[j];
      return sum;
    };
    double a = low.tau, b = high.tau;
    if (!(value(b) < 0) || (a > from_ && !(value(a) > 0))) {
      tau = (a + b) / 2;
      continue;
    }
    while (b - a > zero_resolution * to_ / 4) {
      const double middle = (a + b) / 2;
      if (middle <= a || middle >= b) break;
      (value(middle) > 0 ? a : b) = middle;
    }
    const double next = (a + b) / 2;
    if (std::abs(next - tau) <= small_zero_step * to_) return next;
    tau = next;
  }
  return std::nullopt;
}

bool FallingForm::find(Place low, Place high, Search& search) const {
  const int count = high.negative - low.negative;
  if (count <= 0) return count == 0;
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
