#include "solve/external/inequality_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#ifdef EXTREMAL_IPOPT

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>

namespace extremal {

namespace {

class MinimumForIpopt final : public Ipopt::TNLP {
 public:
  using Index = Ipopt::Index;
  using Number = Ipopt::Number;

  MinimumForIpopt(const InequalityMinimum& problem, std::vector<double>& z, const Deadline& deadline,
                  MinimumReport& report)
      : problem_(problem), z_(z), deadline_(deadline), report_(report) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = problem_.variables;
    m = problem_.inequalities + problem_.equations;
    jacobian = static_cast<Index>(problem_.slopes.size());
    hessian = static_cast<Index>(problem_.curvature.size());
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index n, Number* lower, Number* upper, Index m, Number* least, Number* most) override {
    std::fill_n(lower, n, -unbounded);
    std::fill_n(upper, n, unbounded);
    const auto scaled = [&](double x) { return x / problem_.unit; };
    std::ranges::transform(problem_.lower, lower, scaled);
    std::ranges::transform(problem_.upper, upper, scaled);
    std::fill_n(least, m, 0.0);
    std::fill_n(most, m, 0.0);
    std::fill_n(most, problem_.inequalities, unbounded);
    return true;
  }
  bool get_starting_point(Index n, bool, Number* z, bool, Number*, Number*, Index, bool, Number*) override {
    for (Index i = 0; i < n; ++i) z[i] = z_[i] / problem_.unit;
    return true;
  }
  bool eval_f(Index n, const Number* z, bool, Number& value) override {
    if (!problem_.value(point(n, z), value)) return false;
    value /= problem_.value_unit;
    return true;
  }
  bool eval_grad_f(Index n, const Number* z, bool, Number* gradient) override {
    if (!problem_.gradient(point(n, z), {gradient, static_cast<std::size_t>(n)})) return false;
    for (Index i = 0; i < n; ++i) gradient[i] *= problem_.unit / problem_.value_unit;
    return true;
  }
  bool eval_g(Index n, const Number* z, bool, Index m, Number* values) override {
    if (!problem_.constraints(point(n, z), {values, static_cast<std::size_t>(m)})) return false;
    for (Index i = 0; i < m; ++i) values[i] /= constraint_unit(i);
    return true;
  }
  bool eval_jac_g(Index n, const Number* z, bool, Index, Index entries, Index* rows, Index* columns,
                  Number* values) override {
    if (!values) return put_places(problem_.slopes, rows, columns);
    if (!problem_.constraint_slopes(point(n, z), {values, static_cast<std::size_t>(entries)})) return false;
    for (Index i = 0; i < entries; ++i) values[i] *= problem_.unit / constraint_unit(problem_.slopes[i].row);
    return true;
  }
  bool eval_h(Index n, const Number* z, bool, Number factor, Index m, const Number* multipliers, bool,
              Index entries, Index* rows, Index* columns, Number* values) override {
    if (!values) return put_places(problem_.curvature, rows, columns);
    scaled_.resize(m);
    for (Index i = 0; i < m; ++i) scaled_[i] = multipliers[i] / constraint_unit(i);
    if (!problem_.hessian(point(n, z), factor / problem_.value_unit, scaled_,
                          {values, static_cast<std::size_t>(entries)}))
      return false;
    for (Index i = 0; i < entries; ++i) values[i] *= problem_.unit * problem_.unit;
    return true;
  }
  bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number value, Number, Number, Number,
                             Number, Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    if (iteration == 0) first_value_ = std::abs(value);
    fell_ = fell_ || value < -deepest * (1 + first_value_);
    return !fell_ && !deadline_.passed() && (!problem_.count || problem_.count());
  }
  void finalize_solution(Ipopt::SolverReturn status, Index n, const Number* z, const Number*, const Number*,
                         Index, const Number*, const Number* multipliers, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    for (Index i = 0; i < n; ++i) z_[i] = z[i] * problem_.unit;
    report_.converged = status == Ipopt::SUCCESS || status == Ipopt::STOP_AT_ACCEPTABLE_POINT;
    report_.unbounded = fell_ || status == Ipopt::DIVERGING_ITERATES;
    report_.multipliers.resize(problem_.inequalities);
    for (int i = 0; i < problem_.inequalities; ++i)
      report_.multipliers[i] = std::max(0.0, -multipliers[i]) * problem_.value_unit / constraint_unit(i);
    report_.of_equations.clear();
    for (int i = problem_.inequalities; i < problem_.inequalities + problem_.equations; ++i)
      report_.of_equations.push_back(multipliers[i] * problem_.value_unit / constraint_unit(i));
  }

 private:
  static constexpr double unbounded = 2e19;  // beyond Ipopt's infinity
  /// A value that falls below so many times its unit and its first one has no lower bound.
  static constexpr double deepest = 1e6;
  std::span<const double> point(Index n, const Number* z) {
    point_.resize(n);
    for (Index i = 0; i < n; ++i) point_[i] = z[i] * problem_.unit;
    return point_;
  }
  double constraint_unit(Index i) const {
    return problem_.constraint_units.empty() ? 1 : problem_.constraint_units[i];
  }
  static bool put_places(const std::vector<SparseEntry>& entries, Index* rows, Index* columns) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      rows[i] = entries[i].row;
      columns[i] = entries[i].column;
    }
    return true;
  }

  const InequalityMinimum& problem_;
  std::vector<double>& z_;
  const Deadline& deadline_;
  MinimumReport& report_;
  std::vector<double> point_, scaled_;
  double first_value_ = 0;
  bool fell_ = false;
};

}  // namespace

MinimumReport minimise(const InequalityMinimum& problem, std::vector<double>& z, const Deadline& deadline) {
  constexpr int most_iterations = 500;
  MinimumReport report;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication(false);
  ipopt->Options()->SetIntegerValue("print_level", 0);
  ipopt->Options()->SetStringValue("sb", "yes");
  ipopt->Options()->SetIntegerValue("max_iter", most_iterations);
  // Ipopt has its own largest value, and looks at the time more often than it calls back.
  ipopt->Options()->SetNumericValue("max_cpu_time", std::clamp(deadline.seconds_left(), 1e-3, 1e6));
  if (ipopt->Initialize("") != Ipopt::Solve_Succeeded) return report;
  ipopt->OptimizeTNLP(new MinimumForIpopt(problem, z, deadline, report));
  return report;
}

}  // namespace extremal

#else

namespace extremal {

MinimumReport minimise(const InequalityMinimum&, std::vector<double>&, const Deadline&) {
  throw std::invalid_argument("inequalities along the path need Ipopt, which is not part of this build");
}

}  // namespace extremal

#endif
