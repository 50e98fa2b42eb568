#include <ceres/ceres.h>

#include <algorithm>
#include <memory>

#include "solve/external/external_solver.hpp"
#include "solve/external/silence.hpp"

namespace extremal {

namespace {

using Row = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;

/// Evaluates all equations at once where Ceres asks for each by itself.
class Evaluation final : public ceres::EvaluationCallback {
 public:
  Evaluation(Displacement& equations, const std::vector<double>& z) : equations_(equations), z_(z) {}

  void PrepareForEvaluation(bool jacobians, bool) override { finite_ = equations_.evaluate(z_, jacobians); }
  bool finite() const { return finite_; }
  const Displacement& equations() const { return equations_; }

 private:
  Displacement& equations_;
  const std::vector<double>& z_;
  bool finite_ = false;
};

/// One of them, in the unknowns that it depends on.
class Component final : public ceres::CostFunction {
 public:
  Component(const Evaluation& evaluation, int row) : evaluation_(evaluation), row_(row) {
    set_num_residuals(1);
    for (Row entry(evaluation.equations().derivatives(), row); entry; ++entry)
      mutable_parameter_block_sizes()->push_back(1);
  }

  bool Evaluate(const double* const*, double* residual, double** jacobians) const override {
    *residual = evaluation_.equations().values()[row_];
    if (!evaluation_.finite()) return false;
    if (!jacobians) return true;
    for (Row entry(evaluation_.equations().derivatives(), row_); entry; ++entry, ++jacobians)
      if (*jacobians) **jacobians = entry.value();
    return true;
  }

 private:
  const Evaluation& evaluation_;
  int row_;
};

class Counter final : public ceres::IterationCallback {
 public:
  explicit Counter(const std::function<bool()>& count) : count_(count) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return count_() ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const std::function<bool()>& count_;
};

}  // namespace

void solve_least_squares(Displacement& equations, std::vector<double>& z, const Deadline& deadline,
                         const std::function<bool()>& count) {
  const Silence silence;
  if (!equations.evaluate(z, true)) return;
  Evaluation evaluation(equations, z);
  Counter counter(count);
  ceres::Problem::Options ownership;
  ownership.evaluation_callback = &evaluation;
  ceres::Problem problem(ownership);
  for (double& unknown : z) problem.AddParameterBlock(&unknown, 1);
  for (int row = 0; row < equations.size(); ++row) {
    std::vector<double*> unknowns;
    for (Row entry(equations.derivatives(), row); entry; ++entry) unknowns.push_back(&z[entry.col()]);
    problem.AddResidualBlock(new Component(evaluation, row), nullptr, unknowns);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 1000;  // `count` bounds the effort
  options.max_solver_time_in_seconds = std::min(deadline.seconds_left(), options.max_solver_time_in_seconds);
  options.callbacks.push_back(&counter);
  options.update_state_every_iteration = false;
  ceres::Solver::Summary summary;
  const std::vector<double> start = z;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) z = start;
}

}  // namespace extremal
