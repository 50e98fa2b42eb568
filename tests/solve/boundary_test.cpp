#include <Eigen/Dense>
#include <numbers>

#include "solve/laws.hpp"

/// \file Every form of boundary relation, against closed forms.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// Σ coefficient x_e = c.
void couple(BoundaryRelation& relation, const std::vector<std::pair<int, double>>& terms, double c) {
  const int row = relation.add_row(c);
  for (const auto& [e, coefficient] : terms) relation.add(row, e, coefficient);
}

TEST(NaturalEnds, OscillatorFreeAtOneEnd) {
  const double w = 1.3, T = 2, a = 0.7;
  const auto truth = [=](double t) { return Values{a * std::cos(w * (T - t)) / std::cos(w * T)}; };
  const auto end_free = with_ends(systems::oscillator(w), T, [=](auto& b) { b.fix(0, false, a); });
  const auto start_free = with_ends(systems::oscillator(w), T, [=](auto& b) { b.fix(0, true, a); });
  const Solution forward = solve(end_free, within(1e-12)), backward = solve(start_free, within(1e-12));
  EXPECT_LT(distance(forward.trajectory, truth), 1e-12);
  EXPECT_LT(distance(backward.trajectory, [&](double t) { return truth(T - t); }), 1e-12);
  EXPECT_LT(std::abs(forward.momentum_end[0]), 1e-14);
  EXPECT_LT(std::abs(backward.momentum_start[0]), 1e-14);
}

/// q'' = t − q, q'(0) = q'(T) = 0: q = t − sin t + tan(T/2) cos t.
TEST(NaturalEnds, DrivenOscillatorFreeAtBothEnds) {
  const double T = 2.5;
  const auto lagrangian =
      trace(1, [](auto q, auto v, auto t) { return (v[0] * v[0] - q[0] * q[0]) / 2 + t * q[0]; });
  const Solution s = solve(with_ends(lagrangian, T, [](auto&) {}), within(1e-12));
  EXPECT_LT(distance(s.trajectory,
                     [=](double t) { return Values{t - std::sin(t) + std::tan(T / 2) * std::cos(t)}; }),
            1e-12);
  EXPECT_LT(std::abs(s.momentum_start[0]), 1e-14);
  EXPECT_LT(std::abs(s.momentum_end[0]), 1e-14);
}

/// From q = 0, at rest after a quarter of the period 4K(sin²(A/2)): the amplitude A, from p = 2 sin(A/2).
TEST(NaturalEnds, PendulumComesToRestAtItsAmplitude) {
  const double amplitude = 1.0, T = std::comp_ellint_1(std::sin(amplitude / 2));
  const Problem problem = guessed(with_ends(systems::pendulum(), T, [](auto& b) { b.fix(0, false, 0); }),
                                  [](double tau) { return Values{1.1 * std::sin(pi * tau / 2)}; });
  const Solution s = solve(problem, within(1e-13));
  EXPECT_NEAR(at(s.trajectory, T).q[0], amplitude, 1e-12);
  EXPECT_NEAR(s.momentum_start[0], 2 * std::sin(amplitude / 2), 1e-12);
  EXPECT_LT(std::abs(s.momentum_end[0]), 1e-14);
}

TEST(NaturalEnds, DiscreteMomentumVanishesForEveryScheme) {
  const Problem problem = guided(with_ends(systems::double_pendulum(), 0.7,
                                           [](auto& b) { b.fix(0, false, 0.4), b.fix(1, true, -0.3); }));
  for (const Scheme& scheme : schemes_and_families())
    for (int elements : {4, 9}) {
      const Solution s = solve(problem, pinned(scheme, elements));
      const double bound = 1e-14 * std::max(largest(s.momentum_start), largest(s.momentum_end));
      EXPECT_LT(std::abs(s.momentum_start[1]), bound) << scheme.name << ' ' << elements;
      EXPECT_LT(std::abs(s.momentum_end[0]), bound) << scheme.name << ' ' << elements;
      EXPECT_NE(s.momentum_start[0], 0);
    }
}

/// Three driven oscillators, q_i = f_i/ω_i² + A_i cos ω_i t + B_i sin ω_i t.
class Trio {
 public:
  static constexpr double omega[] = {1.0, 1.3, 0.8}, force[] = {0.5, -1.0, 0.7};
  static constexpr double T = 2.2;

  static std::shared_ptr<const Lagrangian> lagrangian() {
    return trace(3, [](auto q, auto v, auto) {
      auto l = 0 * v[0];
      for (int i = 0; i < 3; ++i)
        l += (v[i] * v[i] - omega[i] * omega[i] * q[i] * q[i]) / 2 + force[i] * q[i];
      return l;
    });
  }

  /// Adds the equation Σ coefficient·(q_i or p_i at 0 or T) = c to those that determine A and B.
  struct Item {
    int i;
    bool momentum, at_end;
    double coefficient;
  };
  void demand(const std::vector<Item>& items, double c) {
    matrix_.row(rows_).setZero();
    right_[rows_] = c;
    for (const Item& x : items) {
      const double w = omega[x.i], t = x.at_end ? T : 0;
      matrix_(rows_, 2 * x.i) += x.coefficient * (x.momentum ? -w * std::sin(w * t) : std::cos(w * t));
      matrix_(rows_, 2 * x.i + 1) += x.coefficient * (x.momentum ? w * std::cos(w * t) : std::sin(w * t));
      if (!x.momentum) right_[rows_] -= x.coefficient * force[x.i] / (w * w);
    }
    if (++rows_ == 6) c_ = matrix_.fullPivLu().solve(right_);
  }

  Values operator()(double t) const {
    Values q(3);
    for (int i = 0; i < 3; ++i)
      q[i] = force[i] / (omega[i] * omega[i]) + c_[2 * i] * std::cos(omega[i] * t) +
             c_[2 * i + 1] * std::sin(omega[i] * t);
    return q;
  }

 private:
  int rows_ = 0;
  Eigen::Matrix<double, 6, 6> matrix_;
  Eigen::Matrix<double, 6, 1> right_, c_;
};

constexpr bool q = false, p = true, start = false, end = true;

TEST(MixedEnds, EachCoordinateItsOwn) {
  Trio truth;
  truth.demand({{0, q, start, 1}}, 0.2);
  truth.demand({{0, q, end, 1}}, -0.4);
  truth.demand({{1, q, start, 1}}, 1.0);
  truth.demand({{1, p, end, 1}}, 0);
  truth.demand({{2, p, start, 1}}, 0);
  truth.demand({{2, p, end, 1}}, 0);
  const Solution s = solve(with_ends(Trio::lagrangian(), Trio::T,
                                     [](auto& b) {
                                       b.fix(0, false, 0.2);
                                       b.fix(0, true, -0.4);
                                       b.fix(1, false, 1.0);
                                     }),
                           within(1e-12));
  EXPECT_LT(distance(s.trajectory, truth), 1e-12);
  EXPECT_EQ(at(s.trajectory, 0).q[0], 0.2);
  EXPECT_EQ(at(s.trajectory, Trio::T).q[0], -0.4);
}

/// Where δx is admitted only along Z, stationarity asks (−p(0), p(T))·Z = 0.
TEST(CoupledEnds, NaturalConditionsAreThoseOfTheRelation) {
  Trio truth;
  truth.demand({{0, q, end, 1}, {0, q, start, 1}}, 0);     // x(T) = −x(0)
  truth.demand({{0, p, end, 1}, {0, p, start, 1}}, 0);     // and so p_x(T) = −p_x(0)
  truth.demand({{1, q, start, 1}, {2, q, start, 1}}, 0);   // y(0) + z(0) = 0
  truth.demand({{1, p, start, 1}, {2, p, start, -1}}, 0);  // p_y(0) = p_z(0)
  truth.demand({{1, q, end, 1}, {2, q, end, -2}}, 1);      // y(T) = 2 z(T) + 1
  truth.demand({{1, p, end, 2}, {2, p, end, 1}}, 0);       // 2 p_y(T) + p_z(T) = 0
  const Solution s = solve(with_ends(Trio::lagrangian(), Trio::T,
                                     [](auto& b) {
                                       couple(b, {{3, 1}, {0, 1}}, 0);
                                       couple(b, {{1, 1}, {2, 1}}, 0);
                                       couple(b, {{4, 1}, {5, -2}}, 1);
                                     }),
                           within(1e-12));
  EXPECT_LT(distance(s.trajectory, truth), 2e-12);
  EXPECT_NEAR(s.momentum_end[0], -s.momentum_start[0], 1e-14);
  EXPECT_NEAR(s.momentum_start[1], s.momentum_start[2], 1e-14);
  EXPECT_NEAR(2 * s.momentum_end[1], -s.momentum_end[2], 1e-14);
}

/// q'' = −ω²q + cos Ωt with period 2π/Ω: q = cos Ωt/(ω² − Ω²).
TEST(CoupledEnds, ForcedPeriodicOscillation) {
  const double w = 1.7, rate = 1.0, T = 2 * pi / rate;
  const auto lagrangian = trace(1, [=](auto q, auto v, auto t) {
    return (v[0] * v[0] - w * w * q[0] * q[0]) / 2 + q[0] * cos(rate * t);
  });
  const Solution s = solve(with_ends(lagrangian, T,
                                     [](auto& b) {
                                       couple(b, {{1, 1}, {0, -1}}, 0);
                                     }),
                           within(1e-12));
  EXPECT_LT(
      distance(s.trajectory, [=](double t) { return Values{std::cos(rate * t) / (w * w - rate * rate)}; }),
      1e-12);
  EXPECT_NEAR(s.momentum_start[0], s.momentum_end[0], 1e-14);
}

/// q'' = −ω²q with p(0) = a and p(T) = b, in every scheme to its order; the index is that of natural ends.
TEST(GivenMomenta, OscillatorAtBothEnds) {
  const double w = 1.3, T = 2, a = 0.4, b = -0.7;
  const auto truth = [=](double t) {
    const double amplitude = (a * std::cos(w * T) - b) / (w * std::sin(w * T));
    return Values{amplitude * std::cos(w * t) + a / w * std::sin(w * t)};
  };
  const auto given = with_ends(systems::oscillator(w), T, [=](auto& r) {
    r.give_momentum(0, false, a);
    r.give_momentum(0, true, b);
  });
  const Solution s = solve(given, within(1e-12));
  EXPECT_LT(distance(s.trajectory, truth), 1e-12);
  EXPECT_NEAR(s.momentum_start[0], a, 1e-13);
  EXPECT_NEAR(s.momentum_end[0], b, 1e-13);
  EXPECT_EQ(s.morse_index,
            solve(with_ends(systems::oscillator(w), T, [](auto&) {}), within(1e-12)).morse_index);
  for (const Scheme& scheme : schemes_and_families()) {
    const Solution discrete = solve(given, pinned(scheme, 32));
    EXPECT_NEAR(discrete.momentum_start[0], a, 1e-12) << scheme.name;
    EXPECT_NEAR(discrete.momentum_end[0], b, 1e-12) << scheme.name;
    EXPECT_LT(node_distance(discrete.trajectory, s.trajectory), one_sided(scheme) ? 0.1 : 0.01)
        << scheme.name;
  }
}

/// The extremal between the ends that one with given momenta has found is the same. Chains of 2 and of 90
/// sites, dense and sparse, by each method.
TEST(GivenMomenta, ExtremalIsThatBetweenItsEnds) {
  for (const int n : {2, 90}) {
    const auto lagrangian = trace(n, [n](auto q, auto v, auto) {
      auto sum = v[0] * v[0] * 0.0;
      for (int i = 0; i < n; ++i)
        sum = sum + v[i] * v[i] / 2.0 - q[i] * q[i] / 2.0 + q[i] * q[i] * q[i] * q[i] / 20.0;
      for (int i = 0; i + 1 < n; ++i) sum = sum - (q[i + 1] - q[i]) * (q[i + 1] - q[i]) / 4.0;
      return sum;
    });
    const Problem given = with_ends(lagrangian, 0.7, [n](auto& r) {
      for (int i = 0; i < n; ++i) {
        if (i % 2 == 0)
          r.give_momentum(i, false, 0.3 * std::cos(i));
        else
          r.fix(i, false, 0.2);
        if (i % 3 == 0) r.give_momentum(i, true, -0.2);
      }
    });
    for (const Method method : {Method::newton, Method::ceres, Method::ipopt}) {
      if (!available(method) || (method != Method::newton && n > 2)) continue;
      SolveOptions options = within(1e-11);
      options.method = method;
      const Solution s = solve(given, options);
      for (int i = 0; i < n; ++i) {
        if (i % 2 == 0) {
          EXPECT_NEAR(s.momentum_start[i], 0.3 * std::cos(i), 1e-11) << n;
        }
        EXPECT_NEAR(s.momentum_end[i], i % 3 == 0 ? -0.2 : 0, 1e-11) << n;
      }
      const Values start = at(s.trajectory, 0).q, end = at(s.trajectory, 0.7).q;
      const Solution between = solve(fixed_ends(lagrangian, start, end, 0.7), within(1e-11));
      EXPECT_LT(largest_difference(between.momentum_start, s.momentum_start), 1e-9) << n;
      EXPECT_LT(largest_difference(at(between.trajectory, 0.3).q, at(s.trajectory, 0.3).q), 1e-9) << n;
    }
  }
}

/// The equilibrium, on which nothing moves and which has no size.
TEST(Equilibrium, IsASolution) {
  for (const auto& relation : {Relation([](auto& b) { b.fix(0, false, 0), b.fix(0, true, 0); }),
                               Relation([](auto& b) { b.fix(0, false, 0); }), Relation([](auto&) {})}) {
    const Problem problem = with_ends(systems::pendulum(), 1.2, relation);
    for (const SolveOptions& options : {within(1e-9), pinned(lobatto(2), 5)}) {
      const Solution s = solve(problem, options);
      EXPECT_EQ(largest(at(s.trajectory, 0.6).q), 0);
      EXPECT_EQ(s.momentum_start[0], 0);
      EXPECT_NEAR(s.action, 1.2, 1e-14);
      EXPECT_TRUE(std::isfinite(s.error_estimate) && std::isfinite(s.residual));
    }
  }
}

}  // namespace
}  // namespace extremal::laws
