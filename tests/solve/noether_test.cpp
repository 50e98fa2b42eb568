#include "solve/laws.hpp"

/// \file Noether: where L does not change under translations or rotations, the discrete momenta at the two
/// ends of a path agree to roundoff, on any mesh; the energy agrees to the order.

namespace extremal::laws {
namespace {

constexpr double masses[] = {1, 2.5, 0.4};

/// Three masses in the plane: coordinates x1, y1, x2, y2, x3, y3.
std::shared_ptr<const Lagrangian> three_body() {
  return trace(6, [](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (int i = 0; i < 3; ++i) {
      l += masses[i] * (v[2 * i] * v[2 * i] + v[2 * i + 1] * v[2 * i + 1]) / 2;
      for (int j = 0; j < i; ++j) {
        const auto dx = q[2 * i] - q[2 * j], dy = q[2 * i + 1] - q[2 * j + 1];
        l += masses[i] * masses[j] / sqrt(dx * dx + dy * dy);
      }
    }
    return l;
  });
}

std::shared_ptr<const Lagrangian> kepler_in_space() {
  return trace(3, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  });
}

/// The plane double pendulum without gravity turns freely: its total angular momentum is p1 + p2.
std::shared_ptr<const Lagrangian> weightless_double_pendulum() {
  return trace(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[1] * v[1] / 2 + v[0] * v[1] * cos(q[0] - q[1]) + cos(q[0] - q[1]);
  });
}

Problem three_body_problem() {
  return guided(fixed_ends(three_body(), {1, 0, -1, 0.2, 0.1, 1.5}, {0.8, 0.9, -1.1, -0.4, -0.5, 1.2}, 1));
}

const int coarse[] = {2, 3, 8};

TEST(Noether, LinearMomentum) {
  const Problem problem = three_body_problem();
  for (const Scheme& scheme : schemes_and_families())
    for (int elements : coarse) {
      const Solution s = solve(problem, pinned(scheme, elements));
      for (int axis : {0, 1}) {
        double start = 0, end = 0;
        for (int i = 0; i < 3; ++i)
          start += s.momentum_start[2 * i + axis], end += s.momentum_end[2 * i + axis];
        EXPECT_NEAR(start, end, 1e-14 * largest(s.momentum_start)) << scheme.name << ' ' << elements;
      }
    }
}

/// Σ x p_y − y p_x over pairs of coordinates.
double turn(const Values& q, const Values& p) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < q.size(); i += 2) sum += q[i] * p[i + 1] - q[i + 1] * p[i];
  return sum;
}

TEST(Noether, AngularMomentumInThePlane) {
  for (const Problem& problem :
       {three_body_problem(), guided(fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5))})
    for (const Scheme& scheme : schemes_and_families())
      for (int elements : coarse) {
        const Solution s = solve(problem, pinned(scheme, elements));
        const Values first = node(s.trajectory, 0), last = node(s.trajectory, elements);
        EXPECT_NEAR(turn(first, s.momentum_start), turn(last, s.momentum_end),
                    2e-14 * largest(s.momentum_start))
            << scheme.name << ' ' << elements;
      }
}

TEST(Noether, AngularMomentumInSpace) {
  const Problem problem = guided(fixed_ends(kepler_in_space(), {1, 0, 0.1}, {-0.5, 0.9, 0.4}, 2.2));
  for (const Scheme& scheme : schemes_and_families())
    for (int elements : coarse) {
      const Solution s = solve(problem, pinned(scheme, elements));
      const Values a = node(s.trajectory, 0), b = node(s.trajectory, elements);
      const Values &p = s.momentum_start, &r = s.momentum_end;
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        EXPECT_NEAR(a[j] * p[k] - a[k] * p[j], b[j] * r[k] - b[k] * r[j], 1e-14 * largest(p)) << scheme.name;
      }
    }
}

TEST(Noether, RotationOfAnglesWithAMassThatDependsOnThem) {
  const Problem problem = guided(fixed_ends(weightless_double_pendulum(), {0, 0.5}, {1.2, 0.3}, 1.5));
  for (const Scheme& scheme : schemes_and_families())
    for (int elements : coarse) {
      const Solution s = solve(problem, pinned(scheme, elements));
      EXPECT_NEAR(s.momentum_start[0] + s.momentum_start[1], s.momentum_end[0] + s.momentum_end[1],
                  1e-14 * largest(s.momentum_start))
          << scheme.name << ' ' << elements;
    }
}

/// H(q(T), p(T)) − H(q(0), p(0)) with discrete momenta falls with the order.
TEST(Noether, EnergyToTheOrder) {
  const Problem problem = guided(fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5));
  const auto energy = [](const Values& q, const Values& p) {
    return (p[0] * p[0] + p[1] * p[1]) / 2 - 1 / std::hypot(q[0], q[1]);
  };
  constexpr double plateau = 1e-14;
  for (const Scheme& scheme : schemes_and_families()) {
    Refinement drift;
    const int first = scheme.order == 1   ? 200
                      : scheme.order == 2 ? 24
                      : scheme.order == 4 ? 8
                      : scheme.order == 6 ? 5
                                          : 3;
    for (int elements : refinements(first, 6)) {
      const Solution s = solve(problem, pinned(scheme, elements));
      drift.add(1.0 / elements, std::abs(energy(node(s.trajectory, elements), s.momentum_end) -
                                         energy(node(s.trajectory, 0), s.momentum_start)));
    }
    EXPECT_NEAR(drift.slope(plateau), scheme.order, 0.06 * scheme.order) << scheme.name;
  }
}

}  // namespace
}  // namespace extremal::laws
