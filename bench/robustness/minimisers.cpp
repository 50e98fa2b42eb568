#include "minimisers.hpp"

#include <fmt/format.h>

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

void add(std::vector<Row>& rows, const std::string& name, Problem (*make)(double), const char* parameter,
         std::vector<double> values) {
  for (const double value : values)
    rows.push_back({fmt::format("{}, {} = {:g}", name, parameter, value), "straight line", -1, 100, [=] {
                      return std::vector<Case>{{make(value), {}}};
                    }});
}

}  // namespace

void add_minimisers(std::vector<Row>& rows) {
  add(rows, "kink of a double well", double_well, "T", {20, 30, 100, 1000});
  add(rows, "kink of sine-Gordon", sine_gordon, "T", {30, 60, 500});
  add(rows, "against the drift", against_the_drift, "T", {12, 15, 18, 40, 100});
  add(rows, "Maier-Stein", maier_stein, "T", {12, 30, 100});
  add(rows, "chain of 8 double wells", chain_of_wells, "T", {30, 200});
  add(rows, "layer of cosh", layer, "mu", {10, 50, 100});
}

}  // namespace bench
