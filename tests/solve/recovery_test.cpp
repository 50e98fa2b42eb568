#include "action/recovery.hpp"

#include <gtest/gtest.h>

#include "solve/laws.hpp"
#include "solve/scenes.hpp"

/// \file Polynomials of degree s + 2 from elements of degree s: their order, in q and q'.

namespace extremal::laws {
namespace {

/// The extremal of S_h on elements of a trajectory, and what its momenta make of it.
Trajectory recovered(const Problem& problem, const Trajectory& found) {
  const SchemeTables &scheme = SchemeTables::of_lobatto(found.degree),
                     &raised = SchemeTables::of_lobatto(found.degree + Recovery::raised_by);
  ElementTables tables, more;
  tables.bind(scheme, *problem.lagrangian);
  more.bind(raised, *problem.lagrangian);
  Values mesh;
  for (double t : found.times) mesh.push_back(t / found.duration());
  Path path, result;
  path.reset(tables, mesh, found.duration());
  const std::size_t size = static_cast<std::size_t>(found.degree + 1) * found.coordinates;
  for (int k = 0; k < found.elements(); ++k) path.set_element(k, found.nodes.data() + k * size);
  path.load_ends();
  DiscreteAction action;
  action.reset(*problem.lagrangian, tables, found.elements(), false, Condense::nothing);
  Recovery recovery;
  if (!recovery.measure(*problem.lagrangian, action, path)) throw std::runtime_error("L_vv is singular");
  recovery.raise(path, more, interpolation_matrix(found.degree, raised.lobatto), result);
  return trajectory_of(result);
}

struct Case {
  const char* name;
  std::shared_ptr<const Lagrangian> lagrangian;
  Values start, end;
  double duration;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list = {
      {"oscillator", systems::oscillator(1), {1}, {0.3}, 2},
      {"pendulum", systems::pendulum(), {-1}, {1.2}, 2},
      {"Kepler", systems::kepler(), {1, 0}, {-0.2, 1.1}, 1.7},
      {"restricted", systems::restricted_three_body(), {0.3, 0.4, 0.1}, {-0.4, 0.6, -0.1}, 1},
      {"magnetic", systems::magnetic(), {0.3, 0.4}, {0.8, -0.2}, 1},
      {"driven", systems::driven(), {0.3}, {0.8}, 2},
      {"double pendulum", systems::double_pendulum(), {0.3, -0.4}, {0.5, 0.6}, 0.4}};
  return list;
}

double sup_slope(const Trajectory& path, const Trajectory& truth) {
  double result = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double t = path.duration() * i / 1000;
    result = std::max(result, largest_difference(at(path, t).v, at(truth, t).v));
  }
  return result;
}

struct Gain {
  double order_q, order_v;  ///< of what was recovered, above the degree
  double factor;            ///< of errors of q before
};

Gain gain(const Case& c, int degree, int elements) {
  const Problem problem = guided(fixed_ends(c.lagrangian, c.start, c.end, c.duration));
  const Trajectory truth = solve(problem, within(1e-13)).trajectory;
  Values q, v;
  double before = 0;
  for (int count : {elements / 2, elements}) {
    const Trajectory found = solve(problem, pinned(lobatto(degree), count)).trajectory;
    const Trajectory more = recovered(problem, found);
    q.push_back(sup_distance(more, truth));
    v.push_back(sup_slope(more, truth));
    before = sup_distance(found, truth);
  }
  return {std::log2(q[0] / q[1]) - degree, std::log2(v[0] / v[1]) - degree, before / q[1]};
}

/// At least so much, of degrees 3 to 5.
void expect(const Case& c, const Gain& least) {
  for (int s : {3, 4, 5}) {
    const Gain found = gain(c, s, 64 / s);
    EXPECT_GT(found.order_q, least.order_q) << c.name << s;
    EXPECT_GT(found.order_v, least.order_v) << c.name << s;
    EXPECT_GT(found.factor, least.factor) << c.name << s;
  }
}

/// Lagrange's polynomials through s + 3 exact values would have the orders s + 3 and s + 2.
TEST(Recovery, OfConstantMassesHasTwoMoreOrders) {
  for (int i : {0, 1, 2}) expect(cases()[i], {2.8, 1.8, 200});
}

TEST(Recovery, ElsewhereHasOne) {
  for (int i : {3, 4, 5}) expect(cases()[i], {1.85, 0.85, 20});
  for (int s : {3, 4}) EXPECT_GT(gain(cases()[6], s, 64 / s).factor, 5) << s;
}

/// A near-rectilinear halo orbit: beside the moon q is known long before q'.
TEST(Recovery, TellsVelocitiesThatElementsDoNot) {
  Study study = load(bench_data("nrho.toml"));
  study.problem.reduction = nullptr;
  study.options.tolerance = 1e-8;
  const Solution s = run(study);
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_EQ(s.trajectory.degree, s.degree + Recovery::raised_by);
  EXPECT_LT(*s.energy_drift, 5e-8);
  study.options.tolerance = 1e-12;
  const Solution truth = run(study);
  EXPECT_NEAR(s.duration(), truth.duration(), 1e-10);
  EXPECT_EQ(s.morse_index, truth.morse_index);
}

}  // namespace
}  // namespace extremal::laws
