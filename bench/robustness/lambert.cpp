#include "lambert.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random.hpp"
#include "systems.hpp"

namespace bench {
namespace {

using std::numbers::pi;

constexpr int most_revolutions = 2, grid = 20000;
/// Two arcs whose energies differ less, relative to the largest, are told apart by no result.
constexpr double same_energy = 1e-6;

/// Lagrange's equation for the duration (Izzo, Revisiting Lambert's problem, Celest. Mech. Dyn. Astron. 121,
/// 2015, eq. 18 and 9): with 2s the perimeter, λ² = 1 − c/s, u = 1 − x² and y² = 1 − λ²u,
///   T √(2/s³) = (ψ + Nπ)/u^(3/2) − (x − λy)/u,  cos ψ = xy + λu;  energy −u/s.
struct Lambert {
  double s, lambda, duration;
  int revolutions;

  double excess(double x) const {
    const double u = 1 - x * x, y = std::sqrt(1 - lambda * lambda * u);
    const double psi = std::acos(std::clamp(x * y + lambda * u, -1.0, 1.0));
    return (psi + revolutions * pi) / std::pow(u, 1.5) - (x - lambda * y) / u -
           duration * std::sqrt(2 / (s * s * s));
  }

  void add_energies(std::vector<double>& energies) const {
    for (int i = 1; i + 1 < grid; ++i) {
      double a = -std::cos(pi * i / grid), b = -std::cos(pi * (i + 1) / grid);
      const double first = excess(a);
      if (!(first * excess(b) < 0)) continue;
      for (int step = 0; step < 100; ++step) {
        const double middle = 0.5 * (a + b);
        (excess(middle) * first > 0 ? a : b) = middle;
      }
      energies.push_back(-(1 - a * a) / s);
    }
  }
};

}  // namespace

std::vector<double> lambert_energies(double r, double angle, double duration, int revolutions) {
  const double chord = std::sqrt(1 + r * r - 2 * r * std::cos(angle)), s = (1 + r + chord) / 2;
  std::vector<double> energies;
  for (int k = 0; k <= revolutions; ++k)
    for (const double side : {1.0, -1.0})
      Lambert{s, side * std::sqrt(1 - chord / s), duration, k}.add_energies(energies);
  return energies;
}

std::vector<LambertProblem> lambert_problems(int count) {
  const auto kepler = system("kepler");
  Random random(5);
  std::vector<LambertProblem> result;
  for (int k = 0; k < count; ++k) {
    const double r = random.between(0.5, 2), angle = random.between(0.3, 2 * pi - 0.3),
                 duration = random.between(3, 25);
    result.push_back({fixed_ends(kepler, {1, 0}, {r * std::cos(angle), r * std::sin(angle)}, duration),
                      lambert_energies(r, angle, duration, most_revolutions)});
  }
  return result;
}

int arcs_found(const std::vector<double>& wanted, std::vector<double> found) {
  int count = 0;
  double largest = 0;
  for (double energy : wanted) largest = std::max(largest, std::abs(energy));
  for (double energy : wanted) {
    const auto it = std::find_if(found.begin(), found.end(), [&](double other) {
      return std::abs(other - energy) < same_energy * largest;
    });
    if (it == found.end()) continue;
    found.erase(it);
    ++count;
  }
  return count;
}

}  // namespace bench
