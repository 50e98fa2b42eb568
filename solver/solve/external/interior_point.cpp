#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <cstring>

#include "solve/external/external_solver.hpp"

namespace extremal {

namespace {

using Ipopt::Index;
using Ipopt::Number;

/// As many equations as unknowns, and nothing to minimise: extremals need not be minima.
class SquareSystem final : public Ipopt::TNLP {
 public:
  SquareSystem(Displacement& equations, std::vector<double>& z, const std::function<bool()>& count)
      : equations_(equations), z_(z), count_(count) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = m = equations_.size();
    jacobian = static_cast<Index>(equations_.derivatives().nonZeros());
    hessian = 0;
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index n, Number* lower, Number* upper, Index m, Number* least, Number* most) override {
    std::fill_n(lower, n, -unbounded);
    std::fill_n(upper, n, unbounded);
    std::fill_n(least, m, 0.0);
    std::fill_n(most, m, 0.0);
    return true;
  }
  bool get_starting_point(Index n, bool, Number* z, bool, Number*, Number*, Index, bool, Number*) override {
    std::copy_n(z_.begin(), n, z);
    return true;
  }
  bool eval_f(Index, const Number*, bool, Number& value) override {
    value = 0;
    return true;
  }
  bool eval_grad_f(Index n, const Number*, bool, Number* gradient) override {
    std::fill_n(gradient, n, 0.0);
    return true;
  }
  bool eval_g(Index n, const Number* z, bool, Index m, Number* values) override {
    if (!equations_.evaluate({z, static_cast<std::size_t>(n)}, false)) return false;
    std::copy_n(equations_.values().data(), m, values);
    return true;
  }
  bool eval_jac_g(Index n, const Number* z, bool, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    if (values && !equations_.evaluate({z, static_cast<std::size_t>(n)}, true)) return false;
    const auto& derivatives = equations_.derivatives();
    if (values) {
      std::copy_n(derivatives.valuePtr(), derivatives.nonZeros(), values);
      return true;
    }
    std::copy_n(derivatives.innerIndexPtr(), derivatives.nonZeros(), columns);
    for (int row = 0; row < n; ++row)
      std::fill(rows + derivatives.outerIndexPtr()[row], rows + derivatives.outerIndexPtr()[row + 1], row);
    return true;
  }
  /// Σ λ F'' is left out: where the equations hold the multipliers are zero.
  bool eval_h(Index, const Number*, bool, Number, Index, const Number*, bool, Index, Index*, Index*,
              Number*) override {
    return true;
  }
  bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number, Number,
                             Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    return count_();
  }
  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* z, const Number*, const Number*, Index,
                         const Number*, const Number*, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    std::copy_n(z, n, z_.begin());
  }

 private:
  static constexpr double unbounded = 2e19;  // beyond Ipopt's infinity
  Displacement& equations_;
  std::vector<double>& z_;
  const std::function<bool()>& count_;
};

}  // namespace

void solve_interior_point(Displacement& equations, std::vector<double>& z, const Deadline& deadline,
                          const std::function<bool()>& count) {
  if (!equations.evaluate(z, true)) return;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication(false);
  ipopt->Options()->SetIntegerValue("print_level", 0);
  ipopt->Options()->SetStringValue("sb", "yes");
  // Ipopt has its own largest value, and looks at the time more often than it calls back.
  ipopt->Options()->SetNumericValue("max_cpu_time", std::clamp(deadline.seconds_left(), 1e-3, 1e6));
  if (ipopt->Initialize("") != Ipopt::Solve_Succeeded) return;
  ipopt->OptimizeTNLP(new SquareSystem(equations, z, count));
}

}  // namespace extremal
