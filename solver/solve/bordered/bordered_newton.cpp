#include "solve/bordered/bordered_newton.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "linear/dense.hpp"
#include "linear/sparse_lu.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/bordered/null_directions.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

class BorderedNewton {
 public:
  BorderedNewton(BorderedEquations& equations, BorderedState& state) : equations_(equations), state_(state) {}

  /// Derivatives at the state, factored.
  bool factor() {
    if (!equations_.evaluate(state_, true)) {
      failure_ = "the action is not finite along the path";
      return false;
    }
    const BorderedEquations::Matrix matrix = equations_.matrix();
    // Zeros are kept as entries, but for those of conditions, of which the gradient may vanish by chance.
    lu_.setPivotThreshold(least_pivot);
    if (matrix.nonZeros() != analysed_) lu_.analyzePattern(matrix);
    analysed_ = matrix.nonZeros();
    lu_.factorize(matrix);
    set_units(matrix);
    find_null_directions(matrix);
    if (lu_.info() == Eigen::Success || least_norm_ || across_) return true;
    failure_ = "the second variation with the conditions is singular";
    return false;
  }

  /// The correction from the values evaluated last.
  Eigen::VectorXd correction() const {
    Eigen::VectorXd right = -equations_.values();
    for (Eigen::Index j = equations_.first_held(); j < right.size(); ++j) right[j] = 0;
    if (across_) return units_.cwiseProduct(across_->solve(right.cwiseProduct(row_units_)));
    if (!least_norm_) return lu_.solve(right);
    return units_.cwiseProduct(least_norm_->solve(right.cwiseProduct(row_units_)));
  }

  double length(const Eigen::VectorXd& step) const {
    if (!step.allFinite()) return INFINITY;
    const Eigen::Index held = equations_.first_held();
    return step.head(held).cwiseQuotient(units_.head(held)).lpNorm<Eigen::Infinity>();
  }

  const std::string& failure() const { return failure_; }

  /// At the state, unless derivatives are not finite there.
  Freedom freedom() {
    if (!equations_.evaluate(state_, true)) return {};
    const BorderedEquations::Matrix matrix = equations_.matrix();
    lu_.compute(matrix);
    set_units(matrix);
    const BorderedEquations::Matrix in_units = scaled(matrix);
    NullDirections found;
    if (is_regular() || !found.find(in_units, null_direction)) return {};
    Freedom freedom{units_.asDiagonal() * found.directions(), {}};
    for (Eigen::Index j = 0; j < freedom.directions.cols(); ++j)
      freedom.directions.col(j) /= found.directions().col(j).lpNorm<Eigen::Infinity>();
    const double largest = found.directions().cwiseAbs().maxCoeff();
    for (int k = 0; k < equations_.extension().unknowns(); ++k)
      freedom.moves.push_back(found.directions().row(equations_.first_constant() + k).norm() >
                              takes_part * largest);
    return freedom;
  }

  /// Beside a family the second variation is not singular, but steps along the family may be far too long.
  /// Its softest directions are then left out, until the path is near. False if they are left out already.
  bool leave_soft_directions_out() {
    if (null_below_ >= soft_direction) return false;
    null_below_ = soft_direction;
    return true;
  }
  void take_all_directions() { null_below_ = null_direction; }

 private:
  /// What each unknown is compared with. A multiplier counts by the momentum that it makes.
  void set_units(const BorderedEquations::Matrix& matrix) {
    units_.setConstant(equations_.unknowns(), path_size(state_, coordinates()).value);
    const double momentum = std::max(equations_.momentum(), 1e-300);
    const auto column = [&](int c) {
      double largest = 0;
      for (BorderedEquations::Matrix::InnerIterator it(matrix, c); it; ++it)
        if (it.row() < equations_.of_path()) largest = std::max(largest, std::abs(it.value()));
      return largest;
    };
    const std::vector<double> constants = state_.constants(coordinates());
    for (int c = equations_.first_constant(); c < equations_.first_time(); ++c) {
      const std::size_t i = c - equations_.first_constant();
      const double value =
          std::abs(i < constants.size() ? constants[i] : state_.multipliers[i - constants.size()]);
      const double force = column(c);
      const double unit = force > 0 ? momentum / force : 1;
      units_[c] = std::max(value, std::min(unit, 1 / least_constant));
    }
    for (int c = equations_.first_time(); c < equations_.first_held(); ++c) units_[c] = state_.times.back();
  }
  /// The matrix by the units of its unknowns, rows of size one.
  BorderedEquations::Matrix scaled(const BorderedEquations::Matrix& matrix) {
    const Eigen::Index size = matrix.rows();
    row_units_.setZero(size);
    for (Eigen::Index c = 0; c < size; ++c)
      for (BorderedEquations::Matrix::InnerIterator it(matrix, c); it; ++it)
        row_units_[it.row()] = std::max(row_units_[it.row()], std::abs(it.value()) * units_[c]);
    for (double& unit : row_units_) unit = unit > 0 ? 1 / unit : 1;
    return row_units_.asDiagonal() * matrix * units_.asDiagonal();
  }
  /// Whether a solution with the factors, in units, is not much larger than its right-hand side: bordered
  /// factors cost far more.
  bool is_regular() const {
    if (lu_.info() != Eigen::Success) return false;
    const Eigen::VectorXd probe = NullDirections::probe(row_units_.size(), 0);
    const Eigen::VectorXd answer = lu_.solve(probe.cwiseQuotient(row_units_)).cwiseQuotient(units_);
    return answer.allFinite() && answer.lpNorm<Eigen::Infinity>() < 1 / null_below_;
  }
  /// A singular matrix belongs to a family of solutions: of all steps the shortest is taken.
  void find_null_directions(const BorderedEquations::Matrix& matrix) {
    least_norm_.reset();
    across_.reset();
    const Eigen::Index size = matrix.rows();
    const bool dense = size <= most_dense;
    if (!dense && null_below_ > null_direction) return;
    const BorderedEquations::Matrix in_units = scaled(matrix);
    if (is_regular()) return;
    if (dense) {
      least_norm_.emplace(size, size);
      least_norm_->setThreshold(null_below_).compute(Eigen::MatrixXd(in_units));
    } else if (NullDirections found; found.find(in_units, null_below_)) {
      across_ = std::move(found);
    }
  }
  int coordinates() const {
    return state_.path.coordinates() - (equations_.first_multiplier() - equations_.first_constant());
  }

  BorderedEquations& equations_;
  BorderedState& state_;
  Eigen::SparseLU<BorderedEquations::Matrix> lu_;
  Eigen::VectorXd units_, row_units_;
  std::optional<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>> least_norm_;  ///< of few unknowns
  std::optional<NullDirections> across_;                                               ///< of many
  Eigen::Index analysed_ = -1;  ///< entries of the pattern
  double null_below_ = null_direction;
  std::string failure_;
};

}  // namespace

BorderedReport converge(BorderedEquations& equations, BorderedState& state, const Spent& spent,
                        const std::function<void(double, double)>& on_step) {
  BorderedReport report;
  BorderedNewton newton(equations, state);
  double predicted = 1, before = INFINITY;
  while (report.steps < most_steps) {
    if (spent()) {
      report.failure = "the limit of work for one solve is reached";
      return report;
    }
    ++report.steps;
    if (!newton.factor()) {
      report.failure = newton.failure();
      return report;
    }
    const Eigen::VectorXd step = newton.correction();
    const double size = newton.length(step);
    if (!std::isfinite(size)) {
      report.failure = "the second variation with the conditions is singular";
      return report;
    }
    const BorderedState saved = state;
    bool too_short = false;
    double damping = size < roundoff_step ? 1 : predicted, simplified = INFINITY;
    Eigen::VectorXd next;
    for (;; damping /= 2) {
      if (damping < least_damping) {
        state = saved;
        too_short = true;
        if (newton.leave_soft_directions_out()) break;
        report.failure = "the steps of Newton's method became too short";
        return report;
      }
      if (equations.apply(state, step, damping) && equations.evaluate(state, false)) {
        next = newton.correction();
        simplified = newton.length(next);
        if (simplified <= (1 - damping / 4) * size || (damping == 1 && size < roundoff_step)) break;
        if (damping == 1 && size < amplified && size > shrinks * before) break;
      }
      state = saved;
    }
    if (too_short) continue;
    if (size < near_family) newton.take_all_directions();
    on_step(size, damping);
    report.correction = simplified;
    const bool full = damping == 1;
    if (full && simplified < shrinks * size && std::isfinite(simplified)) {
      const BorderedState kept = state;
      if (!equations.apply(state, next, 1) || !equations.evaluate(state, false)) state = kept;
    }
    if (full && (simplified <= converged_step || size < roundoff_step ||
                 (size < amplified && simplified > shrinks * size))) {
      report.converged = true;
      return report;
    }
    before = size;
    predicted = std::min(1.0, damping * (simplified < 0.5 * size ? 4 : 2));
  }
  report.failure = fmt::format("{} Newton steps did not converge", report.steps);
  return report;
}

Freedom freedom_of(BorderedEquations& equations, BorderedState& state) {
  return BorderedNewton(equations, state).freedom();
}

void estimate_multipliers(BorderedEquations& equations, BorderedState& state, const Problem& problem) {
  const Extension& extension = *problem.extension;
  const int n = problem.coordinates(), unknowns = extension.unknowns(), m = extension.multipliers(),
            r = equations.conditions();
  if (m + r == 0) return;
  std::vector<double> constants = state.constants(n);
  std::fill(constants.begin() + unknowns, constants.end(), 0.0);
  state.set_constants(n, constants);
  std::ranges::fill(state.multipliers, 0.0);
  if (!equations.evaluate(state, true)) return;
  const int rows = equations.of_path(), first = equations.first_constant() + unknowns;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, m + r);
  for (const auto& e : equations.entries())
    if (e.row() < rows && e.col() >= first && e.col() < first + m + r)
      columns(e.row(), e.col() - first) += e.value();
  const Eigen::VectorXd y = least_norm(columns, -equations.values().head(rows));
  if (!y.allFinite()) return;
  for (int j = 0; j < m; ++j) constants[unknowns + j] = y[j];
  state.set_constants(n, constants);
  for (int i = 0; i < r; ++i) state.multipliers[i] = y[m + i];
}

}  // namespace extremal
