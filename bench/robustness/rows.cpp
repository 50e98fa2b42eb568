#include "rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "kepler.hpp"
#include "random.hpp"
#include "rivals/shooting.hpp"
#include "systems.hpp"

namespace bench {
namespace {

using extremal::Flight;
using extremal::Lagrangian;
using extremal::Problem;
using std::numbers::pi;

constexpr int guess_steps = 400;
constexpr int noise_modes = 6;

/// A state to start from, drawn anew for each case.
using Draw = std::function<State(Random&)>;

/// The trajectory with smooth noise: Σ_m c_m sin(mπ t/T), m <= 6, c_m in ±1, scaled so that its largest value
/// in each coordinate is `size`.
void guess_with_noise(const Flight& flight, double size, Random& random, Problem& problem) {
  const std::size_t n = problem.coordinates();
  problem.guess.q = flight.q;
  for (int k = 0; k <= guess_steps; ++k) problem.guess.tau.push_back(static_cast<double>(k) / guess_steps);
  for (std::size_t a = 0; a < n; ++a) {
    double amplitude[noise_modes];
    for (double& c : amplitude) c = random.between(-1, 1);
    std::vector<double> noise(guess_steps + 1, 0);
    double largest = 0;
    for (int k = 0; k <= guess_steps; ++k) {
      for (int m = 1; m <= noise_modes; ++m)
        noise[k] += amplitude[m - 1] * std::sin(m * pi * problem.guess.tau[k]);
      largest = std::max(largest, std::abs(noise[k]));
    }
    for (int k = 1; k < guess_steps; ++k) problem.guess.q[k * n + a] += size / largest * noise[k];
  }
}

/// Trajectories of `duration` from random states; `noise` below 0: straight lines between their ends.
std::vector<Case> flights(const std::shared_ptr<const Lagrangian>& lagrangian, const Draw& draw,
                          double duration, int count, double noise, unsigned seed) {
  std::vector<double> times;
  for (int k = 0; k <= guess_steps; ++k) times.push_back(duration * k / guess_steps);
  Random random(seed);
  std::vector<Case> cases;
  while (static_cast<int>(cases.size()) < count) {
    const State state = draw(random);
    const Flight flight = extremal::fly(*lagrangian, state.q, state.v, times);
    if (!flight.complete) continue;
    const std::size_t n = state.q.size();
    Problem problem = fixed_ends(lagrangian, state.q, {flight.q.end() - n, flight.q.end()}, duration);
    if (noise >= 0) guess_with_noise(flight, noise, random, problem);
    cases.push_back({make_problem(std::move(problem))});
  }
  return cases;
}

State draw_pendulum(Random& random) { return {{random.between(-1, 1)}, {random.between(-1.5, 1.5)}}; }

/// Speeds from which it turns over.
State draw_fast_pendulum(Random& random) { return {{random.between(-3, 3)}, {random.between(-3, 3)}}; }

/// Uniform over the part of the plane that the energy 1/8 leaves, and over directions.
State draw_henon_heiles(Random& random) {
  for (;;) {
    const double x = random.between(-1, 1), y = random.between(-0.5, 1);
    const double kinetic = 0.125 - ((x * x + y * y) / 2 + x * x * y - y * y * y / 3);
    // Beyond the saddle at y = 1 motion is not bound.
    if (kinetic < 0 || std::hypot(x, y) > 0.9) continue;
    const double speed = std::sqrt(2 * kinetic), angle = random.between(0, 2 * pi);
    return {{x, y}, {speed * std::cos(angle), speed * std::sin(angle)}};
  }
}

State draw_double_pendulum(Random& random) {
  return {{0, 0}, {random.between(-3, 3), random.between(-3, 3)}};
}

/// About the deepest minimum, with energy enough to leave it.
State draw_mueller_brown(Random& random) {
  const double speed = std::sqrt(2 * random.between(40, 120)), angle = random.between(0, 2 * pi);
  return {{-0.558, 1.442}, {speed * std::cos(angle), speed * std::sin(angle)}};
}

State draw_chain(Random& random) {
  State state{std::vector<double>(8), std::vector<double>(8)};
  for (double& q : state.q) q = random.between(-0.5, 0.5);
  for (double& v : state.v) v = random.between(-0.5, 0.5);
  return state;
}

/// Both guesses, each duration a row; `baseline` lists straight lines, then noise.
void add_flights(std::vector<Row>& rows, const std::string& name,
                 const std::shared_ptr<const Lagrangian>& lagrangian, const Draw& draw,
                 std::vector<double> durations, std::vector<double> baseline) {
  for (const double noise : {-1.0, 0.3})
    for (std::size_t k = 0; k < durations.size(); ++k) {
      const double duration = durations[k], found = baseline[(noise < 0 ? 0 : durations.size()) + k];
      rows.push_back({fmt::format("{}, T = {}", name, duration),
                      noise < 0 ? "straight line" : "truth + noise 0.3", 100 * found / 40, 100,
                      [=] { return flights(lagrangian, draw, duration, 40, noise, 1 + k); }});
    }
}

/// Rows for which no baseline was measured.
void add_further(std::vector<Row>& rows, const std::string& name,
                 const std::shared_ptr<const Lagrangian>& lagrangian, const Draw& draw,
                 std::vector<double> durations) {
  for (const double duration : durations)
    rows.push_back({fmt::format("{}, T = {}", name, duration), "straight line", -1, 100,
                    [=] { return flights(lagrangian, draw, duration, 20, -1, 1); }});
}

void add_arcs(std::vector<Row>& rows) {
  struct Range {
    double from, to, found, circular, wanted;
  };
  constexpr Range ranges[] = {{20, 90, 100, 98, 99},
                              {90, 160, 95.8, 90, 97},
                              {160, 175, 52.2, 77, 95},
                              {185, 270, 81.8, 75, 90},
                              {270, 340, 99.2, 47, 80}};
  for (const bool circular : {false, true})
    for (const Range& r : ranges)
      rows.push_back({fmt::format("Kepler arc, {} to {} degrees", r.from, r.to),
                      circular ? "circular arc" : "straight line", circular ? r.circular : r.found,
                      circular ? r.wanted : 100, [=] { return kepler_arcs(r.from, r.to, 500, circular); }});
}

}  // namespace

std::vector<Row> all_rows() {
  std::vector<Row> rows;
  add_flights(rows, "pendulum", system("pendulum", {{"g", 1}}), draw_pendulum, {20, 40, 80},
              {31, 20, 15, 36, 30, 13});
  add_flights(rows, "Hénon-Heiles", system("henon-heiles"), draw_henon_heiles, {10, 20, 40, 80},
              {25, 16, 7, 2, 25, 15, 9, 2});
  add_arcs(rows);
  const auto double_pendulum = system("double-pendulum");
  rows.push_back({"double pendulum, T = 3", "straight line", 0, 90,
                  [=] { return flights(double_pendulum, draw_double_pendulum, 3, 20, -1, 1); }});
  add_further(rows, "double pendulum", double_pendulum, draw_double_pendulum, {4, 5});
  add_further(rows, "pendulum that turns over", system("pendulum", {{"g", 1}}), draw_fast_pendulum, {20, 80});
  add_further(rows, "Müller-Brown", system("mueller-brown"), draw_mueller_brown, {0.1, 0.2, 0.3, 1});
  add_further(rows, "FPU chain of 8", system("fpu-chain", {{"n", 8}}), draw_chain, {5, 10});
  return rows;
}

}  // namespace bench
