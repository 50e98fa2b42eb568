#include "hard_problems.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "lambert.hpp"

namespace bench {
namespace {

using std::numbers::pi;
using std::numbers::sqrt2;

const std::string own = "bench/robustness/scenes/", shipped = "problems/scenes/";

std::string duration(double T) { return fmt::format("boundary.duration={:.1f}", T); }

/// Minimisers in long intervals, from the straight line.
HardGroup minimisers() {
  HardGroup group{"minimisers of any length", {}};
  const auto add = [&](const char* title, const std::string& scene, double T, std::optional<double> action,
                       int wanted = 1) {
    group.problems.push_back({.title = fmt::format("{}, T = {:g}", title, T),
                              .scene = scene,
                              .sets = {duration(T)},
                              .action = action,
                              .wanted = wanted});
  };
  for (const double T : {20, 30, 100, 1000})
    add("kink of a double well", own + "kink.toml", T, 2 * sqrt2 / 3);
  for (const double T : {30, 60, 500}) add("kink of sine-Gordon", own + "sine-gordon.toml", T, 8 - T);
  // In a short time ∫ √(b² + 2E) du + 1/4 − E T with ∫ du/√(b² + 2E) = T, b = u − u³, by quadrature.
  for (const auto& [T, action] :
       {std::pair(12.0, 0.50000016872650062), {15.0, 0.50000000309154295}, {40.0, 0.5}, {100.0, 0.5}})
    add("against the drift", own + "against-the-drift.toml", T, action);
  // By quadrature at the energy, or at that of the lower well.
  for (const auto& [T, action] : {std::pair(100.0, 0.00765007826860316), {200.0, 0.00765000000006518}})
    add("drift with a rest in between", own + "weak-drift.toml", T, action);
  add("between two wells", own + "between-wells.toml", 1e4, 4.0 / 3);
  add("tilted double well", own + "tilted-well.toml", 1e4, -1010.6164511210920);
  // By minimisation in intervals of 60 to 200. In an interval of 12 the action differs from it.
  constexpr double escape = 0.34004140333;
  for (const double T : {12, 30, 100})
    add("Maier-Stein", shipped + "maier-stein.toml", T, T < 20 ? std::nullopt : std::optional(escape), 2);
  group.problems.push_back({.title = "chain of 32 double wells, T = 200",
                            .scene = shipped + "double-well-chain.toml",
                            .sets = {"system.parameters.n=32", duration(200)},
                            .action = 32 * 2 * sqrt2 / 3});
  // Clairaut's relation, by quadrature: half the square of the length.
  group.problems.push_back({.title = "paraboloid, past its top on both sides",
                            .scene = own + "paraboloid.toml",
                            .action = 43.408113278414683,
                            .wanted = 2});
  return group;
}

/// Normal modes a: the action of an oscillation from a to b in T is ω ((a² + b²) cos ωT − 2ab)/(2 sin ωT).
double action_of_stiff_modes() {
  constexpr double slow = 1, fast = 1e8, k = 0.5, T = 10;
  // (slow + k) x − k y, (fast + k) y − k x. The squares of the frequencies and their sum are exact to
  // roundoff.
  const double half = (fast - slow) / 2, root = std::hypot(half, k), middle = (slow + fast) / 2 + k;
  const double angle = 0.5 * std::atan2(2 * k, fast - slow), c = std::cos(angle), s = std::sin(angle);
  const double squares[] = {(slow * fast + k * (slow + fast)) / (middle + root), middle + root};
  const double from[] = {c, -s}, to[] = {0.5 * c, -0.5 * s};
  double action = 0;
  for (int mode = 0; mode < 2; ++mode) {
    const double w = std::sqrt(squares[mode]), a = from[mode], b = to[mode];
    action += w * ((a * a + b * b) * std::cos(w * T) - 2 * a * b) / (2 * std::sin(w * T));
  }
  return action;
}

HardGroup layers() {
  HardGroup group{"layers, singular ends, stiff modes", {}};
  for (const double mu : {30.0, 50.0, 100.0})
    group.problems.push_back({.title = fmt::format("layer of cosh, mu = {:g}", mu),
                              .scene = own + "layer.toml",
                              .sets = {fmt::format("system.parameters.mu={:.1f}", mu)},
                              .action = 4 / mu * (std::cosh(mu / 2) - 1) + 1});
  // ∫ v dy + 5 cosh y(5), v² = 2 (cosh y − cosh y(5)), by quadrature.
  group.problems.push_back(
      {.title = "fall of cosh from -38.94", .scene = own + "long-fall.toml", .action = 571141291.26561993});
  // Cycloids.
  group.problems.push_back({.title = "brachistochrone from 1e-4 below rest",
                            .scene = shipped + "brachistochrone.toml",
                            .sets = {"boundary.start.y=1e-4"},
                            .action = 1.7967802611542});
  group.problems.push_back({.title = "brachistochrone from rest",
                            .scene = shipped + "brachistochrone.toml",
                            .action = 1.8012954830137195});
  group.problems.push_back({.title = "oscillators of 1 and 1e4, T = 10",
                            .scene = own + "stiff-modes.toml",
                            .action = action_of_stiff_modes()});
  return group;
}

/// Others have [0, 20], with the equilibria at its ends.
HardGroup infinite() {
  HardGroup group{"ends at infinity", {}};
  const auto add = [&](const char* title, const char* scene, std::vector<std::string> sets, double action) {
    group.problems.push_back(
        {.title = title,
         .scene = scene == std::string("kink") ? own + "kink.toml" : shipped + scene + ".toml",
         .sets = std::move(sets),
         .action = action,
         .peer = {duration(20)}});
  };
  add("kink of a double well", "kink", {"boundary.duration=\"infinite\""}, 2 * sqrt2 / 3);
  add("homoclinic orbit", "homoclinic", {}, 4.0 / 3);
  // By shooting with DOP853 at 1e-13.
  add("bounce in three dimensions", "bounce", {"system.parameters.n=3.0"}, 3.474371244977);
  add("bounce in four dimensions", "bounce", {}, 10.35646592478);
  return group;
}

HardGroup encounters() {
  HardGroup group{"close encounters", {}};
  // L = 2/r − 1/2 and dt = r dE in the eccentric anomaly E.
  group.problems.push_back({.title = "Kepler arc through the pericentre, e = 0.999999",
                            .scene = own + "pericentre.toml",
                            .action = 2 * pi - (pi - 2 * 0.999999) / 2});
  group.problems.push_back({.title = "three bodies, I.A.29", .scene = own + "three-body-ia29.toml"});
  group.problems.push_back({.title = "three bodies, I.B.14", .scene = own + "three-body-ib14.toml"});
  group.problems.push_back({.title = "fall into a centre",
                            .scene = own + "fall.toml",
                            .for_peer = false,
                            .expected = extremal::Status::collision});
  return group;
}

/// In units of the first radius and of its circular motion.
HardGroup searches() {
  constexpr double mu = 398600.4418, first = 8800;
  const double other = std::hypot(21450.0, 37152.5) / first, angle = std::atan2(37152.5, -21450.0);
  std::vector<double> energies =
      lambert_energies(other, angle, 259200 * std::sqrt(mu / (first * first * first)), 60);
  for (double& e : energies) e *= mu / first;
  const int arcs = static_cast<int>(energies.size());
  return {"several extremals",
          {{.title = "Lambert arcs of three days",
            .scene = own + "transfer.toml",
            .energies = std::move(energies),
            .wanted = arcs}}};
}

}  // namespace

std::vector<HardGroup> hard_problems() {
  return {minimisers(), layers(), infinite(), encounters(), searches()};
}

}  // namespace bench
