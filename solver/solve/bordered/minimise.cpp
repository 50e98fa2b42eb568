#include "solve/bordered/minimise.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "solve/bordered/limits.hpp"
#include "solve/bordered/null_directions.hpp"

namespace extremal {

using namespace limits::bordered;

bool may_be_minimised(const Problem& problem) {
  const Extension& extension = *problem.extension;
  return extension.constants() == 0 && extension.conditions.empty() && extension.where.empty() &&
         !problem.duration.free && !problem.periodic && !problem.paired;
}

namespace {

using Matrix = BorderedEquations::Matrix;

class Minimisation {
 public:
  Minimisation(BorderedEquations& equations, BorderedState& state)
      : equations_(equations), state_(state), times_(equations.node_times(state)) {}

  enum class Result { minimal, moved, failed };

  /// The second variation and the gradient at the state. False where they are not finite.
  bool evaluate() {
    if (!equations_.evaluate(state_, true)) return false;
    value_ = equations_.minimised(state_);
    gradient_ = equations_.values().head(equations_.of_path());
    matrix_ = equations_.matrix().topLeftCorner(equations_.of_path(), equations_.of_path());
    if (stiffest_ == 0) stiffest_ = matrix_.diagonal().cwiseQuotient(times_).maxCoeff();
    cholesky_.analyzePattern(matrix_);
    return true;
  }

  /// One step from the state that was evaluated; after one that moved it is to be evaluated again.
  Result step() {
    if (!factor()) return Result::failed;
    Eigen::VectorXd step = cholesky_.solve(-gradient_);
    const double path = path_size(state_, equations_.coordinates()).value;
    size_ = step.lpNorm<Eigen::Infinity>() / path;
    if (!std::isfinite(size_)) return Result::failed;
    damping_ = std::min(1.0, longest_descent / size_);
    step *= damping_;
    const double predicted = -gradient_.dot(step) - 0.5 * step.dot(matrix_ * step);
    if (size_ <= minimal || predicted <= roundoff_of_action * std::abs(value_)) {
      if (shift_ == 0 || !leave_saddle(path)) return Result::minimal;
      return Result::moved;
    }
    const double fall = fall_along(step);
    if (!(fall > 0.25 * predicted)) raise_shift();
    if (fall > 0.75 * predicted) shift_ /= growth;
    if (!(fall >= sufficient * predicted)) state_ = saved_;
    return Result::moved;
  }

  double size() const { return size_; }
  double damping() const { return damping_; }

 private:
  void raise_shift() { shift_ = std::max(growth * shift_, least_shift * stiffest_); }

  /// With the least 1/τ, from that of the step before on, that makes it positive definite.
  bool factor() {
    if (shift_ < least_shift * stiffest_) shift_ = 0;
    for (; shift_ <= stiffest_; raise_shift()) {
      Matrix shifted = matrix_;
      shifted.diagonal() += shift_ * times_;
      cholesky_.factorize(shifted);
      if (cholesky_.info() == Eigen::Success) return true;
    }
    return false;
  }

  /// Takes a step; by how much the action falls.
  double fall_along(const Eigen::VectorXd& of_path) {
    saved_ = state_;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(equations_.unknowns());
    step.head(of_path.size()) = of_path;
    const bool finite = equations_.apply(state_, step, 1) && equations_.evaluate(state_, false);
    return finite ? value_ - equations_.minimised(state_) : -INFINITY;
  }

  /// From a stationary path along the direction of the least eigenvalue, by inverse iteration. False if it is
  /// none of descent: then the path is a minimiser to roundoff.
  bool leave_saddle(double path) {
    Eigen::VectorXd direction = NullDirections::probe(times_.size(), 0);
    for (int k = 0; k < inverse_iterations; ++k) {
      direction = cholesky_.solve(times_.cwiseProduct(direction));
      direction /= direction.lpNorm<Eigen::Infinity>();
    }
    for (double part = kick * path; part > least_kick * path; part /= 2)
      for (const double side : {1, -1}) {
        if (fall_along(side * part * direction) > 0) return true;
        state_ = saved_;
      }
    return false;
  }

  BorderedEquations& equations_;
  BorderedState& state_;
  BorderedState saved_;
  const Eigen::VectorXd times_;
  Eigen::VectorXd gradient_;
  Matrix matrix_;
  Eigen::SimplicialLLT<Matrix> cholesky_;
  double value_ = 0, size_ = 0, damping_ = 1;
  double shift_ = 0;     ///< 1/τ
  double stiffest_ = 0;  ///< of the second variation by the time of a node, of the first state
};

}  // namespace

bool minimise(BorderedEquations& equations, BorderedState& state, const Spent& spent,
              const std::function<void(double, double)>& on_step) {
  equations.hold_times(true);
  Minimisation minimisation(equations, state);
  using Result = Minimisation::Result;
  const double first = path_size(state, equations.coordinates()).value;
  Result result = Result::moved;
  for (int steps = 0; result == Result::moved && steps < most_descents && !spent(); ++steps) {
    result = minimisation.evaluate() ? minimisation.step() : Result::failed;
    on_step(minimisation.size(), minimisation.damping());
    if (!(path_size(state, equations.coordinates()).value < most_growth * first)) result = Result::failed;
  }
  equations.hold_times(false);
  return result == Result::minimal;
}

}  // namespace extremal
