#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "action/tables.hpp"
#include "analysis/flat_norm.hpp"
#include "analysis/motion_spectrum.hpp"
#include "common.hpp"
#include "system/tape.hpp"

namespace extremal::papers {

namespace {

using std::numbers::pi;

const std::vector<std::string> shown_schemes = {"rectangle", "midpoint",  "trapezoid",
                                                "linear",    "quadratic", "lobatto(3)"};

Spectrum lines(std::vector<SpectralLine> lines) { return {std::move(lines)}; }

std::shared_ptr<const Lagrangian> oscillator() {
  return trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2; });
}

/// L_d(u, w) = (a u² + c w²)/2 − b u w of an element, for the oscillator of frequency 1.
struct Discrete {
  double a, b, c;
};

/// The inner values are eliminated.
Discrete discrete(const std::string& name, double h) {
  const Scheme s = scheme(name);
  const SchemeTables tables(s, s.points);
  const int f = tables.functions;
  Eigen::MatrixXd k(f, f);
  for (int i = 0; i < f; ++i)
    for (int j = 0; j < f; ++j) {
      k(i, j) = tables.stiffness[i * f + j] / h;
      for (int p = 0; p < tables.points; ++p)
        k(i, j) -= h * tables.weight[p] * tables.value[p * f + i] * tables.value[p * f + j];
    }
  // The inner functions come first, then those of the start and of the end.
  const int inner = f - 2;
  Eigen::Matrix2d ends = k.bottomRightCorner<2, 2>();
  if (inner > 0) {
    const Eigen::MatrixXd sides = k.topRightCorner(inner, 2);
    ends -= sides.transpose() * k.topLeftCorner(inner, inner).ldlt().solve(sides);
  }
  return {ends(0, 0), -ends(0, 1), ends(1, 1)};
}

/// (1.11) and (1.12) of any scheme: u_1 = (p_0 + a u_0)/b and cos ω_h h = (a + c)/2b.
SpectralLine formula(const std::string& name, double h, double u, double p) {
  const auto [a, b, c] = discrete(name, h);
  const double cosine = (a + c) / (2 * b), next = (p + a * u) / b, sine = std::sqrt(1 - cosine * cosine);
  return {std::acos(cosine) / h, std::hypot(u, (u * cosine - next) / sine), 0};
}

SpectralLine measured(const Problem& problem, const Solution& solution) {
  return motion_spectrum(problem, solution.trajectory, Sampling::nodes, 1, 1e-9).coordinates[0].lines.at(0);
}

double distance(const Problem& problem, const Solution& solution, const std::vector<Spectrum>& exact) {
  double sum = 0;
  const int count = static_cast<int>(exact.front().lines.size());
  const MotionSpectrum found = motion_spectrum(problem, solution.trajectory, Sampling::nodes, count, 1e-12);
  for (std::size_t a = 0; a < exact.size(); ++a) {
    std::vector<PointMass> difference;
    for (const SpectralLine& line : found.coordinates[a].lines)
      difference.push_back({line.frequency, std::polar(line.amplitude, line.phase)});
    for (const SpectralLine& line : exact[a].lines)
      difference.push_back({line.frequency, -std::polar(line.amplitude, line.phase)});
    sum = std::max(sum, flat_norm(std::move(difference)));
  }
  return sum;
}

/// The oscillator, two coupled ones, and a pendulum that swings to ±2 asin k, with their lines.
struct Known {
  std::string name;
  std::shared_ptr<const Lagrangian> lagrangian;
  std::vector<Spectrum> lines;
  double duration;
};

std::vector<Known> known_motions() {
  const double slow = 1, fast = std::sqrt(1.74), k = 0.6, big = std::comp_ellint_1(k);
  const double nome = std::exp(-pi * std::comp_ellint_1(std::sqrt(1 - k * k)) / big);
  Spectrum swing;
  for (int n = 0; n < 6; ++n) {
    const double odd = 2 * n + 1;
    swing.lines.push_back({odd * pi / (2 * big),
                           8 * std::pow(nome, n + 0.5) / (odd * (1 + std::pow(nome, odd))),
                           odd * 0.7 - pi / 2});
  }
  return {{"oscillator", oscillator(), {lines({{1, 1, 0.7}})}, 60.3 * 2 * pi},
          {"two frequencies",
           trace(2,
                 [](auto q, auto v, auto) {
                   return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - q[1] * q[1] -
                           0.37 * (q[0] - q[1]) * (q[0] - q[1])) /
                          2;
                 }),
           {lines({{slow, 1, 0.4}, {fast, 0.3, -1.1}}), lines({{slow, 1, 0.4}, {fast, 0.3, pi - 1.1}})},
           60.3 * 2 * pi},
          {"pendulum",
           trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); }),
           {swing},
           60.3 * 4 * big}};
}

State sum_of(const std::vector<Spectrum>& spectra) {
  return [spectra](double t) {
    std::vector<double> q;
    for (const Spectrum& spectrum : spectra) {
      q.push_back(0);
      for (const SpectralLine& line : spectrum.lines)
        q.back() += line.amplitude * std::cos(line.frequency * t + line.phase);
    }
    return q;
  };
}

}  // namespace

Figure frequencies_and_amplitudes() {
  std::vector<Series> frequency, amplitude;
  const double duration = 60.3 * 2 * pi;
  const Problem problem = on_motion(oscillator(), sum_of({lines({{1, 1, 0.7}})}), duration);
  for (const std::string& name : shown_schemes) {
    Series w{.name = name, .x = {}, .measured = {}, .formula = {}}, a = w;
    for (int elements = 256; elements <= 4096; elements *= 2) {
      const double h = duration / elements;
      const Solution solution = solved(problem, name, elements);
      const double u = std::cos(0.7), p = solution.momentum_start[0], exact = std::hypot(u, p);
      const SpectralLine found = measured(problem, solution), told = formula(name, h, u, p);
      w.x.push_back(h);
      w.measured.push_back(std::abs(found.frequency - 1));
      w.formula.push_back(std::abs(told.frequency - 1));
      a.x.push_back(h);
      a.measured.push_back(std::abs(found.amplitude / exact - 1));
      a.formula.push_back(std::abs(told.amplitude / exact - 1));
    }
    frequency.push_back(std::move(w));
    amplitude.push_back(std::move(a));
  }
  Figure figure = side_by_side(
      "Discrete oscillator: lines as measured, dots, and by (1.10) to (1.12), curves", shown_schemes);
  figure.panels.push_back(decades("h ω₀", "|ω_h/ω₀ − 1|", frequency, left_box));
  figure.panels.push_back(decades("h ω₀", "||A_h|/|A₀| − 1|", amplitude, right_box));
  return figure;
}

Figure convergence_of_spectra() {
  const std::string schemes[] = {"linear", "quadratic"};
  std::vector<Series> series[2];
  std::vector<std::string> names;
  for (const Known& known : known_motions()) {
    const Problem problem = on_motion(known.lagrangian, sum_of(known.lines), known.duration);
    names.push_back(known.name + ":");
    for (int k = 0; k < 2; ++k) {
      Series s{.name = known.name, .x = {}, .measured = {}, .formula = {}};
      for (int elements = 2048; elements <= 32768; elements *= 2) {
        s.x.push_back(known.duration / elements);
        s.measured.push_back(distance(problem, solved(problem, schemes[k], elements), known.lines));
      }
      names.back() += fmt::format("{} {:.2f}", k > 0 ? "," : "", slope(s));
      series[k].push_back(std::move(s));
    }
  }
  Figure figure = side_by_side("Spectra converge in the flat norm, Corollary 4.8; with slopes", names);
  figure.panels.push_back(decades("h, linear", "flat norm of the difference", series[0], left_box));
  figure.panels.push_back(decades("h, quadratic", "flat norm of the difference", series[1], right_box));
  return figure;
}

}  // namespace extremal::papers
