#include <Eigen/Dense>

#include "action/discrete_action.hpp"
#include "machine/long_test.hpp"
#include "solve/laws.hpp"

/// \file The action as a generating function: its derivatives are the momenta and −E, and the map
/// (q(0), p(0)) → (q(T), p(T)) that it generates is symplectic, for every scheme.

namespace extremal::laws {
namespace {

struct NeighboursCase {
  const char* name;
  std::shared_ptr<const Lagrangian> lagrangian;
  Values start, end;
  double duration;

  Problem problem(const Values& q0, const Values& q1) const {
    Problem p = guided(fixed_ends(lagrangian, start, end, duration));
    p.boundary = {};
    p.boundary.coordinates = static_cast<int>(q0.size());
    for (std::size_t a = 0; a < q0.size(); ++a) {
      p.boundary.fix(static_cast<int>(a), false, q0[a]);
      p.boundary.fix(static_cast<int>(a), true, q1[a]);
    }
    return make_problem(std::move(p));
  }
};

std::vector<NeighboursCase> neighbours_cases() {
  return {{"double pendulum", systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 0.8},
          {"magnetic", systems::magnetic(), {0.3, -0.2}, {0.9, 0.5}, 1.5},
          {"quartic Hamiltonian", systems::quartic_hamiltonian(), {0.3, -0.2}, {0.9, 0.5}, 0.8}};
}

/// The solution with end e (q(0), then q(T)) moved by `step`.
Solution moved(const NeighboursCase& c, const SolveOptions& options, int e, double step) {
  const int n = static_cast<int>(c.start.size());
  Values q0 = c.start, q1 = c.end;
  (e < n ? q0[e] : q1[e - n]) += step;
  return solve(c.problem(q0, q1), options);
}

TEST(GeneratingFunction, SlopesInTheEndsAreTheMomenta) {
  LONG_TEST();
  for (const NeighboursCase& c : neighbours_cases())
    for (const Scheme& scheme : schemes_and_families())
      for (int elements : {1, 5}) {
        const SolveOptions options = pinned(scheme, elements);
        const Solution solution = solve(c.problem(c.start, c.end), options);
        const int n = static_cast<int>(c.start.size());
        for (int e = 0; e < 2 * n; ++e) {
          const double slope = difference([&](double h) { return moved(c, options, e, h).action; }, 1e-3);
          const double momentum = e < n ? -solution.momentum_start[e] : solution.momentum_end[e - n];
          EXPECT_NEAR(slope, momentum, 1e-9 * std::max(1.0, std::abs(momentum)))
              << c.name << ' ' << scheme.name << ' ' << elements << " elements, end " << e;
        }
      }
}

TEST(GeneratingFunction, SlopeInTheDurationIsMinusTheEnergy) {
  for (const NeighboursCase& c : neighbours_cases()) {
    const auto action = [&](double h) {
      Problem p = c.problem(c.start, c.end);
      p.duration.value += h;
      return solve(p, within(1e-13)).action;
    };
    const Solution solution = solve(c.problem(c.start, c.end), within(1e-13));
    EXPECT_NEAR(difference(action, 1e-3), -*solution.energy,
                1e-10 * std::max(1.0, std::abs(*solution.energy)))
        << c.name;
  }
}

/// Second derivatives of S_h in the ends, everything between them eliminated.
struct EndHessian {
  Eigen::MatrixXd start, end, end_start, start_end;  ///< ∂²S/∂q0², ∂q1², ∂q1∂q0, ∂q0∂q1

  explicit EndHessian(const NodeEquations& nodes, int elements, int n) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto block = [n](const std::vector<double>& x) -> RowMajor {
      return Eigen::Map<const RowMajor>(x.data(), n, n);
    };
    start = block(nodes.first);
    end = block(nodes.last);
    if (elements == 1) {
      end_start = block(nodes.first_lower);
      start_end = end_start.transpose();
      return;
    }
    const int inner = (elements - 1) * n;
    RowMajor from_start = RowMajor::Zero(inner, n), from_end = RowMajor::Zero(inner, n);
    from_start.topRows(n) = block(nodes.first_lower);
    from_end.bottomRows(n) = block(nodes.last_lower).transpose();
    RowMajor x = from_start, y = from_end;
    nodes.chain.solve(x.data(), n);
    nodes.chain.solve(y.data(), n);
    start -= from_start.transpose() * x;
    end -= from_end.transpose() * y;
    end_start = -from_end.transpose() * x;
    start_end = -from_start.transpose() * y;
  }

  /// With p0 = −∂S/∂q0 and p1 = ∂S/∂q1: d(q1, p1)/d(q0, p0). The two mixed blocks are used where they
  /// arise, not one for the other.
  Eigen::MatrixXd tangent() const {
    const Eigen::Index n = start.rows();
    const auto solve = start_end.fullPivLu();
    Eigen::MatrixXd m(2 * n, 2 * n);
    m.topLeftCorner(n, n) = -solve.solve(start);
    m.topRightCorner(n, n) = -solve.solve(Eigen::MatrixXd::Identity(n, n));
    m.bottomLeftCorner(n, n) = end_start + end * m.topLeftCorner(n, n);
    m.bottomRightCorner(n, n) = end * m.topRightCorner(n, n);
    return m;
  }
};

/// Of the discrete extremal of a case.
EndHessian end_hessian(const NeighboursCase& c, const Scheme& scheme, int elements) {
  const Problem problem = c.problem(c.start, c.end);
  const int n = problem.coordinates(), s = scheme.degree;
  const Solution solution = solve(problem, pinned(scheme, elements));
  const SchemeTables scheme_tables(scheme, 16);
  ElementTables tables;
  tables.bind(scheme_tables, *problem.lagrangian);
  Values mesh(elements + 1);
  for (int k = 0; k <= elements; ++k) mesh[k] = static_cast<double>(k) / elements;
  Path path;
  path.reset(tables, mesh, c.duration);
  for (int k = 0; k < elements; ++k)
    path.set_element(k, solution.trajectory.nodes.data() + static_cast<std::size_t>(k) * (s + 1) * n);
  path.load_ends();
  DiscreteAction action;
  action.reset(*problem.lagrangian, tables, elements, false);
  action.evaluate(path);
  if (elements > 1 && !action.nodes.chain.factor())
    throw std::runtime_error("the second variation is singular");
  return EndHessian(action.nodes, elements, n);
}

Eigen::MatrixXd canonical_form(Eigen::Index n) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  j.topRightCorner(n, n).setIdentity();
  j.bottomLeftCorner(n, n) = -Eigen::MatrixXd::Identity(n, n);
  return j;
}

TEST(Symplecticity, TangentMapPreservesTheCanonicalForm) {
  for (const NeighboursCase& c : neighbours_cases())
    for (const Scheme& scheme : schemes_and_families())
      for (int elements : {1, 4, 20}) {
        const Eigen::MatrixXd m = end_hessian(c, scheme, elements).tangent();
        const Eigen::MatrixXd j = canonical_form(m.rows() / 2);
        const double defect = (m.transpose() * j * m - j).cwiseAbs().maxCoeff();
        EXPECT_LT(defect, 1e-12 * std::max(1.0, m.squaredNorm()))
            << c.name << ' ' << scheme.name << ' ' << elements;
        EXPECT_NEAR(m.determinant(), 1, 1e-12 * std::max(1.0, m.squaredNorm()))
            << c.name << ' ' << scheme.name;
      }
}

/// The tangent map is that of the solutions themselves: momenta of neighbouring ones, differenced.
TEST(Symplecticity, MomentaOfNeighboursFollowTheTangentMap) {
  for (const NeighboursCase& c : neighbours_cases())
    for (const Scheme& scheme : {lobatto(1), lobatto(3), gauss(2), extremal::scheme("rectangle")})
      for (int elements : {1, 4}) {
        const EndHessian hessian = end_hessian(c, scheme, elements);
        const int n = static_cast<int>(c.start.size());
        const SolveOptions options = pinned(scheme, elements);
        Eigen::MatrixXd end_by_start(n, n), start_by_end(n, n), end_by_end(n, n), start_by_start(n, n);
        for (int e = 0; e < 2 * n; ++e)
          for (int a = 0; a < n; ++a) {
            const auto slope = [&](auto momentum) {
              return difference([&](double h) { return (moved(c, options, e, h).*momentum)[a]; }, 2.5e-4);
            };
            (e < n ? start_by_start(a, e) : start_by_end(a, e - n)) = slope(&Solution::momentum_start);
            (e < n ? end_by_start(a, e) : end_by_end(a, e - n)) = slope(&Solution::momentum_end);
          }
        const double bound = 1e-9 * std::max(1.0, hessian.start.cwiseAbs().maxCoeff());
        const auto distance = [](const Eigen::MatrixXd& x) { return x.cwiseAbs().maxCoeff(); };
        EXPECT_LT(distance(end_by_start + start_by_end.transpose()), bound) << c.name << ' ' << scheme.name;
        EXPECT_LT(distance(end_by_start - hessian.end_start), bound) << c.name << ' ' << scheme.name;
        EXPECT_LT(distance(start_by_end + hessian.start_end), bound) << c.name << ' ' << scheme.name;
        EXPECT_LT(distance(start_by_start + hessian.start), bound) << c.name << ' ' << scheme.name;
        EXPECT_LT(distance(end_by_end - hessian.end), bound) << c.name << ' ' << scheme.name;
      }
}

}  // namespace
}  // namespace extremal::laws
