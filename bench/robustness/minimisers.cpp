#include "minimisers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "system/tape.hpp"
#include "systems.hpp"

namespace bench {
namespace {

using extremal::Problem;
using extremal::trace;
using std::numbers::pi;

Problem double_well(double T) {
  return fixed_ends(trace(1,
                          [](auto q, auto v, auto) {
                            const auto u = q[0] * q[0] - 1.0;
                            return v[0] * v[0] / 2.0 + u * u / 4.0;
                          }),
                    {-1}, {1}, T);
}

Problem sine_gordon(double T) {
  return fixed_ends(trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + cos(q[0]); }), {-pi}, {pi},
                    T);
}

/// Freidlin and Wentzell's action of the drift u − u³.
Problem against_the_drift(double T) {
  return fixed_ends(trace(1,
                          [](auto q, auto v, auto) {
                            const auto off = v[0] - q[0] + q[0] * q[0] * q[0];
                            return off * off / 2.0;
                          }),
                    {-1}, {0}, T);
}

Problem maier_stein(double T) { return fixed_ends(system("maier-stein", {}), {-1, 0}, {0, 0}, T); }

Problem chain_of_wells(double T) {
  constexpr int n = 8;
  return fixed_ends(system("double-well-chain", {{"n", n}}), std::vector<double>(n, -1),
                    std::vector<double>(n, 1), T);
}

Problem layer(double mu) {
  return fixed_ends(trace(1, [mu](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + cosh(mu * q[0]); }), {0},
                    {1}, 1);
}

/// Of a path from rest to rest ∫ √(2(V − V₀)) + V₀T, V₀ at the rests.
void add(std::vector<Row>& rows, const std::string& name, Problem (*make)(double), double (*action)(double),
         const char* parameter, const std::vector<double>& values) {
  for (const double value : values)
    rows.push_back({fmt::format("{}, {} = {:g}", name, parameter, value), "straight line", -1, 100,
                    [=] { return std::vector<Case>{{.problem = make(value), .action = action(value)}}; }});
}

double kink(double) { return 2 * std::numbers::sqrt2 / 3; }

}  // namespace

void add_minimisers(std::vector<Row>& rows) {
  add(rows, "kink of a double well", double_well, kink, "T", {20, 30, 100, 1000});
  add(rows, "kink of sine-Gordon", sine_gordon, [](double T) { return 8 - T; }, "T", {30, 60, 500});
  add(rows, "against the drift", against_the_drift, [](double) { return 0.5; }, "T", {15, 18, 40, 100});
  add(rows, "Maier-Stein", maier_stein, [](double) { return 0.34004140333; }, "T", {30, 100});
  add(rows, "chain of 8 double wells", chain_of_wells, [](double T) { return 8 * kink(T); }, "T", {30, 200});
  add(rows, "layer of cosh", layer, [](double mu) { return 4 / mu * (std::cosh(mu / 2) - 1) + 1; }, "mu",
      {30, 50, 100});
}

}  // namespace bench
