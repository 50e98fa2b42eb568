#include <cmath>
#include <fstream>

#include "scenes.hpp"
#include "study/continued.hpp"

/// \file Scenes with a Hamiltonian against the same with its Lagrangian.

namespace extremal::test {
namespace {

class HamiltonianScenes : public Scenes {};

struct Twin {
  const char* name;
  std::string coordinates, lagrangian, hamiltonian, rest;
  double roundoff = 1e-12;  ///< relative, as the scene amplifies it
  std::string scene(bool hamiltonian_form) const {
    const std::string law =
        hamiltonian_form ? "hamiltonian = \"" + hamiltonian : "lagrangian = \"" + lagrangian;
    return "[system]\ncoordinates = [" + coordinates + "]\n" + law + "\"\n" + rest;
  }
};

std::string between(const std::string& start, const std::string& end, double duration) {
  return "[boundary]\nstart = { " + start + " }\nend = { " + end +
         " }\nduration = " + std::to_string(duration) + "\n";
}

std::vector<Twin> twins() {
  return {
      {"oscillator", "\"x\"", "x'^2/2 - x^2/2", "p_x^2/2 + x^2/2", between("x = 1", "x = 0.3", 2.5)},
      {"pendulum", "\"x\"", "x'^2/2 + cos(x)", "p_x^2/2 - cos(x)", between("x = 0", "x = 1.5", 2)},
      {"Kepler", "\"x\", \"y\"", "(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)",
       "(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)", between("x = 1, y = 0", "x = -0.6, y = 0.9", 2.5)},
      {"Hénon-Heiles", "\"x\", \"y\"", "(x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3",
       "(p_x^2 + p_y^2)/2 + (x^2 + y^2)/2 + x^2*y - y^3/3",
       between("x = 0.3, y = 0", "x = -0.1, y = 0.2", 1.5)},
      {"double pendulum", "\"a\", \"b\"", "a'^2 + b'^2/2 + a'*b'*cos(a - b) + 9.81*(2*cos(a) + cos(b))",
       "(p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2)) - 9.81*(2*cos(a) + cos(b))",
       between("a = 0.5, b = 0.5", "a = -0.2, b = -0.3", 0.8)},
      {"charge in a magnetic field", "\"x\", \"y\"", "(x'^2 + y'^2)/2 + (1 + x^2/4)*(x*y' - y*x')/2 - x^2*y",
       "((p_x + (1 + x^2/4)*y/2)^2 + (p_y - (1 + x^2/4)*x/2)^2)/2 + x^2*y",
       between("x = 0.3, y = -0.2", "x = 0.9, p_y = 0.1", 1.5)},
      {"FPUT chain", "\"q[8]\"",
       "sum(i, 1, 8, q[i]'^2/2) - sum(i, 1, 7, (q[i+1] - q[i])^2/2 + (q[i+1] - q[i])^3/12) - q[1]^2/2 - "
       "q[8]^2/2",
       "sum(i, 1, 8, p_q[i]^2/2) + sum(i, 1, 7, (q[i+1] - q[i])^2/2 + (q[i+1] - q[i])^3/12) + q[1]^2/2 + "
       "q[8]^2/2",
       between("q = \"sin(pi*i/9)\"", "q = \"0.2*sin(2*pi*i/9)\"", 1.5)},
      {"relativistic oscillator", "\"x\"", "-sqrt(1 - x'^2) - x^2/2", "sqrt(1 + p_x^2) + x^2/2",
       between("x = 1", "x = -0.6", 2.2)},
      {"Lotka-Volterra", "\"x\"", "(x' + 1)*(log(x' + 1) - 1) - exp(x) + x", "exp(p_x) - p_x + exp(x) - x",
       between("x = 0.5", "x = 0.8", 1.2)},
  };
}

/// Where hardly any prey is left, q' = exp(p) - 1 has no digits of p: such a path is none whose momenta are
/// known.
TEST_F(HamiltonianScenes, MomentaThatRoundoffHides) {
  const Solution s =
      run(study("[system]\ncoordinates = [\"y\"]\nhamiltonian = \"exp(p_y) - p_y + exp(y) - y\"\n"
                "[boundary]\nstart = { y = 0.8170772466716945 }\nend = { y = -1.0206785999311254 }\n"
                "duration = 28.5660967111268\n[guess]\ny = \"0.8170772466716945 - 1.8377558466028199*t/T + "
                "0.23229036435052697*sin(3*pi*t/T)\"\n"));
  if (s.converged()) {
    EXPECT_LT(*s.energy_drift, 1e-7 * std::abs(*s.energy)) << s.message;
  }
}

void expect_equal(const Solution& l, const Solution& h, const std::string& what, double roundoff) {
  ASSERT_TRUE(l.converged() && h.converged()) << what << ": " << l.message << " / " << h.message;
  const auto near = [&](double a, double b, double size) {
    EXPECT_NEAR(a, b, roundoff * std::max(1.0, size)) << what;
  };
  near(l.action, h.action, std::abs(l.action));
  EXPECT_EQ(l.morse_index, h.morse_index) << what;
  EXPECT_EQ(l.nullity, h.nullity) << what;
  EXPECT_EQ(l.windows.size(), h.windows.size()) << what;
  ASSERT_EQ(l.trajectory.nodes.size(), h.trajectory.nodes.size()) << what;
  for (std::size_t k = 0; k < l.trajectory.nodes.size(); ++k)
    near(l.trajectory.nodes[k], h.trajectory.nodes[k], 1);
  for (std::size_t a = 0; a < l.momentum_start.size(); ++a) {
    near(l.momentum_start[a], h.momentum_start[a], std::abs(l.momentum_start[a]));
    near(l.momentum_end[a], h.momentum_end[a], std::abs(l.momentum_end[a]));
  }
  if (l.energy) near(*l.energy, h.energy.value(), std::abs(*l.energy));
}

TEST_F(HamiltonianScenes, EqualTheirLagrangianSchemeByScheme) {
  for (const Twin& twin : twins()) {
    Study l = study(twin.scene(false)), h = study(twin.scene(true));
    for (const char* name : {"rectangle", "rectangle-right", "midpoint", "trapezoid", "simpson", "linear",
                             "quadratic", "lobatto(2)", "lobatto(4)", "gauss(2)", "gauss(3)"}) {
      l.options.scheme = h.options.scheme = scheme(name);
      l.options.elements = h.options.elements = 24;
      expect_equal(run(l), run(h), std::string(twin.name) + ", " + name, twin.roundoff);
    }
  }
}

TEST_F(HamiltonianScenes, EqualTheirLagrangianWithinATolerance) {
  for (const Twin& twin : twins()) {
    const std::vector<std::string> sets{"solve.tolerance=1e-11"};
    expect_equal(run(study(twin.scene(false), sets)), run(study(twin.scene(true), sets)), twin.name,
                 10 * twin.roundoff);
  }
}

/// Of a Hamiltonian that is solved at each point, by the momentum at the start.
TEST_F(HamiltonianScenes, HaveTheOrderOfTheirScheme) {
  Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\n"
      "definitions = { s = \"p_x^2 + p_x*p_y/2 + p_y^2\" }\n"
      "hamiltonian = \"s*(1 + x^2/4)/2 + s^2/16 + (x*p_y - y*p_x)/4 + x^2*y\"\n" +
      between("x = 0.3, y = -0.2", "x = 0.9, y = 0.5", 0.8));
  s.options.tolerance = 1e-13;
  const double truth = run(s).momentum_start[0];
  const auto error = [&](const Scheme& scheme, int elements) {
    s.options.scheme = scheme;
    s.options.elements = elements;
    const Solution solution = run(s);
    EXPECT_TRUE(solution.converged()) << scheme.name << ": " << solution.message;
    return std::abs(solution.momentum_start[0] - truth);
  };
  for (const char* name : {"rectangle", "rectangle-right", "midpoint", "trapezoid", "simpson", "linear",
                           "quadratic", "lobatto(2)", "lobatto(3)", "gauss(2)", "gauss(3)"}) {
    const Scheme tested = scheme(name);
    const int elements = tested.order == 1 ? 160 : tested.order == 2 ? 40 : tested.order == 4 ? 8 : 4;
    EXPECT_NEAR(std::log2(error(tested, elements) / error(tested, 2 * elements)), tested.order,
                0.1 * tested.order)
        << name;
  }
}

/// x = cos(t) of amplitude 2, by its momentum at both ends.
TEST_F(HamiltonianScenes, MomentaAtTheEnds) {
  const Solution s = run(study("[system]\ncoordinates = [\"x\"]\nhamiltonian = \"p_x^2/2 + x^2/2\"\n" +
                               between("p_x = 0.5", "p_x = -1.5", 1)));
  ASSERT_TRUE(s.converged()) << s.message;
  // x = a cos t + b sin t: p(0) = b, p(1) = −a sin 1 + b cos 1.
  const double b = 0.5, a = (b * std::cos(1) + 1.5) / std::sin(1);
  std::vector<double> q(1), v(1);
  s.trajectory.at(0.4, q, v);
  EXPECT_NEAR(q[0], a * std::cos(0.4) + b * std::sin(0.4), 1e-9);
  EXPECT_NEAR(s.momentum_start[0], 0.5, 1e-9);
  EXPECT_NEAR(s.momentum_end[0], -1.5, 1e-9);
}

const std::string loop =
    "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.1\n"
    "[guess]\nx = \"0.35*sin(2*pi*t/T)\"\ny = \"0.05*cos(4*pi*t/T)\"\nduration = 6.3\n";

TEST_F(HamiltonianScenes, OrbitsAndTheirMultipliers) {
  const std::vector<Twin> orbits{
      {"Hénon-Heiles", "\"x\", \"y\"", "(x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3",
       "(p_x^2 + p_y^2)/2 + (x^2 + y^2)/2 + x^2*y - y^3/3", loop},
      {"relativistic, in two dimensions", "\"x\", \"y\"", "1 - sqrt(1 - x'^2 - y'^2) - x^2/2 - y^2",
       "sqrt(1 + p_x^2 + p_y^2) - 1 + x^2/2 + y^2", loop},
      {"with a quartic mass", "\"x\"", "0", "p_x^2/2 + p_x^4/4 + x^2/2",
       "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.5\n"
       "[guess]\nx = \"sin(2*pi*t/T)\"\nduration = 5.5\n"}};
  for (const Twin& twin : orbits) {
    const Solution h = run(study(twin.scene(true)));
    ASSERT_TRUE(h.converged()) << twin.name << ": " << h.message;
    ASSERT_TRUE(h.floquet) << twin.name;
    std::complex<double> product = 1;
    for (const auto& multiplier : h.floquet->multipliers) product *= multiplier;
    EXPECT_NEAR(std::abs(product - 1.0), 0, 1e-9) << twin.name;
    if (twin.lagrangian == "0") continue;
    const Solution l = run(study(twin.scene(false)));
    ASSERT_TRUE(l.converged() && l.floquet) << twin.name << ": " << l.message;
    EXPECT_NEAR(l.duration(), h.duration(), 1e-10);
    EXPECT_NEAR(l.action, h.action, 1e-10);
    ASSERT_EQ(l.floquet->multipliers.size(), h.floquet->multipliers.size());
    for (std::size_t k = 0; k < l.floquet->multipliers.size(); ++k)
      EXPECT_NEAR(std::abs(l.floquet->multipliers[k] - h.floquet->multipliers[k]), 0, 1e-7) << twin.name;
  }
}

/// A Duffing orbit beside an oscillator of negative mass, which its multipliers show: exp(±iωT).
TEST_F(HamiltonianScenes, MultipliersWhereTheMassIsIndefinite) {
  const Solution s =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\n"
                "hamiltonian = \"p_x^2/2 + x^2/2 + x^4/4 - p_y^2/2 - 1.3*y^2\"\n"
                "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.5\n"
                "[guess]\nx = \"0.85*sin(2*pi*t/T)\"\ny = \"0\"\nduration = 5\n"));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_FALSE(s.morse_index);
  ASSERT_TRUE(s.floquet) << s.message;
  ASSERT_EQ(s.floquet->multipliers.size(), 4u);
  const std::complex<double> expected = std::polar(1.0, std::sqrt(2.6) * s.duration());
  double nearest = 1, trivial = 0;
  for (const std::complex<double>& multiplier : s.floquet->multipliers) {
    nearest = std::min(nearest, std::abs(multiplier - expected));
    trivial += std::abs(multiplier - 1.0) < 1e-6;
  }
  EXPECT_LT(nearest, 1e-8);
  EXPECT_EQ(trivial, 2);
}

TEST_F(HamiltonianScenes, HaveFamilies) {
  const Twin twin{"Hénon-Heiles", "\"x\", \"y\"", "(x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3",
                  "(p_x^2 + p_y^2)/2 + (x^2 + y^2)/2 + x^2*y - y^3/3",
                  loop + "[continuation]\nparameter = \"energy\"\nto = 0.12\npoints = 8\n"};
  const auto family = [&](bool hamiltonian) {
    const Study s = study(twin.scene(hamiltonian));
    return follow(s);
  };
  const auto l = family(false), h = family(true);
  ASSERT_EQ(l.points.size(), h.points.size());
  for (std::size_t k = 0; k < l.points.size(); ++k) {
    EXPECT_NEAR(l.points[k].parameter, h.points[k].parameter, 1e-9);
    EXPECT_NEAR(l.points[k].solution.duration(), h.points[k].solution.duration(), 1e-8);
    EXPECT_NEAR(l.points[k].solution.action, h.points[k].solution.action, 1e-8);
  }
}

TEST_F(HamiltonianScenes, HaveNoIndexWhereTheMassIsIndefinite) {
  const Solution s = run(study("[system]\ncoordinates = [\"x\", \"y\"]\nhamiltonian = \"p_x*p_y + x*y\"\n" +
                               between("x = 1, y = 0", "x = 0.5, y = 0.2", 1)));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_FALSE(s.morse_index);
  EXPECT_FALSE(s.minimizing);
  std::vector<double> q(2), v(2);
  s.trajectory.at(0.5, q, v);  // x'' = −x, y'' = −y
  EXPECT_NEAR(q[0], (std::sin(0.5) * 1 + std::sin(0.5) * 0.5) / std::sin(1), 1e-9);
}

TEST_F(HamiltonianScenes, ReplaceTheLawOfASystemFile) {
  write("own.toml",
        "[system]\ncoordinates = [\"x\"]\ndefinitions = { potential = \"x^2/2\" }\n"
        "lagrangian = \"x'^2/2 - potential\"\n");
  write("other.toml",
        "[system]\ncoordinates = [\"x\"]\ndefinitions = { kinetic = \"p_x^2/2\", potential = \"x^2/2\" }\n"
        "hamiltonian = \"kinetic + potential\"\n");
  const std::string at_ends = between("x = 1", "x = 0.5", 1);
  const auto action = [&](const std::string& system) {
    return run(study("[system]\n" + system + "\n" + at_ends)).action;
  };
  const double expected = action("use = \"own\"");
  EXPECT_NEAR(action("use = \"own\"\nhamiltonian = \"p_x^2/2 + potential\""), expected, 1e-12);
  EXPECT_NEAR(action("use = \"other\""), expected, 1e-12);
  EXPECT_NEAR(action("use = \"other\"\nhamiltonian = \"2*kinetic + potential\""),
              action("use = \"other\"\nlagrangian = \"x'^2/4 - potential\""), 1e-12);
}

TEST_F(HamiltonianScenes, BadOnesAreRefusedWithTheirPlace) {
  const auto with = [&](const std::string& law) {
    return message("[system]\ncoordinates = [\"x\"]\n" + law + "\n" + between("x = 0", "x = 1", 2));
  };
  EXPECT_EQ(with("hamiltonian = \"p_x^2/2 + x'\""),
            "scene.toml:3:26: \"x'\" is a velocity; a hamiltonian has momenta: p_x");
  EXPECT_EQ(
      with("hamiltonian = \"p_x^2/2 + p_y\""),
      "scene.toml:3:26: unknown name 'p_y'; there is no coordinate 'y'; momenta are those of coordinates: "
      "p_x");
  EXPECT_EQ(
      with("hamiltonian = \"p_x^2/2\"\nlagrangian = \"x'^2/2\""),
      "scene.toml:4:1: 'lagrangian' and 'hamiltonian' exclude each other: either of them is the law of the "
      "system; leave one out");
  EXPECT_EQ(
      with(""),
      "scene.toml:1:1: [system] has no 'lagrangian'; write one, or a 'hamiltonian', or name a system by "
      "'use'");
  EXPECT_EQ(with("hamiltonian = \"\"").rfind("scene.toml:3:16: ", 0), 0u);
  // In phase space.
  EXPECT_EQ(with("hamiltonian = \"x*p_x\""), "");
  EXPECT_EQ(with("hamiltonian = \"exp(log(p_x^2)/2)\""), "");  // |p|
  EXPECT_EQ(with("hamiltonian = \"1 - cos(p_x)\""), "");
  EXPECT_NE(with("hamiltonian = \"p_x^2/2 + max(0, p_x)\"").find("smooth"), std::string::npos);
}

/// One element of H = p²/(2(1 + x²)) + x² p − cos x, whose L is (1 + x²)(v − x²)²/2 + cos x.
class OneElement : public Scenes {
 protected:
  const double h = 0.3, q0 = 0.4, q1 = 0.5;

  Solution solved(const std::string& name) {
    Study s =
        study("[system]\ncoordinates = [\"x\"]\nhamiltonian = \"p_x^2/(2*(1 + x^2)) + x^2*p_x - cos(x)\"\n" +
              between("x = 0.4", "x = 0.5", h));
    s.options.scheme = scheme(name);
    s.options.elements = 1;
    return run(s);
  }
  void expect_momenta(const std::string& name, double p0, double p1) {
    const Solution s = solved(name);
    ASSERT_TRUE(s.converged()) << name << ": " << s.message;
    EXPECT_NEAR(s.momentum_start[0], p0, 1e-15) << name;
    EXPECT_NEAR(s.momentum_end[0], p1, 1e-15) << name;
  }
  /// The momentum of the discrete embedding, p = ∂L/∂v, and f = ∂L/∂q.
  static double p(double q, double v) { return (1 + q * q) * (v - q * q); }
  static double f(double q, double v) {
    const double u = v - q * q;
    return q * u * u - 2 * q * (1 + q * q) * u - std::sin(q);
  }
  /// q' and p' of the Hamiltonian flow.
  static std::pair<double, double> flow(double q, double p) {
    const double m = 1 + q * q;
    return {p / m + q * q, p * p * q / (m * m) - 2 * q * p - std::sin(q)};
  }
};

/// Cresson-Safi's Θ takes the momentum p = ∂L/∂v(q, Δ₊q) of the discrete embedding to that of Marsden and
/// West, −∂L_d/∂q_0 = p_0 − h ∂L/∂q(q_0, v_0); and its like for other rules, from −D₁L_d = −Σ b_i (φ_0' p_i +
/// h φ_0 f_i).
TEST_F(OneElement, ThetaRelatesTheTwoMomenta) {
  const double v = (q1 - q0) / h, m = (q0 + q1) / 2, mean = (p(q0, v) + p(q1, v)) / 2;
  expect_momenta("rectangle", p(q0, v) - h * f(q0, v), p(q0, v));
  expect_momenta("rectangle-right", p(q1, v), p(q1, v) + h * f(q1, v));
  expect_momenta("midpoint", p(m, v) - h * f(m, v) / 2, p(m, v) + h * f(m, v) / 2);
  for (const char* name : {"trapezoid", "lobatto(1)"})
    expect_momenta(name, mean - h * f(q0, v) / 2, mean + h * f(q1, v) / 2);
  const double x = solved("lobatto(2)").trajectory.nodes[1];
  const double va = (-3 * q0 + 4 * x - q1) / h, vb = (q1 - q0) / h, vc = (q0 - 4 * x + 3 * q1) / h;
  const double pa = p(q0, va), pb = p(x, vb), pc = p(q1, vc);
  expect_momenta("lobatto(2)", pa / 2 + 2 * pb / 3 - pc / 6 - h * f(q0, va) / 6,
                 -pa / 6 + 2 * pb / 3 + pc / 2 + h * f(q1, vc) / 6);
}

/// The step (q0, p0) → (q1, p1) of Gauss's symplectic Runge-Kutta method and of Cresson-Safi (16), Euler's
/// symplectic methods: the discrete action in phase space is their generating function.
TEST_F(OneElement, IsAStepOfSymplecticMethods) {
  const auto runge_kutta = [&](const std::vector<std::vector<double>>& a, const std::vector<double>& b,
                               double p0) {
    const std::size_t stages = b.size();
    std::vector<std::pair<double, double>> k(stages);
    for (int pass = 0; pass < 200; ++pass)
      for (std::size_t i = 0; i < stages; ++i) {
        double q = q0, p = p0;
        for (std::size_t j = 0; j < stages; ++j)
          q += h * a[i][j] * k[j].first, p += h * a[i][j] * k[j].second;
        k[i] = flow(q, p);
      }
    std::pair<double, double> end(q0, p0);
    for (std::size_t i = 0; i < stages; ++i)
      end.first += h * b[i] * k[i].first, end.second += h * b[i] * k[i].second;
    return end;
  };
  const double root = std::sqrt(3.0) / 6;
  const Solution one = solved("gauss(1)"), two = solved("gauss(2)");
  const auto of_one = runge_kutta({{0.5}}, {1}, one.momentum_start[0]);
  EXPECT_NEAR(of_one.first, q1, 1e-15);
  EXPECT_NEAR(of_one.second, one.momentum_end[0], 1e-15);
  const auto of_two =
      runge_kutta({{0.25, 0.25 - root}, {0.25 + root, 0.25}}, {0.5, 0.5}, two.momentum_start[0]);
  EXPECT_NEAR(of_two.first, q1, 1e-15);
  EXPECT_NEAR(of_two.second, two.momentum_end[0], 1e-15);
  // (16): Δ₊q = H_p(q_k, p_k), Δ₋p = −H_q(q_k, p_k), with p_k that of the embedding; Marsden and West's p_k
  // is then p_{k−1}.
  const Solution left = solved("rectangle"), right = solved("rectangle-right");
  const double p0 = left.momentum_start[0], p1 = left.momentum_end[0];
  EXPECT_NEAR(q0 + h * flow(q0, p1).first, q1, 1e-15);
  EXPECT_NEAR(p0 + h * flow(q0, p1).second, p1, 1e-15);
  const double r0 = right.momentum_start[0], r1 = right.momentum_end[0];
  EXPECT_NEAR(q0 + h * flow(q1, r0).first, q1, 1e-15);
  EXPECT_NEAR(r0 + h * flow(q1, r0).second, r1, 1e-15);
}

/// |∂H/∂p| < 1.
TEST_F(Scenes, VelocitiesOutOfReachOfMomentaAreNamed) {
  const std::string text = message(
      "[system]\ncoordinates = [\"q\"]\nhamiltonian = \"sqrt(1 + p_q^2) + q^2/2\"\n[boundary]\n"
      "start = { q = 0 }\nend = { q = 1 }\nduration = 2\n[guess]\nq = \"t/T + 2*sin(pi*t/T)\"\n");
  EXPECT_NE(text.find("q' = 3.64"), std::string::npos) << text;
}

}  // namespace
}  // namespace extremal::test
