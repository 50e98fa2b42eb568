#include "solve/laws.hpp"

/// \file Gauge and time reversal: changes of L that leave the extremals as they are, or run them backwards.

namespace extremal::laws {
namespace {

/// A system and its sum with dF(q, t)/dt.
struct Gauge {
  const char* name;
  Problem plain, changed;
  double difference;  ///< F(q(T), T) − F(q(0), 0)
  Values start, end;  ///< ∂F/∂q at the two ends
  int degree;         ///< of F along q(t) = t, where F is a polynomial; 0 where not
};

Gauge pendulum_with_sine() {
  const double T = 2, q = 1.5;
  const auto changed = trace(1, [](auto q, auto v, auto t) {
    return v[0] * v[0] / 2 + cos(q[0]) + cos(q[0]) * v[0] * t + sin(q[0]);
  });
  return {"sin(q) t",
          fixed_ends(systems::pendulum(), {0}, {q}, T),
          fixed_ends(changed, {0}, {q}, T),
          T * std::sin(q),
          {0},
          {T * std::cos(q)},
          0};
}

template <class F>
Gauge kepler_with(const char* name, int degree, F rate, double difference, Values start, Values end) {
  const auto changed = trace(2, [=](auto q, auto v, auto t) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]) + rate(q, v, t);
  });
  return {name,
          fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5),
          fixed_ends(changed, {1, 0}, {-0.6, 0.9}, 2.5),
          difference,
          std::move(start),
          std::move(end),
          degree};
}

Gauge kepler_with_cubic() {
  return kepler_with("x^2 y", 3,
                     [](auto q, auto v, auto) { return 2 * q[0] * q[1] * v[0] + q[0] * q[0] * v[1]; },
                     0.36 * 0.9, {0, 1}, {2 * -0.6 * 0.9, 0.36});
}

Gauge kepler_with_quadratic() {
  return kepler_with(
      "x y + 2 t x", 2,
      [](auto q, auto v, auto t) { return q[0] * v[1] + q[1] * v[0] + 2 * q[0] + 2 * t * v[0]; },
      -0.6 * 0.9 + 5 * -0.6, {0, 1}, {0.9 + 5, -0.6});
}

std::vector<Gauge> gauges() {
  std::vector<Gauge> list = {pendulum_with_sine(), kepler_with_cubic(), kepler_with_quadratic()};
  for (Gauge& gauge : list) {
    gauge.plain = guided(gauge.plain);
    gauge.changed = guided(gauge.changed);
  }
  return list;
}

/// The highest degree of polynomials that the quadrature integrates exactly.
int exactness(const Scheme& scheme) {
  switch (scheme.quadrature) {
    case Quadrature::left:
    case Quadrature::right:
      return 0;
    case Quadrature::midpoint:
    case Quadrature::ends:
      return 1;
    case Quadrature::simpson:
      return 3;
    case Quadrature::gauss:
      return 2 * scheme.points - 1;
    case Quadrature::lobatto:
      return 2 * scheme.points - 3;
    default:
      return 2 * max_points - 1;
  }
}

/// Whether dF/dt along an element is integrated exactly; where F is a polynomial its degree is deg(F)·s − 1.
bool exact(const Scheme& scheme, const Gauge& gauge) {
  if (scheme.quadrature == Quadrature::exact) return true;
  return gauge.degree > 0 && gauge.degree * scheme.degree - 1 <= exactness(scheme);
}

/// What the change of L does to the discrete solution, beyond what it does to the exact one.
struct Shift {
  double path, action, momenta;
};
Shift shift(const Gauge& gauge, const Scheme& scheme, int elements) {
  const Solution a = solve(gauge.plain, pinned(scheme, elements));
  const Solution b = solve(gauge.changed, pinned(scheme, elements));
  Shift result{};
  for (int k = 0; k <= elements; ++k)
    result.path = std::max(result.path, largest_difference(node(a.trajectory, k), node(b.trajectory, k)));
  result.action = std::abs(b.action - a.action - gauge.difference);
  for (std::size_t i = 0; i < gauge.start.size(); ++i)
    result.momenta =
        std::max({result.momenta, std::abs(b.momentum_start[i] - a.momentum_start[i] - gauge.start[i]),
                  std::abs(b.momentum_end[i] - a.momentum_end[i] - gauge.end[i])});
  return result;
}

constexpr double gauge_plateau = 2e-13;

TEST(Gauge, MovesTheDiscretePathByTheOrderOnly) {
  for (const Gauge& gauge : gauges())
    for (const Scheme& scheme : schemes_and_families()) {
      if (exact(scheme, gauge)) continue;
      Refinement path, action, momenta;
      const int first = scheme.order == 1 ? 200 : scheme.order == 2 ? 24 : scheme.order == 4 ? 8 : 4;
      for (int elements : refinements(first, 6)) {
        const Shift s = shift(gauge, scheme, elements);
        path.add(1.0 / elements, s.path);
        action.add(1.0 / elements, s.action);
        momenta.add(1.0 / elements, s.momenta);
      }
      const double least = scheme.order * 0.95;
      EXPECT_GT(path.slope(gauge_plateau), least) << gauge.name << ' ' << scheme.name;
      EXPECT_GT(action.slope(gauge_plateau), least) << gauge.name << ' ' << scheme.name;
      EXPECT_GT(momenta.slope(gauge_plateau), least) << gauge.name << ' ' << scheme.name;
    }
}

TEST(Gauge, MovesNothingWhereTheQuadratureIsExact) {
  int tested = 0;
  for (const Gauge& gauge : gauges())
    for (const Scheme& scheme : schemes_and_families()) {
      if (!exact(scheme, gauge)) continue;
      ++tested;
      for (int elements : {2, 4, 10}) {
        const Shift s = shift(gauge, scheme, elements);
        EXPECT_LT(s.path, 1e-13) << gauge.name << ' ' << scheme.name << ' ' << elements;
        EXPECT_LT(s.action, 1e-13) << gauge.name << ' ' << scheme.name << ' ' << elements;
        EXPECT_LT(s.momenta, 1e-13) << gauge.name << ' ' << scheme.name << ' ' << elements;
      }
    }
  EXPECT_EQ(tested, 18);
}

/// L(q, −q', T − t): its extremals are those of L run backwards.
struct Reversal {
  const char* name;
  std::shared_ptr<const Lagrangian> forward, backward;
  Values start, end;
  double duration;
};

std::vector<Reversal> reversals() {
  const auto driven_backward = trace(1, [](auto q, auto v, auto t) {
    const auto u = 2 - t;
    return v[0] * v[0] / 2 + cos(q[0]) + q[0] * sin(2 * u) - u * v[0] * q[0];
  });
  const auto magnetic_backward = trace(2, [](auto q, auto v, auto) {
    const auto field = 1 + q[0] * q[0] / 4;
    return (v[0] * v[0] + v[1] * v[1]) / 2 - field * (q[0] * v[1] - q[1] * v[0]) / 2 - q[0] * q[0] * q[1];
  });
  return {{"pendulum", systems::pendulum(), systems::pendulum(), {0}, {1.5}, 2},
          {"Kepler", systems::kepler(), systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5},
          {"double pendulum", systems::double_pendulum(), systems::double_pendulum(), {0, 0}, {1, 2}, 1},
          {"magnetic", systems::magnetic(), magnetic_backward, {0.3, -0.2}, {0.9, 0.5}, 1.5},
          {"driven", systems::driven(), driven_backward, {0}, {1}, 2}};
}

Scheme mirrored(const Scheme& scheme) {
  if (scheme.quadrature == Quadrature::left) return extremal::scheme("rectangle-right");
  if (scheme.quadrature == Quadrature::right) return extremal::scheme("rectangle");
  return scheme;
}

TEST(TimeReversal, RunsTheDiscretePathBackwards) {
  for (const Reversal& r : reversals()) {
    const Problem forward = guided(fixed_ends(r.forward, r.start, r.end, r.duration));
    const Problem backward = guided(fixed_ends(r.backward, r.end, r.start, r.duration));
    for (const Scheme& scheme : schemes_and_families())
      for (int elements : {2, 6}) {
        const Solution there = solve(forward, pinned(scheme, elements));
        const Solution back = solve(backward, pinned(mirrored(scheme), elements));
        for (int i = 0; i <= 60; ++i) {
          const double t = r.duration * i / 60;
          EXPECT_LT(largest_difference(at(there.trajectory, t).q, at(back.trajectory, r.duration - t).q),
                    1e-13)
              << r.name << ' ' << scheme.name << ' ' << elements << " elements, t = " << t;
        }
        EXPECT_NEAR(there.action, back.action, 1e-13 * std::max(1.0, std::abs(there.action))) << r.name;
        for (std::size_t a = 0; a < r.start.size(); ++a) {
          const double scale = 1e-13 * std::max(1.0, largest(there.momentum_start));
          EXPECT_NEAR(there.momentum_start[a], -back.momentum_end[a], scale) << r.name << ' ' << scheme.name;
          EXPECT_NEAR(there.momentum_end[a], -back.momentum_start[a], scale) << r.name << ' ' << scheme.name;
        }
      }
  }
}

}  // namespace
}  // namespace extremal::laws
