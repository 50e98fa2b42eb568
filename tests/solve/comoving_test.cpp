#include "solve/homotopy/comoving.hpp"

#include <numbers>

#include "machine/simd.hpp"
#include "solve/adapt/workspace.hpp"
#include "solve/laws.hpp"
#include "solve/mesh/mesh.hpp"

/// \file Changes of a path that take its mesh along.

namespace extremal::laws {
namespace {

using std::numbers::pi;

constexpr int degree = 8, elements = 24;
constexpr double extent = 2;
/// The width of the bend in (tanh((τ − 1/2)/width), τ²).
constexpr double width = 0.1;

Values bend(double tau) { return {std::tanh((tau - 0.5) / width), tau * tau}; }
Values bend_slope(double tau) {
  const double x = std::cosh((tau - 0.5) / width);
  return {1 / (width * x * x), 2 * tau};
}

class ComovingTest : public testing::Test {
 protected:
  ComovingTest() {
    levels_.bind(systems::kepler());
    path_ = sampled(bend);
  }

  const ElementTables& tables() { return levels_.at(degree); }

  /// A path through the values of a function at the nodes.
  Path sampled(const std::function<Values(double)>& at) {
    Path path;
    const std::vector<double> mesh = uniform_mesh(elements);
    path.reset(tables(), mesh, 3);
    for (int k = 0; k < elements; ++k) {
      Values q;
      for (double c : lobatto_nodal_basis(degree).points)
        for (double x : at(mesh[k] + c * (mesh[k + 1] - mesh[k]))) q.push_back(x);
      path.set_element(k, q.data());
    }
    path.load_ends();
    return path;
  }

  Step step(const std::function<Values(double)>& at) {
    const Path change = sampled(at);
    Step step;
    step.nodes.assign(change.nodes().begin(), change.nodes().end());
    step.inner.assign(change.x(0), change.x(0) + change.batches() * tables().unknowns() * simd_lanes());
    return step;
  }

  /// Largest difference of the path after the step and after what it was rewritten to.
  double deviation(const Step& at_rest, const Step& moving, const Values& times, double factor) {
    Path a = path_, b = path_, c;
    a.add(at_rest.nodes, at_rest.inner, factor);
    a.load_ends();
    b.add(moving.nodes, moving.inner, factor);
    EXPECT_TRUE(b.move_mesh(times, factor, 0.1));
    b.load_ends();
    c.resample_from(a, tables(), b.mesh());
    double most = 0;
    Values p(2 * (degree + 1)), q(p.size());
    for (int k = 0; k < elements; ++k) {
      b.element(k, p.data());
      c.element(k, q.data());
      most = std::max(most, largest_difference(p, q));
    }
    return most;
  }

  Levels levels_;
  Path path_;
  Comoving comoving_;
  Values times_;
};

/// What is made least.
double change(const Path& path, const Step& step, const Values& times) {
  double sum = 0;
  for (double x : step.nodes) sum += x * x;
  return sum / (extent * extent * static_cast<double>(step.nodes.size())) +
         strain_product(path, times, times);
}

TEST_F(ComovingTest, ABendThatMovesChangesLess) {
  const Step at_rest = step([](double tau) {
    Values v = bend_slope(tau);
    for (double& x : v) x *= -std::sin(pi * tau);
    return v;
  });
  Step moving = at_rest;
  comoving_.take_along(path_, extent, moving, times_);
  const double least = change(path_, moving, times_);
  EXPECT_LT(least, 0.95 * change(path_, at_rest, {}));
  EXPECT_GT(times_[elements / 2], 0.1);
  EXPECT_EQ(times_.front(), 0);
  EXPECT_EQ(times_.back(), 0);
  // Any other movement of the mesh changes more.
  for (int k = 1; k < elements; ++k)
    for (const double by : {-1e-3, 1e-3}) {
      Step other = moving;
      Values times = times_;
      times[k] += by;
      const double tau = path_.mesh()[k];
      for (int a = 0; a < 2; ++a) other.nodes[2 * k + a] += by * bend_slope(tau)[a];
      EXPECT_GT(change(path_, other, times), least) << k;
    }
}

TEST_F(ComovingTest, ThePathIsTheSameToFirstOrder) {
  const Step at_rest = step([](double tau) {
    return Values{std::sin(3 * tau) * (1 - tau), tau * std::cos(2 * pi * tau)};
  });
  Step moving = at_rest;
  comoving_.take_along(path_, extent, moving, times_);
  const double coarse = deviation(at_rest, moving, times_, 1e-2);
  const double fine = deviation(at_rest, moving, times_, 5e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

TEST_F(ComovingTest, ElementsKeepAPartOfTheirLength) {
  Values times(elements + 1, 0);
  times[1] = 1.0 / elements;
  const Values before(path_.mesh().begin(), path_.mesh().end());
  EXPECT_FALSE(path_.move_mesh(times, 0.8, 0.3));
  EXPECT_EQ(Values(path_.mesh().begin(), path_.mesh().end()), before);
  EXPECT_TRUE(path_.move_mesh(times, 0.6, 0.3));
  EXPECT_DOUBLE_EQ(path_.mesh()[1], 1.6 / elements);
  EXPECT_DOUBLE_EQ(path_.h(0)[1], 0.4 * 3 / elements);
}

}  // namespace
}  // namespace extremal::laws
