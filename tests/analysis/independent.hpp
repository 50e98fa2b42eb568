#pragma once

#include <Eigen/Dense>

#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "solve/laws.hpp"

/// \file Conjugate times by integration of the Jacobi equation beside the motion, forward in time: it shares
/// nothing with the discrete action but the derivatives of L.

namespace extremal::laws {

/// Motion from (q, p) at time 0 with the n Jacobi fields that vanish there, δq = 0 and δp = I.
class JacobiEquation {
 public:
  struct Fields {
    double t = 0;
    Values y;  ///< q, p, then δq, δp of each field
  };

  explicit JacobiEquation(const Lagrangian& lagrangian)
      : n_(lagrangian.structure().coordinates), flow_(lagrangian) {}

  Fields start(const Solution& solution) const {
    Fields fields{0, Values(2 * n_ * (n_ + 1))};
    const Values q = at(solution.trajectory, 0).q;
    std::copy(q.begin(), q.end(), fields.y.begin());
    std::copy(solution.momentum_start.begin(), solution.momentum_start.end(), fields.y.begin() + n_);
    for (int a = 0; a < n_; ++a) fields.y[2 * n_ * (a + 1) + n_ + a] = 1;
    return fields;
  }

  Fields advanced(Fields fields, double to) {
    Dop853 integrator(
        [this](double t, auto y, auto slope) { return flow_.slope_with_variations(t, y, slope); },
        static_cast<int>(fields.y.size()));
    if (integrator.advance(fields.t, fields.y, to, {.tolerance = 1e-14, .block = n_}) != Integrated::done)
      throw std::runtime_error("the integration failed");
    return fields;
  }

  /// Of δq, columns scaled to unit length.
  double determinant(const Fields& fields) const {
    Eigen::MatrixXd x(n_, n_);
    for (int c = 0; c < n_; ++c)
      for (int a = 0; a < n_; ++a) x(a, c) = fields.y[2 * n_ * (c + 1) + a];
    x.colwise().normalize();
    return x.determinant();
  }

 private:
  int n_;
  Flow flow_;
};

/// Where the determinant of δq changes its sign, by `steps` equal steps through [0, T] and bisection: simple
/// conjugate times that lie farther apart than a step.
inline Values integrated_conjugate_times(const Lagrangian& lagrangian, const Solution& solution, int steps) {
  JacobiEquation equation(lagrangian);
  const double T = solution.duration();
  JacobiEquation::Fields low = equation.advanced(equation.start(solution), 0.2 * T / steps);
  Values times;
  for (int k = 1; k <= steps; ++k) {
    JacobiEquation::Fields high = equation.advanced(low, T * k / steps), next = high;
    const double sign = equation.determinant(low);
    if (sign * equation.determinant(high) < 0) {
      while (high.t - low.t > 1e-12 * T) {
        JacobiEquation::Fields middle = equation.advanced(low, (low.t + high.t) / 2);
        (sign * equation.determinant(middle) < 0 ? high : low) = std::move(middle);
      }
      times.push_back((low.t + high.t) / 2);
    }
    low = std::move(next);
  }
  return times;
}

/// ∂(q, p)(T)/∂(q, p)(0), integrated.
inline Eigen::MatrixXd linearised_flow(const Lagrangian& lagrangian, const Solution& solution) {
  const int n = lagrangian.structure().coordinates;
  Flow flow(lagrangian);
  Values y = at(solution.trajectory, 0).q;
  y.insert(y.end(), solution.momentum_start.begin(), solution.momentum_start.end());
  y.resize(2 * n * (2 * n + 1));
  for (int c = 0; c < 2 * n; ++c) y[2 * n * (c + 1) + c] = 1;
  Dop853 integrator([&](double t, auto x, auto slope) { return flow.slope_with_variations(t, x, slope); },
                    static_cast<int>(y.size()));
  double t = 0;
  if (integrator.advance(t, y, solution.duration(), {.tolerance = 1e-14, .block = n}) != Integrated::done)
    throw std::runtime_error("the integration failed");
  return Eigen::Map<const Eigen::MatrixXd>(y.data() + 2 * n, 2 * n, 2 * n);
}

/// Windows abut and cover [0, T]; each is minimising and the union of two neighbours is not, by the index of
/// the problem between the same points of the trajectory, solved anew from it.
inline void expect_windows(const Solution& solution, const std::shared_ptr<const Lagrangian>& lagrangian,
                           bool autonomous = true) {
  ASSERT_FALSE(solution.windows.empty());
  EXPECT_EQ(solution.windows.front()[0], 0);
  EXPECT_EQ(solution.windows.back()[1], solution.duration());
  const auto index = [&](double from, double to, const SolveOptions& options) {
    Problem part =
        fixed_ends(lagrangian, at(solution.trajectory, from).q, at(solution.trajectory, to).q, to - from);
    // So close to it that the extremal next to it, past a nearby fold, is farther.
    const int points = 2000;
    for (int i = 0; i <= points; ++i) {
      part.guess.tau.push_back(static_cast<double>(i) / points);
      for (double q : at(solution.trajectory, from + (to - from) * i / points).q) part.guess.q.push_back(q);
    }
    return Solver().solve(make_problem(part), options).morse_index.value_or(-1);
  };
  for (std::size_t k = 0; k < solution.windows.size(); ++k) {
    const auto [from, to] = solution.windows[k];
    EXPECT_LT(from, to);
    if (k > 0) {
      EXPECT_EQ(from, solution.windows[k - 1][1]);
    }
    if (!autonomous) continue;
    const double inside = 1e-4 * (to - from);
    EXPECT_EQ(index(from, to - inside, pinned(lobatto(8), 64)), 0) << from << " to " << to;
    // A neighbour that is almost empty would make the ends of the union almost conjugate.
    if (k > 0 && to - from > 1e-2 * (from - solution.windows[k - 1][0])) {
      EXPECT_GE(index(solution.windows[k - 1][0], to, within(1e-8)), 1)
          << solution.windows[k - 1][0] << " to " << to;
    }
  }
}

}  // namespace extremal::laws
