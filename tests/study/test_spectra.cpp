#include "study/spectra.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "study/scenes.hpp"

/// \file Lines of solutions beside exact spectra, and of schemes beside the formulas of Müller and Ortiz.

using namespace extremal;
using namespace extremal::test;

namespace {

using Spectra = Scenes;
using std::numbers::pi;

Solution solved(const Study& study) {
  const Solution solution = run(study);
  EXPECT_TRUE(solution.converged()) << solution.message;
  return solution;
}

MotionSpectrum lines_of(const Study& study) {
  return spectrum_of(study, study.spectrum.value_or(SpectrumRequest{}), solved(study)).motion;
}

/// [boundary] with fixed ends of q(t) = cos(1.3 − t), as one who integrates from its state would have them.
std::string oscillator_by(double duration, const std::string& scheme, int elements) {
  return fmt::format(
      "[system]\ncoordinates = [\"q\"]\nlagrangian = \"(q'^2 - q^2)/2\"\n"
      "[boundary]\nstart = {{ q = \"cos(1.3)\" }}\nend = {{ q = \"cos(1.3 - {0:.17g})\" }}\n"
      "duration = {0:.17g}\n[solve]\nscheme = \"{1}\"\nelements = {2}\n[spectrum]\nlines = 1\n",
      duration, scheme, elements);
}

/// α and β of L_d(u, w) = α (u² + w²)/2 − β u w of an element of length h, whose trajectories are
/// u_k = Re A_h exp(i ω_h k h) with cos ω_h h = α/β.
struct Element {
  double alpha, beta;
};
Element element(const std::string& scheme, double h) {
  const double k = h * h;
  if (scheme == "midpoint") return {(1 - k / 4) / h, (1 + k / 4) / h};
  if (scheme == "trapezoid") return {(1 - k / 2) / h, 1 / h};
  if (scheme == "simpson" || scheme == "linear") return {(1 - k / 3) / h, (1 + k / 6) / h};
  // Both ends and the middle m: the middle is eliminated from h ∫ of exact products of quadratic functions.
  const double end = 7 / (3 * h) - 2 * h / 15, middle = 16 / (3 * h) - 8 * h / 15,
               side = -8 / (3 * h) - h / 15, across = 1 / (3 * h) + h / 30;
  return {end - side * side / middle, side * side / middle - across};
}

}  // namespace

/// (1.11) and its like: cos ω_h h = α/β. (1.12): −p_0 = −∂L_d/∂u_0 and u_0 tell A_h.
TEST_F(Spectra, OfSchemesHaveTheirFrequencyAndAmplitude) {
  constexpr int elements = 1100;
  const double duration = 100.7 * 2 * pi, h = duration / elements;
  for (const std::string name : {"midpoint", "trapezoid", "simpson", "linear", "quadratic"}) {
    const Study s = study(oscillator_by(duration, name, elements));
    const Solution solution = solved(s);
    const SpectralLine line = spectrum_of(s, *s.spectrum, solution).motion.coordinates[0].lines.at(0);
    const auto [alpha, beta] = element(name, h);
    const double omega = std::acos(alpha / beta) / h;
    const double u = std::cos(1.3), p = solution.momentum_start[0];
    const double amplitude = std::hypot(u, p / (beta * std::sin(omega * h)));
    const double phase = std::atan2(-p / (beta * std::sin(omega * h)), u);
    EXPECT_NEAR(line.frequency, omega, 1e-12) << name;
    EXPECT_NEAR(line.amplitude, amplitude, 1e-10) << name;
    EXPECT_NEAR(std::remainder(line.phase - phase, 2 * pi), 0, 1e-9) << name;
  }
}

/// (1.11): also with two elements and a bit a period, where the discrete trajectory is far from the motion.
TEST_F(Spectra, OfTheRectangleRuleAtCoarseSteps) {
  constexpr int elements = 400;
  const double h = 1.7;
  const Study s = study(oscillator_by(elements * h, "rectangle", elements));
  EXPECT_NEAR(lines_of(s).coordinates[0].lines.at(0).frequency, std::acos(1 - h * h / 2) / h, 1e-11);
}

/// Theorem 4.7 and (3.2): spectra converge in the flat norm with the order of the scheme.
TEST_F(Spectra, ConvergeInTheFlatNorm) {
  const auto distance = [&](int elements) {
    const SpectralLine line =
        lines_of(study(oscillator_by(60.3 * 2 * pi, "midpoint", elements))).coordinates[0].lines.at(0);
    return flat_norm({{line.frequency, line.amplitude}, {1, -1}});
  };
  EXPECT_NEAR(std::log2(distance(16000) / distance(32000)), 2, 0.05);
}

/// Two normal modes: 200 periods of the slow one, the ends known.
TEST_F(Spectra, OfTwoFrequencies) {
  const double slow = 1, fast = std::sqrt(1 + 2 * 0.37), duration = 2 * pi * 200.31;
  const auto x = [&](double t) { return std::cos(slow * t + 0.4) + 0.3 * std::cos(fast * t - 1.1); };
  const auto y = [&](double t) { return std::cos(slow * t + 0.4) - 0.3 * std::cos(fast * t - 1.1); };
  const Study s = study(
      fmt::format("[system]\ncoordinates = [\"x\", \"y\"]\nparameters = {{ c = 0.37 }}\n"
                  "lagrangian = \"(x'^2 + y'^2 - x^2 - y^2 - c*(x - y)^2)/2\"\n"
                  "[boundary]\nstart = {{ x = {:.17g}, y = {:.17g} }}\nend = {{ x = {:.17g}, y = {:.17g} }}\n"
                  "duration = {:.17g}\n[solve]\ntolerance = 1e-11\n",
                  x(0), y(0), x(duration), y(duration), duration));
  const MotionSpectrum found = lines_of(s);
  for (int a = 0; a < 2; ++a) {
    const std::vector<SpectralLine>& lines = found.coordinates[a].lines;
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_NEAR(lines[0].frequency, slow, 1e-11);
    EXPECT_NEAR(lines[0].amplitude, 1, 1e-9);
    EXPECT_NEAR(lines[0].phase, 0.4, 1e-8);
    EXPECT_NEAR(lines[1].frequency, fast, 1e-11);
    EXPECT_NEAR(lines[1].amplitude, 0.3, 1e-9);
    EXPECT_NEAR(std::remainder(lines[1].phase - (a == 0 ? -1.1 : pi - 1.1), 2 * pi), 0, 1e-8);
  }
}

/// A pendulum that swings to ±2 asin k: θ = Σ_n 8 r^{n+1/2}/((2n+1)(1 + r^{2n+1})) sin (2n+1)ωt with the nome
/// r = exp(−π K'/K) and ω = π/(2K).
TEST_F(Spectra, OfThePendulum) {
  const double k = 0.8, big = std::comp_ellint_1(k), other = std::comp_ellint_1(std::sqrt(1 - k * k));
  const double r = std::exp(-pi * other / big);
  const Study s = study(fmt::format(
      "[system]\ncoordinates = [\"q\"]\nlagrangian = \"q'^2/2 + cos(q)\"\n"
      "[boundary]\nperiodic = true\nduration = {:.17g}\n"
      "[guess]\nq = \"{:.17g}*sin(2*pi*t/T)\"\n[solve]\ntolerance = 1e-12\n[spectrum]\nlines = 5\n",
      4 * big, 2 * std::asin(k)));
  const MotionSpectrum found = lines_of(s);
  ASSERT_EQ(found.coordinates[0].lines.size(), 5u);
  for (int n = 0; n < 5; ++n) {
    const SpectralLine& line = found.coordinates[0].lines[n];
    EXPECT_NEAR(line.frequency, (2 * n + 1) * pi / (2 * big), 1e-12);
    EXPECT_NEAR(line.amplitude, 8 * std::pow(r, n + 0.5) / ((2 * n + 1) * (1 + std::pow(r, 2 * n + 1))),
                1e-11);
  }
  EXPECT_EQ(found.drift[0], 0);
}

/// Closed up to a turn: the mean velocity is taken away, and harmonics are left.
TEST_F(Spectra, OfARotation) {
  const Study s = study(
      "[system]\ncoordinates = [\"a\"]\nlagrangian = \"a'^2/2 + cos(a)\"\n"
      "[boundary]\nperiodic = true\nmap = { a = \"a + 2*pi\" }\nduration = 2.5\n"
      "[guess]\na = \"2*pi*t/T\"\n");
  const MotionSpectrum found = lines_of(s);
  EXPECT_NEAR(found.drift[0], 2 * pi / 2.5, 1e-13);
  for (const SpectralLine& line : found.coordinates[0].lines) {
    const double harmonic = line.frequency * 2.5 / (2 * pi);
    EXPECT_NEAR(harmonic, std::round(harmonic), 1e-12);
  }
}

/// From initial data: θ = 2 am(t/k) = Ω t + Σ 4 qⁿ/(n (1 + q²ⁿ)) sin n Ω t with Ω = π/(k K(k)), k² = 2/(E +
/// 1) and the nome q = exp(−π K'/K).
TEST_F(Spectra, OfAMotionThatTurnsOver) {
  const double energy = 1.8, k = std::sqrt(2 / (energy + 1)), K = std::comp_ellint_1(k);
  const double omega = pi / (k * K), nome = std::exp(-pi * std::comp_ellint_1(std::sqrt(1 - k * k)) / K);
  const MotionSpectrum found = lines_of(
      study(fmt::format("[system]\ncoordinates = [\"a\"]\nlagrangian = \"a'^2/2 + cos(a)\"\n[boundary]\n"
                        "start = {{ a = 0, p_a = {:.17g} }}\nduration = 300\n[solve]\ntolerance = 1e-11\n"
                        "[spectrum]\nlines = 4\n",
                        std::sqrt(2 * (energy + 1)))));
  EXPECT_NEAR(found.drift[0], omega, 1e-10);
  ASSERT_GE(found.coordinates[0].lines.size(), 3u);
  for (const SpectralLine& line : found.coordinates[0].lines) {
    const double n = std::round(line.frequency / omega);
    if (n == 0) continue;
    EXPECT_NEAR(line.frequency, n * omega, 1e-9);
    EXPECT_NEAR(line.amplitude, 4 * std::pow(nome, n) / (n * (1 + std::pow(nome, 2 * n))), 1e-8);
  }
}

/// A constant, a drift and a line that does not turn are near half an oscillation: it is told that they leave
/// something. Of a free motion the drift leaves nothing.
TEST_F(Spectra, OfArcsThatAreTooShort) {
  const auto told = [&](const std::string& lagrangian, double duration) {
    const Study arc =
        study(fmt::format("[system]\ncoordinates = [\"x\"]\nlagrangian = \"{}\"\n[boundary]\n"
                         "start = {{ x = 1, p_x = 0.5 }}\nduration = {}\n[spectrum]\n",
                         lagrangian, duration));
    return unresolved_lines(arc, spectrum_of(arc, *arc.spectrum, solved(arc)), duration);
  };
  for (const double duration : {0.1, 0.5, 1.0, 3.0})
    EXPECT_NE(told("x'^2/2 - x^2/2", duration).find("too short an arc"), std::string::npos) << duration;
  EXPECT_EQ(told("x'^2/2 - x^2/2", 30), "");
  EXPECT_EQ(told("x'^2/2", 3), "");
}

TEST_F(Spectra, AgainstAnother) {
  write("other.json", R"({"spectrum": {"q": [{"frequency": 1.25, "amplitude": 1, "phase": 0}]}})");
  const Study s = study(oscillator_by(60.3 * 2 * pi, "quadratic", 8000) + "against = \"other.json\"\n");
  EXPECT_NEAR(spectrum_of(s, *s.spectrum, solved(s)).flat_norm.at(0), 0.25, 1e-5);
}

TEST_F(Spectra, Refusals) {
  const std::string scene = oscillator_by(10, "midpoint", 20) + "against = \"other.json\"\n";
  write("other.json", "{\"samples\": {}}");
  EXPECT_EQ(message(scene),
            "other.json: this result has no spectrum; write one with extremal spectrum SCENE --output FILE");
  write("other.json", R"({"spectrum": {"p": []}})");
  EXPECT_EQ(message(scene), "other.json: the spectrum has no lines of 'q'");
  write("other.json", R"({"spectrum": {"q": [{"frequency": 1}]}})");
  EXPECT_EQ(message(scene), "other.json: a line of the spectrum has no number 'amplitude'");
  EXPECT_EQ(message(oscillator_by(10, "midpoint", 20), {"spectrum.lines=0"}),
            "--set spectrum.lines: lines = 0; need 1 to 1000");
}

/// H = p_x y − p_y x turns the plane: x = cos t, y = −sin t. Lines are those of the coordinates, not of
/// momenta.
TEST_F(Spectra, OfAHamiltonianLinearInMomenta) {
  const MotionSpectrum found = lines_of(study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nhamiltonian = \"p_x*y - p_y*x\"\n"
      "[boundary]\nstart = { x = 1, y = 0, p_x = 0.3, p_y = 0.7 }\nduration = 70\n[spectrum]\nlines = 1\n"));
  ASSERT_EQ(found.coordinates.size(), 2u);
  ASSERT_EQ(found.drift.size(), 2u);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_NEAR(found.coordinates[a].lines.at(0).frequency, 1, 1e-9);
    EXPECT_NEAR(found.coordinates[a].lines.at(0).amplitude, 1, 1e-8);
    EXPECT_NEAR(found.coordinates[a].lines.at(0).phase, a == 0 ? 0 : pi / 2, 1e-7);
  }
}
