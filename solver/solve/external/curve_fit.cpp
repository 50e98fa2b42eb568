#include "solve/external/curve_fit.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <memory>

#include "solve/external/silence.hpp"

namespace extremal {

namespace {

/// Steps shorter than the first, relative to x, or that change the cost by less than the second, relative,
/// are roundoff of what is fitted.
constexpr double least_step = 1e-12, least_change = 1e-16;
constexpr int most_iterations = 200;
/// Points at which there is nothing to be evaluated, one after another.
constexpr int most_invalid = 20;

/// Evaluates all residuals at once.
class Evaluation final : public ceres::EvaluationCallback {
 public:
  Evaluation(const CurveFit& fit, const std::vector<double>& x)
      : fit_(fit), x_(x), residuals_(fit.residuals), jacobian_(fit.residuals * x.size()) {}

  void PrepareForEvaluation(bool jacobian, bool) override {
    finite_ = fit_.evaluate(x_, residuals_, jacobian ? std::span<double>(jacobian_) : std::span<double>());
  }
  bool finite() const { return finite_; }
  const double* residuals() const { return residuals_.data(); }
  const double* jacobian(int row) const { return jacobian_.data() + row * x_.size(); }

 private:
  const CurveFit& fit_;
  const std::vector<double>& x_;
  std::vector<double> residuals_, jacobian_;
  bool finite_ = false;
};

/// So many of the residuals, from one on.
class Rows final : public ceres::CostFunction {
 public:
  Rows(const Evaluation& evaluation, int unknowns, int first, int count)
      : evaluation_(evaluation), unknowns_(unknowns), first_(first) {
    set_num_residuals(count);
    mutable_parameter_block_sizes()->push_back(unknowns);
  }

  bool Evaluate(const double* const*, double* residuals, double** jacobians) const override {
    if (!evaluation_.finite()) return false;
    std::copy_n(evaluation_.residuals() + first_, num_residuals(), residuals);
    if (jacobians && jacobians[0])
      std::copy_n(evaluation_.jacobian(first_), num_residuals() * unknowns_, jacobians[0]);
    return true;
  }

 private:
  const Evaluation& evaluation_;
  int unknowns_, first_;
};

class Counter final : public ceres::IterationCallback {
 public:
  explicit Counter(const CurveFit& fit) : fit_(fit) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    return !fit_.count || fit_.count(step.iteration, step.cost) ? ceres::SOLVER_CONTINUE
                                                                : ceres::SOLVER_ABORT;
  }

 private:
  const CurveFit& fit_;
};

ceres::LossFunction* loss_function(Loss loss) {
  if (loss == Loss::huber) return new ceres::HuberLoss(1);
  return new ceres::CauchyLoss(1);
}

}  // namespace

CurveFitReport minimise(const CurveFit& fit, std::vector<double>& x, const Deadline& deadline) {
  const Silence silence;
  const int unknowns = static_cast<int>(x.size());
  Evaluation evaluation(fit, x);
  Counter counter(fit);
  ceres::Problem::Options ownership;
  ownership.evaluation_callback = &evaluation;
  ceres::Problem problem(ownership);
  problem.AddParameterBlock(x.data(), unknowns);
  if (fit.loss == Loss::squared)
    problem.AddResidualBlock(new Rows(evaluation, unknowns, 0, fit.residuals), nullptr, x.data());
  else
    for (int row = 0; row < fit.residuals; ++row)
      problem.AddResidualBlock(new Rows(evaluation, unknowns, row, 1), loss_function(fit.loss), x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = most_iterations;
  options.max_num_consecutive_invalid_steps = most_invalid;
  options.initial_trust_region_radius = fit.radius;
  options.function_tolerance = least_change;
  options.gradient_tolerance = 0;
  options.parameter_tolerance = least_step;
  options.max_solver_time_in_seconds = std::min(deadline.seconds_left(), options.max_solver_time_in_seconds);
  options.callbacks.push_back(&counter);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  CurveFitReport report;
  report.iterations = static_cast<int>(summary.iterations.size());
  report.converged = summary.termination_type == ceres::CONVERGENCE;
  if (report.converged) return report;
  if (deadline.passed() || summary.termination_type == ceres::USER_FAILURE)
    report.failure = "the time for one solve is spent";
  else if (summary.termination_type == ceres::NO_CONVERGENCE)
    report.failure = "it did not converge in " + std::to_string(report.iterations) + " iterations";
  else
    report.failure = "there are no extremals for the values that its steps lead to";
  return report;
}

}  // namespace extremal
