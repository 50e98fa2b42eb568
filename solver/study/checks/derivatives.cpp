#include "study/checks/derivatives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "machine/roundoff.hpp"
#include "machine/simd.hpp"
#include "problem/nearby.hpp"

namespace extremal {
namespace {

constexpr int points_wanted = 5, points_tried = 40, most_columns = 256;
constexpr int most_work = 1 << 22;  // columns times variables
/// Steps by the size of a variable, of which the best counts: so many at least, and shorter ones while
/// derivatives differ, down to where roundoff of the differences hides more than the last number, relative.
constexpr double first_step = 8e-3, shortening = 1.0 / 8;
constexpr int least_steps = 3;
constexpr double agreement = 1e-6, most_hidden = 0.1 * agreement;
/// Of L and its gradient, in roundings of themselves and of the variables.
constexpr double roundings = 16;
/// f'(x) = Σ c_i f(x + i h)/h to sixth order, i = −3 … 3; the eighth point repeats the middle.
constexpr int lanes = 8;  // of a batch of any level
static_assert(lanes % most_lanes == 0);
constexpr std::array<double, lanes> weights = {-1. / 60, 9. / 60,  -45. / 60, 0,
                                               45. / 60, -9. / 60, 1. / 60,   0};

/// One batch of points of z = (q, q') and t, and the rows of L's remainder there.
class Batch {
 public:
  explicit Batch(const Lagrangian& lagrangian)
      : lagrangian_(lagrangian), n_(lagrangian.structure().coordinates) {
    inputs_ = input_memory_.reserve(std::size_t(2 * n_ + 1) * lanes);
    rows_ = row_memory_.reserve(std::size_t(lagrangian.rows(Order::hessian)) * lanes);
  }

  void fill(const std::vector<double>& z, double t) {
    for (int k = 0; k < 2 * n_; ++k) std::fill_n(inputs_ + k * lanes, lanes, z[k]);
    std::fill_n(inputs_ + 2 * n_ * lanes, lanes, t);
  }
  double& z(int k, int lane) { return inputs_[k * lanes + lane]; }
  double row(int k, int lane) const { return rows_[k * lanes + lane]; }
  void evaluate(Order order) {
    const Points points{lanes, lanes, inputs_, inputs_ + n_ * lanes, inputs_ + 2 * n_ * lanes};
    lagrangian_.evaluate(points, order, rows_, scratch_);
  }
  /// The derivative of row k by the variable that was spread over the lanes with step h.
  double difference(int k, double h) const {
    double sum = 0;
    for (int lane = 0; lane < lanes; ++lane) sum += weights[lane] * row(k, lane);
    return sum / h;
  }

 private:
  const Lagrangian& lagrangian_;
  int n_;
  Scratch input_memory_, row_memory_, scratch_;
  double *inputs_, *rows_;
};

/// The derivatives at one point, and their comparison with differences there.
class PointCheck {
 public:
  PointCheck(const Problem& problem, Batch& batch)
      : problem_(problem), structure_(problem.lagrangian->structure()), batch_(batch) {}

  /// False where the derivatives are not finite.
  bool load(const std::vector<double>& q, const std::vector<double>& v, double t) {
    z_ = q;
    z_.insert(z_.end(), v.begin(), v.end());
    t_ = t;
    batch_.fill(z_, t);
    batch_.evaluate(Order::hessian);
    const std::size_t g = structure_.gradient.size(), h = structure_.hessian.size();
    gradient_.assign(z_.size(), 0);
    hessian_.resize(h);
    for (std::size_t k = 0; k < g; ++k)
      gradient_[structure_.gradient[k]] = batch_.row(static_cast<int>(1 + k), 0);
    for (std::size_t k = 0; k < h; ++k) hessian_[k] = batch_.row(static_cast<int>(1 + g + k), 0);
    measure();
    return std::isfinite(hessian_size_);
  }

  /// Differences by z_k against the gradient and column k of the Hessian.
  void compare(int k, DerivativeCheck& check) {
    const std::size_t g = structure_.gradient.size();
    const std::vector<double> column = hessian_column(k);
    std::vector<double> best(g + 1), error(g + 1, INFINITY);
    const double unit = std::max(std::abs(z_[k]), 0.1), rounding = roundings * machine_epsilon / unit;
    double relative = first_step;
    for (int taken = 0; taken < least_steps || *std::ranges::max_element(error) > most_hidden; ++taken) {
      const double value_roundoff = rounding * value_rounded_ / relative,
                   gradient_roundoff = rounding * gradient_rounded_ / relative;
      const double hidden = std::max(value_roundoff / gradient_size_, gradient_roundoff / hessian_size_);
      if (taken > 0 && hidden > most_hidden) break;
      spread(k, relative * unit);
      for (std::size_t row = 0; row <= g; ++row) {
        const double difference = batch_.difference(static_cast<int>(row), relative * unit);
        const double expected = row == 0 ? gradient_[k] : column[row - 1];
        const double roundoff = row == 0 ? value_roundoff : gradient_roundoff;
        const double size = std::max(row == 0 ? gradient_size_ : hessian_size_, std::abs(difference));
        const double off = std::max(std::abs(difference - expected) - roundoff, 0.0) / size;
        if (off < error[row]) error[row] = off, best[row] = difference;
      }
      relative *= shortening;
    }
    note(check.gradient, error[0], gradient_[k], best[0], [&] { return fmt::format("∂L/∂{}", name(k)); });
    for (std::size_t row = 0; row < g; ++row)
      note(check.hessian, error[row + 1], column[row], best[row + 1],
           [&] { return fmt::format("∂²L/∂{}∂{}", name(structure_.gradient[row]), name(k)); });
  }

 private:
  /// The largest of each order, lower ones included, and what is rounded in L and in its gradient:
  /// themselves, and what they change by where a variable changes by its own size.
  void measure() {
    const double value = std::abs(batch_.row(0, 0));
    const auto larger = [](double m, double x) {
      return std::max(m, std::isfinite(x) ? std::abs(x) : INFINITY);
    };
    gradient_size_ = std::accumulate(gradient_.begin(), gradient_.end(), larger(DBL_MIN, value), larger);
    hessian_size_ = std::accumulate(hessian_.begin(), hessian_.end(), gradient_size_, larger);
    value_rounded_ = value;
    for (std::size_t k = 0; k < z_.size(); ++k)
      value_rounded_ = std::max(value_rounded_, std::abs(z_[k] * gradient_[k]));
    gradient_rounded_ = gradient_size_;
    for (std::size_t e = 0; e < hessian_.size(); ++e) {
      const double z =
          std::max(std::abs(z_[structure_.hessian[e].row]), std::abs(z_[structure_.hessian[e].column]));
      gradient_rounded_ = std::max(gradient_rounded_, z * std::abs(hessian_[e]));
    }
  }

  /// The gradient at points about this one, spread over the lanes in z_k with step h.
  void spread(int k, double h) {
    batch_.fill(z_, t_);
    for (int lane = 0; lane < lanes - 1; ++lane) batch_.z(k, lane) = z_[k] + (lane - 3) * h;
    batch_.evaluate(Order::gradient);
  }

  /// ∂²R/∂z_k∂z of each gradient row.
  std::vector<double> hessian_column(int k) const {
    std::vector<double> dense(z_.size(), 0);
    for (std::size_t e = 0; e < hessian_.size(); ++e) {
      if (structure_.hessian[e].column == k) dense[structure_.hessian[e].row] = hessian_[e];
      if (structure_.hessian[e].row == k) dense[structure_.hessian[e].column] = hessian_[e];
    }
    std::vector<double> column;
    for (const int row : structure_.gradient) column.push_back(dense[row]);
    return column;
  }

  std::string name(int z) const {
    const int n = problem_.coordinates();
    return z < n ? problem_.names[z] : problem_.names[z - n] + "'";
  }

  template <class Name>
  void note(WorstDerivative& worst, double error, double derivative, double difference, Name&& name) const {
    if (!worst.name.empty() && error <= worst.error) return;
    const auto middle = z_.begin() + problem_.coordinates();
    worst = {name(), derivative, difference, error, t_, {z_.begin(), middle}, {middle, z_.end()}};
  }

  const Problem& problem_;
  const Structure& structure_;
  Batch& batch_;
  std::vector<double> z_, gradient_, hessian_;
  double t_ = 0, gradient_size_ = 0, hessian_size_ = 0, value_rounded_ = 0, gradient_rounded_ = 0;
};

}  // namespace

DerivativeCheck check_derivatives(const Problem& problem, const Deadline& deadline) {
  const int variables = 2 * problem.coordinates();
  DerivativeCheck check;
  check.columns = std::min(variables, std::clamp(most_work / variables, 4, most_columns));
  Batch batch(*problem.lagrangian);
  PointCheck point(problem, batch);
  NearbyPoints nearby(problem);
  std::vector<double> q, v;
  for (int k = 0; k < points_tried && check.points < points_wanted; ++k) {
    const double t = nearby.next(q, v);
    if (!point.load(q, v, t)) continue;
    if (check.points > 0 && deadline.passed()) break;
    ++check.points;
    const int columns = check.columns;
    for (int c = 0; c < columns; ++c) {
      if (c > 0 && deadline.passed()) {
        if (check.points == 1) check.columns = c;
        break;
      }
      point.compare(static_cast<int>(std::int64_t(c) * variables / columns), check);
    }
  }
  return check;
}

}  // namespace extremal
