#include "solve/external/inequality_minimum.hpp"

#include <algorithm>
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

  MinimumForIpopt(const InequalityMinimum& problem, std::vector<double>& z, MinimumReport& report)
      : problem_(problem), z_(z), report_(report) {}

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
    std::fill_n(least, m, 0.0);
    std::fill_n(most, m, 0.0);
    std::fill_n(most, problem_.inequalities, unbounded);
    return true;
  }
  bool get_starting_point(Index n, bool, Number* z, bool, Number*, Number*, Index, bool, Number*) override {
    std::copy_n(z_.begin(), n, z);
    return true;
  }
  bool eval_f(Index n, const Number* z, bool, Number& value) override {
    return problem_.value(point(n, z), value);
  }
  bool eval_grad_f(Index n, const Number* z, bool, Number* gradient) override {
    return problem_.gradient(point(n, z), {gradient, static_cast<std::size_t>(n)});
  }
  bool eval_g(Index n, const Number* z, bool, Index m, Number* values) override {
    return problem_.constraints(point(n, z), {values, static_cast<std::size_t>(m)});
  }
  bool eval_jac_g(Index n, const Number* z, bool, Index, Index entries, Index* rows, Index* columns,
                  Number* values) override {
    if (values) return problem_.constraint_slopes(point(n, z), {values, static_cast<std::size_t>(entries)});
    put_places(problem_.slopes, rows, columns);
    return true;
  }
  bool eval_h(Index n, const Number* z, bool, Number factor, Index m, const Number* multipliers, bool,
              Index entries, Index* rows, Index* columns, Number* values) override {
    if (values)
      return problem_.hessian(point(n, z), factor, {multipliers, static_cast<std::size_t>(m)},
                              {values, static_cast<std::size_t>(entries)});
    put_places(problem_.curvature, rows, columns);
    return true;
  }
  bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number, Number,
                             Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    return !problem_.count || problem_.count();
  }
  void finalize_solution(Ipopt::SolverReturn status, Index n, const Number* z, const Number*, const Number*,
                         Index, const Number*, const Number* multipliers, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    std::copy_n(z, n, z_.begin());
    report_.converged = status == Ipopt::SUCCESS || status == Ipopt::STOP_AT_ACCEPTABLE_POINT;
    report_.unbounded = status == Ipopt::DIVERGING_ITERATES;
    report_.multipliers.resize(problem_.inequalities);
    for (int i = 0; i < problem_.inequalities; ++i) report_.multipliers[i] = std::max(0.0, -multipliers[i]);
  }

 private:
  static constexpr double unbounded = 2e19;  // beyond Ipopt's infinity
  static std::span<const double> point(Index n, const Number* z) { return {z, static_cast<std::size_t>(n)}; }
  static void put_places(const std::vector<SparseEntry>& entries, Index* rows, Index* columns) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      rows[i] = entries[i].row;
      columns[i] = entries[i].column;
    }
  }

  const InequalityMinimum& problem_;
  std::vector<double>& z_;
  MinimumReport& report_;
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
  ipopt->OptimizeTNLP(new MinimumForIpopt(problem, z, report));
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
