#include "system/hamiltonian.hpp"

#include <gtest/gtest.h>
#include <qd/dd_real.h>

#include <cmath>
#include <limits>

#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "system/formula.hpp"
#include "system/legendre_lagrangian.hpp"

namespace extremal {
namespace {

using Numbers = std::vector<double>;
using Parameters = std::map<std::string, ParameterText>;

/// The same system twice, and a point.
struct Pair {
  const char* name;
  std::vector<std::string> coordinates;
  Parameters parameters;
  std::string lagrangian, hamiltonian;
  Numbers q, v;
  bool expression;  ///< L of the Hamiltonian is one

  System of_lagrangian() const {
    return compile({.coordinates = coordinates, .parameters = parameters, .lagrangian = lagrangian});
  }
  System of_hamiltonian() const {
    return compile({.coordinates = coordinates, .parameters = parameters, .hamiltonian = hamiltonian});
  }
};

const std::vector<Pair>& pairs() {
  static const std::vector<Pair> all{
      {"oscillator", {"x"}, {{"k", {{2.5}}}}, "x'^2/2 - k*x^2/2", "p_x^2/2 + k*x^2/2", {0.3}, {0.7}, true},
      {"driven", {"x"}, {}, "x'^2 - x*cos(3*t)", "p_x^2/4 + x*cos(3*t)", {0.3}, {0.7}, true},
      {"magnetic",
       {"x", "y"},
       {{"B", {{1.7}}}, {"m", {{2}}}},
       "m*(x'^2 + y'^2)/2 + B*(x*y' - y*x')/2 - x^4/4",
       "((p_x + B*y/2)^2 + (p_y - B*x/2)^2)/(2*m) + x^4/4",
       {0.3, -0.8},
       {0.7, 0.4},
       true},
      {"rotating",
       {"x", "y"},
       {},
       "((x' - y)^2 + (y' + x)^2)/2 + 1/sqrt(x^2 + y^2)",
       "(p_x^2 + p_y^2)/2 + y*p_x - x*p_y - 1/sqrt(x^2 + y^2)",
       {0.3, -0.8},
       {0.7, 0.4},
       true},
      {"double pendulum",
       {"a", "b"},
       {{"g", {{9.81}}}},
       "a'^2 + b'^2/2 + a'*b'*cos(a - b) + g*(2*cos(a) + cos(b))",
       "(p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2)) - g*(2*cos(a) + cos(b))",
       {0.3, -0.8},
       {0.7, 0.4},
       true},
      {"three coupled",
       {"x", "y", "z"},
       {},
       "(2*x'^2 + 3*y'^2 + 4*z'^2)/2*exp(x) + 3*z' - y",
       "exp(-x)*(p_x^2/4 + p_y^2/6 + (p_z - 3)^2/8) + y",
       {0.3, -0.8, 0.1},
       {0.7, 0.4, -1.2},
       true},
      {"indefinite", {"x", "y"}, {}, "x'*y' - x*y", "p_x*p_y + x*y", {0.3, -0.8}, {0.7, 0.4}, true},
      {"relativistic", {"x"}, {}, "-sqrt(1 - x'^2) - x^2/2", "sqrt(1 + p_x^2) + x^2/2", {0.3}, {0.7}, true},
      {"relativistic charge",
       {"x", "y"},
       {{"B", {{0.6}}}, {"m", {{3}}}, {"c", {{2}}}},
       "-m*c^2*sqrt(1 - (x'^2 + y'^2)/c^2) - B*y*x' - x^2",
       "c*sqrt(m^2*c^2 + (p_x + B*y)^2 + p_y^2) + x^2",
       {0.3, -0.8},
       {0.7, 0.4},
       true},
      {"Lotka-Volterra",
       {"x"},
       {},
       "(x' + 1)*(log(x' + 1) - 1) - exp(x) + x",
       "exp(p_x) - p_x + exp(x) - x",
       {0.3},
       {0.7},
       false},
      {"logarithmic",
       {"x", "y"},
       {},
       "-log(x') - 1 - (1 + x^2)*y'^2/4 - y",
       "-log(-p_x) - p_y^2/(1 + x^2) + y",
       {0.3, -0.8},
       {0.7, 0.4},
       false},
      // |q'|² = P/(1 − P)² with P = |p|²; at p = q' there is no H.
      {"three momenta coupled",
       {"x", "y", "z"},
       {},
       "(sqrt(1 + 4*(x'^2 + y'^2 + z'^2)) - 1 + log(2/(1 + sqrt(1 + 4*(x'^2 + y'^2 + z'^2)))))/2 - x*y",
       "-log(1 - p_x^2 - p_y^2 - p_z^2)/2 + x*y",
       {0.3, -0.8, 0.1},
       {0.7, 0.4, -1.2},
       false},
      {"four momenta coupled",
       {"x", "y", "z", "w"},
       {},
       "(sqrt(1 + 4*(x'^2 + y'^2 + z'^2 + w'^2)) - 1 + "
       "log(2/(1 + sqrt(1 + 4*(x'^2 + y'^2 + z'^2 + w'^2)))))/2 - x*y",
       "-log(1 - p_x^2 - p_y^2 - p_z^2 - p_w^2)/2 + x*y",
       {0.3, -0.8, 0.1, 0.6},
       {0.7, 0.4, -1.2, 0.2},
       false},
      // x' y' = s/(1 − s)² with s = p_x p_y: H_pp has a diagonal of zeros at p = 0.
      {"indefinite, not quadratic",
       {"x", "y"},
       {},
       "sqrt(1 + 4*x'*y') - 1 + log(2/(1 + sqrt(1 + 4*x'*y'))) - x^2",
       "-log(1 - p_x*p_y) + x^2",
       {0.3, -0.8},
       {0.7, 0.4},
       false},
  };
  return all;
}

void expect_near(const Numbers& found, const Numbers& expected, const char* what, const char* name) {
  ASSERT_EQ(found.size(), expected.size()) << name;
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k], expected[k], 4e-15 * std::max(1.0, std::abs(expected[k])))
        << name << ' ' << what << k;
}

TEST(Hamiltonian, HasTheDerivativesOfItsLagrangian) {
  for (const Pair& pair : pairs()) {
    const System l = pair.of_lagrangian(), h = pair.of_hamiltonian();
    EXPECT_EQ(hamiltonian_of(*h.lagrangian) == nullptr, pair.expression) << pair.name;
    Scratch scratch;
    const PointValues a = evaluate_at(*l.lagrangian, pair.q, pair.v, 0.4, Order::hessian, scratch),
                      b = evaluate_at(*h.lagrangian, pair.q, pair.v, 0.4, Order::hessian, scratch);
    expect_near({b.value}, {a.value}, "L", pair.name);
    expect_near(b.dq, a.dq, "L_q", pair.name);
    expect_near(b.dv, a.dv, "L_v", pair.name);
    expect_near(b.qq, a.qq, "L_qq", pair.name);
    expect_near(b.vq, a.vq, "L_vq", pair.name);
    expect_near(b.vv, a.vv, "L_vv", pair.name);
    EXPECT_EQ(l.lagrangian->structure().autonomous, h.lagrangian->structure().autonomous) << pair.name;
    EXPECT_EQ(l.lagrangian->structure().quadratic, h.lagrangian->structure().quadratic) << pair.name;
    EXPECT_EQ(l.lagrangian->structure().frequencies, h.lagrangian->structure().frequencies) << pair.name;
  }
}

TEST(Hamiltonian, HasThemWith106Bits) {
  for (const Pair& pair : pairs()) {
    const System l = pair.of_lagrangian(), h = pair.of_hamiltonian();
    const std::vector<DoubleDouble> q(pair.q.begin(), pair.q.end()), v(pair.v.begin(), pair.v.end());
    PointScratch<DoubleDouble> scratch;
    const auto rows = [&](const Lagrangian& lagrangian) {
      std::vector<DoubleDouble> out(lagrangian.rows(Order::gradient));
      EXPECT_TRUE(lagrangian.evaluate_extended(q.data(), v.data(), DoubleDouble(0.4), out.data(), scratch));
      return out;
    };
    const std::vector<DoubleDouble> a = rows(*l.lagrangian), b = rows(*h.lagrangian);
    ASSERT_EQ(a.size(), b.size()) << pair.name;
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_LT(to_double(abs(a[k] - b[k])), 1e-29 * std::max(1.0, std::abs(to_double(a[k]))))
          << pair.name << ' ' << k;
  }
}

/// Of every parameter that the magnetic and the Lotka-Volterra cases have.
TEST(Hamiltonian, HasTheSlopesInParameters) {
  const auto rows = [](const SystemText& text) {
    const System system = compile(text);
    const int lanes = simd_lanes(), n = static_cast<int>(system.names.size());
    AlignedDoubles z;
    for (const double value : {0.3, -0.2, 0.7, 0.4})
      if (n == 2 || value > 0.25)
        for (int i = 0; i < lanes && z.size() < std::size_t(2 * n) * lanes; ++i) z.push_back(value);
    AlignedDoubles out(system.lagrangian->rows(Order::gradient) * lanes);
    Numbers found;
    Scratch scratch;
    system.lagrangian->sensitivity({lanes, lanes, z.data(), z.data() + n * lanes, nullptr}, 0, out.data(),
                                   scratch);
    for (std::size_t k = 0; k < out.size(); k += lanes) found.push_back(out[k]);
    return found;
  };
  const auto compare = [&](SystemText text, const std::string& lagrangian, const std::string& hamiltonian) {
    SystemText other = text;
    text.lagrangian = lagrangian;
    other.hamiltonian = hamiltonian;
    expect_near(rows(other), rows(text), "∂L/∂μ ", hamiltonian.c_str());
  };
  compare({.coordinates = {"x"}, .parameters = {{"r", {{1.5}}}}, .active = {"r"}},
          "(x' + r)*(log((x' + r)/r) - 1) - x^2*r", "r*exp(p_x) - r*p_x + x^2*r");
  compare({.coordinates = {"x"}, .parameters = {{"r", {{1.5}}}}, .active = {"r"}}, "r*x'^2/2 + r^2*x*x'",
          "(p_x - r^2*x)^2/(2*r)");
}

/// A quartic kinetic energy that couples two momenta and the coordinates, and no closed L.
const char* const quartic = "(p_x^2 + p_x*p_y + 2*p_y^2)*(1 + x^2)/2 + (p_x^2 + p_y^2)^2/4 + p_x*y - x*y^2";

TEST(LegendreLagrangian, SatisfiesTheLegendreRelations) {
  const System system = compile({.coordinates = {"x", "y"}, .hamiltonian = quartic});
  const Lagrangian* h = hamiltonian_of(*system.lagrangian);
  ASSERT_NE(h, nullptr);
  Scratch scratch;
  const Numbers q{0.3, -0.8};
  for (const double speed : {0.0, 1e-6, 0.5, 20.0, 1e4}) {
    const Numbers v{speed, -0.7 * speed};
    const PointValues l = evaluate_at(*system.lagrangian, q, v, 0, Order::hessian, scratch),
                      at = evaluate_at(*h, q, l.dv, 0, Order::hessian, scratch);
    for (int a = 0; a < 2; ++a) {
      EXPECT_NEAR(at.dv[a], v[a], 1e-14 * (1 + speed));
      EXPECT_EQ(at.dq[a], -l.dq[a]);
    }
    const double identity = l.vv[0] * at.vv[0] + l.vv[1] * at.vv[2];
    EXPECT_NEAR(identity, 1, 1e-13);
    EXPECT_EQ(l.vv[1], l.vv[2]);
  }
  // Second derivatives against differences of the first.
  const Numbers v{0.5, -0.3};
  const PointValues l = evaluate_at(*system.lagrangian, q, v, 0, Order::hessian, scratch);
  constexpr double step = 1e-5;
  for (int b = 0; b < 2; ++b) {
    const auto slope = [&](bool velocity, int a) {
      const auto moved = [&](double by) {
        Numbers x = q, y = v;
        (velocity ? y : x)[b] += by;
        return evaluate_at(*system.lagrangian, x, y, 0, Order::gradient, scratch);
      };
      const PointValues above = moved(step), below = moved(-step);
      return std::pair((above.dq[a] - below.dq[a]) / (2 * step), (above.dv[a] - below.dv[a]) / (2 * step));
    };
    for (int a = 0; a < 2; ++a) {
      EXPECT_NEAR(slope(false, a).first, l.qq[2 * a + b], 1e-9);
      EXPECT_NEAR(slope(false, a).second, l.vq[2 * a + b], 1e-9);
      EXPECT_NEAR(slope(true, a).second, l.vv[2 * a + b], 1e-9);
    }
  }
}

TEST(LegendreLagrangian, IsNoNumberOutsideTheRangeOfVelocities) {
  const System system = compile({.coordinates = {"x"}, .hamiltonian = "sqrt(1 + p_x^4/(1 + p_x^2)) + x^2"});
  ASSERT_NE(hamiltonian_of(*system.lagrangian), nullptr);
  Scratch scratch;
  const auto value = [&](double v) {
    return evaluate_at(*system.lagrangian, Numbers{0.3}, Numbers{v}, 0, Order::value, scratch).value;
  };
  EXPECT_TRUE(std::isfinite(value(0.9)));
  EXPECT_TRUE(std::isnan(value(1.5)));
  EXPECT_TRUE(std::isnan(value(std::numeric_limits<double>::quiet_NaN())));
}

/// A point has the same value whatever stands beside it in the batch.
TEST(LegendreLagrangian, DependsOnItsPointAlone) {
  const System system = compile({.coordinates = {"x", "y"}, .hamiltonian = quartic});
  const int lanes = simd_lanes(), count = 4 * lanes;
  AlignedDoubles rows(4 * count), out(count);
  for (int i = 0; i < count; ++i) {
    rows[i] = 0.1 * i;
    rows[count + i] = std::cos(i);
    rows[2 * count + i] = i % 3 == 0 ? 1e3 * i : 0.1 * i;
    rows[3 * count + i] = i % 5 == 0 ? std::numeric_limits<double>::quiet_NaN() : std::sin(i);
  }
  Scratch scratch;
  system.lagrangian->evaluate({count, count, rows.data(), rows.data() + 2 * count, nullptr}, Order::value,
                              out.data(), scratch);
  for (int i = 0; i < count; ++i) {
    const Numbers q{rows[i], rows[count + i]}, v{rows[2 * count + i], rows[3 * count + i]};
    const double alone = evaluate_at(*system.lagrangian, q, v, 0, Order::value, scratch).value;
    if (i % 5 == 0)
      EXPECT_TRUE(std::isnan(out[i]) && std::isnan(alone));
    else
      EXPECT_EQ(out[i], alone) << i;
  }
}

/// Sums of a Hamiltonian are sums of its Lagrangian.
TEST(Hamiltonian, KeepsSums) {
  const int n = 10000;
  const Parameters parameters{{"n", {{double(n)}}}};
  const System chain = compile({.coordinates = {"q[n]"},
                                .parameters = parameters,
                                .hamiltonian = "sum(i, 1, n, p_q[i]^2/(2*(1 + i/n))) + "
                                               "sum(i, 1, n - 1, (q[i+1] - q[i])^4/4)"});
  const auto* tape = dynamic_cast<const TapeLagrangian*>(chain.lagrangian.get());
  ASSERT_NE(tape, nullptr);
  EXPECT_TRUE(tape->structure().quadratic);
  EXPECT_TRUE(tape->structure().velocity_free);
  EXPECT_EQ(tape->structure().mass.size(), std::size_t(n));
  EXPECT_NEAR(tape->structure().mass[n / 2 - 1].value, 1.5, 1e-15);
  EXPECT_LT(tape->summary(Order::hessian).instructions, 60);
  const System heavy = compile({.coordinates = {"q[n]"},
                                .parameters = parameters,
                                .hamiltonian = "sum(i, 1, n, p_q[i]^2/(2 + q[i]^2) + sqrt(1 + p_q[i]^2)*0) + "
                                               "sum(i, 1, n - 1, p_q[i]*q[i+1])"});
  const auto* other = dynamic_cast<const TapeLagrangian*>(heavy.lagrangian.get());
  ASSERT_NE(other, nullptr);
  EXPECT_LT(other->summary(Order::hessian).instructions, 120);
}

/// Momenta that numbers couple: L has the inverse of the matrix.
TEST(Hamiltonian, InvertsConstantMatrices) {
  const System toda = compile({.coordinates = {"q[n]"},
                               .parameters = {{"n", {{12}}}},
                               .hamiltonian = "p_q[1]^2/2 + sum(i, 1, n - 1, (p_q[i+1] - p_q[i])^2/2)"});
  const Structure& s = toda.lagrangian->structure();
  ASSERT_TRUE(s.quadratic);
  for (const Triplet& m : s.mass)  // of the difference operator
    EXPECT_NEAR(m.value, 1 + std::min(m.row, m.column), 1e-11);
}

std::string refusal(const std::vector<std::string>& coordinates, const std::string& hamiltonian) {
  try {
    compile({.coordinates = coordinates, .hamiltonian = hamiltonian});
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

TEST(Hamiltonian, IsRefusedWhereItIsSingular) {
  const auto singular = [](const std::string& momenta) {
    return "H_pp is singular: the velocities do not determine " + momenta +
           "; the second derivative of the Hamiltonian by the momenta must be regular";
  };
  EXPECT_EQ(refusal({"x", "y"}, "p_x^2/2 + x*y"), singular("p_y"));
  EXPECT_EQ(refusal({"x", "y"}, "p_x^2/2 + x*p_y"), singular("p_y"));
  EXPECT_EQ(refusal({"x", "y"}, "(p_x + p_y)^2/2"), singular("p_x, p_y"));
  EXPECT_EQ(refusal({"x", "y"}, "cos(x)*(p_x + p_y)^2/2"), singular("p_x, p_y"));
  EXPECT_EQ(refusal({"x", "y"}, "sqrt(p_x^2 + p_y^2)"), singular("p_x, p_y"));  // of degree one
  EXPECT_EQ(refusal({"x"}, "exp(x)"), singular("p_x"));
  EXPECT_NE(refusal({"x"}, "p_x^2/2 + abs(p_x)").find("smooth"), std::string::npos);
  EXPECT_NE(refusal({"x"}, "sqrt(1 + p_x^4)*abs(x)").find("smooth"), std::string::npos);
  EXPECT_EQ(refusal({"x"}, "p_x^2/2 + abs(x)"), "");
  EXPECT_EQ(refusal({"x"}, "p_x^4 + p_x^2/2 + abs(x)"), "");
}

TEST(Hamiltonian, NamesAreThoseOfMomenta) {
  EXPECT_EQ(refusal({"x"}, "p_x^2/2 + x'"), "\"x'\" is a velocity; a hamiltonian has momenta: p_x");
  EXPECT_EQ(refusal({"q[2]"}, "p_q[1]^2/2 + q[1]'"),
            "\"q'\" is a velocity; a hamiltonian has momenta: p_q[1]");
  EXPECT_EQ(refusal({"x"}, "p_x^2/2 + p_y"),
            "unknown name 'p_y'; there is no coordinate 'y'; momenta are those of coordinates: p_x");
  EXPECT_EQ(refusal({"x"}, "p_x'"), "'p_x' is a momentum and has no velocity");
  EXPECT_EQ(refusal({"q[2]"}, "p_q^2"), "'p_q' has 2 elements; write p_q[1] … p_q[2]");
  EXPECT_EQ(refusal({"x", "p_x"}, "p_x^2"),
            "'p_x' is a coordinate already; choose another name for a momentum");
  try {
    compile({.coordinates = {"x"}, .lagrangian = "x'^2/2 + p_x"});
    FAIL();
  } catch (const FormulaError& e) {
    EXPECT_STREQ(e.what(), "unknown name 'p_x'; momenta stand in a hamiltonian; here are velocities: x'");
    EXPECT_EQ(e.where, "lagrangian");
    EXPECT_EQ(e.offset, 9u);
  }
}

TEST(Hamiltonian, DefinitionsHaveMomenta) {
  const System system = compile({.coordinates = {"x", "y"},
                                 .definitions = {{"kinetic", "(p_x^2 + p_y^2)/2"}, {"unused", "x'^2"}},
                                 .hamiltonian = "kinetic + x*y"});
  Scratch scratch;
  const PointValues l =
      evaluate_at(*system.lagrangian, Numbers{1, 2}, Numbers{3, 4}, 0, Order::value, scratch);
  EXPECT_EQ(l.value, 12.5 - 2);
}

}  // namespace
}  // namespace extremal
