#include <fmt/core.h>

#include "machine/simd.hpp"
#include "measure.hpp"
#include "system/tape_lagrangian.hpp"

/// Value, gradient and Hessian per point: the tape beside hand-written code and nested dual numbers.

namespace bench {
namespace {

using extremal::AlignedDoubles;
using extremal::Lagrangian;
using extremal::LagrangianGraph;
using extremal::Order;
using extremal::Symbol;
using extremal::Term;

constexpr double agreement = 1e-12;

struct Compiled {
  std::shared_ptr<const extremal::TapeLagrangian> lagrangian;
  double seconds;
};

Compiled compiled(LagrangianGraph graph) {
  const double start = processor_seconds();
  auto lagrangian = std::make_shared<const extremal::TapeLagrangian>(graph);
  return {lagrangian, processor_seconds() - start};
}

/// The whole L, of which the tape takes the quadratic part out.
template <class System>
LagrangianGraph traced(System) {
  return extremal::trace_graph(System::coordinates, [](auto q, auto v, auto) {
    std::vector<Symbol> z(q.begin(), q.end());
    if (System::variables == System::coordinates) {
      Symbol kinetic = 0;
      for (const Symbol& x : v) kinetic += x * x / 2;
      return kinetic + System::remainder(z.data());
    }
    z.insert(z.end(), v.begin(), v.end());
    return System::remainder(z.data());
  });
}

/// The same sum over pairs as one kernel with a table.
LagrangianGraph pairs(int bodies) {
  LagrangianGraph l;
  l.coordinates = 3 * bodies;
  std::vector<Symbol> x;
  for (std::uint32_t k = 0; k < 6; ++k) x.emplace_back(&l.graph, l.graph.input(k));
  Term potential{Gravity<2, 3>::remainder(x.data()).node(l.graph), 6, {}};
  Term kinetic{(x[0] * x[0] / 2).node(l.graph), 1, {}};
  for (std::uint32_t a = 0; a < 3u * bodies; ++a) kinetic.table.push_back(3 * bodies + a);
  for (std::uint32_t i = 1; i < static_cast<std::uint32_t>(bodies); ++i)
    for (std::uint32_t j = 0; j < i; ++j)
      for (const std::uint32_t a : {3 * i, 3 * i + 1, 3 * i + 2, 3 * j, 3 * j + 1, 3 * j + 2})
        potential.table.push_back(a);
  l.terms = {potential, kinetic};
  return l;
}

double tape_time(const Lagrangian& lagrangian, const Batch& batch) {
  AlignedDoubles out(static_cast<std::size_t>(lagrangian.rows(Order::hessian)) * batch.count);
  extremal::Scratch scratch;
  const auto points = batch.points(lagrangian.structure().coordinates);
  return seconds([&] { lagrangian.evaluate(points, Order::hessian, out.data(), scratch); }) / batch.count;
}

/// One line of the table; false if the three disagree.
template <class System>
bool compare(const char* name, System system, LagrangianGraph graph) {
  const Compiled tape = compiled(std::move(graph));
  constexpr int m = System::variables, rows = 1 + m + m * (m + 1) / 2;
  const Batch batch(m, 64);
  AlignedDoubles played(rows * 64), hand(rows * 64), jets(rows * 64);
  if (tape.lagrangian->rows(Order::hessian) != rows) return false;
  extremal::Scratch scratch;
  tape.lagrangian->evaluate(batch.points(System::coordinates), Order::hessian, played.data(), scratch);
  const auto by_hand_code = [](System s, const double* z, double* out) { by_hand(s, z, out); };
  const auto by_jet_code = [](System s, const double* z, double* out) { by_jets(s, z, out); };
  const double hand_time = seconds([&] { each_point(system, batch, hand.data(), by_hand_code); }) / 64;
  const double jet_time = seconds([&] { each_point(system, batch, jets.data(), by_jet_code); }) / 64;
  const double worst = std::max(difference(played, hand), difference(jets, hand));
  const auto summary = tape.lagrangian->summary(Order::hessian);
  fmt::print("{:<24}{:>8.2f}{:>8.2f}{:>8.2f}{:>10.2f}{:>10.0f}{:>9}{:>7}{:>10.2f}{:>10.1e}\n", name,
             1e9 * tape_time(*tape.lagrangian, Batch(m, 8)), 1e9 * tape_time(*tape.lagrangian, batch),
             1e9 * tape_time(*tape.lagrangian, Batch(m, 72)), 1e9 * hand_time, 1e9 * jet_time, summary.played,
             summary.slots, 1e3 * tape.seconds, worst);
  return worst <= agreement;
}

/// V(d) = d²/2 + d³/12 + d⁴/40 between neighbours.
void chain(int n) {
  LagrangianGraph l;
  l.coordinates = n;
  const Symbol a(&l.graph, l.graph.input(0)), d = Symbol(&l.graph, l.graph.input(1)) - a;
  Term bonds{(-(d * d / 2 + d * d * d / 12 + d * d * d * d / 40)).node(l.graph), 2, {}};
  Term kinetic{(a * a / 2).node(l.graph), 1, {}};
  for (int i = 0; i < n; ++i) kinetic.table.push_back(n + i);
  for (int i = 0; i + 1 < n; ++i)
    bonds.table.insert(bonds.table.end(), {std::uint32_t(i), std::uint32_t(i + 1)});
  l.terms = {bonds, kinetic};
  const Compiled tape = compiled(std::move(l));
  fmt::print("\nchain of {} particles: compiled in {:.1f} ms; ns per particle and point:", n,
             1e3 * tape.seconds);
  for (const int count : {8, 64, 72})
    fmt::print("  {:.2f} at {}", 1e9 * tape_time(*tape.lagrangian, Batch(n, count)) / n, count);
  fmt::print("\n");
}

bool run() {
  fmt::print("Value, gradient and packed Hessian, ns per point on one core; kernels: {}.\n",
             extremal::name(extremal::simd_level()));
  fmt::print(
      "All three compute the remainder: L without its constant quadratic part (the double pendulum has "
      "none).\n");
  fmt::print("Hand-written code and jets run point by point, built for the compiler's default target.\n\n");
  fmt::print("{:<24}{:>24}{:>10}{:>10}{:>9}{:>7}{:>10}{:>10}\n", "", "tape at 8, 64, 72", "by hand", "jets",
             "played", "slots", "build ms", "differ");
  bool agree = compare("Kepler", Kepler(), traced(Kepler()));
  agree &= compare("restricted three-body", Restricted(), traced(Restricted()));
  agree &= compare("double pendulum", DoublePendulum(), traced(DoublePendulum()));
  agree &= compare("planar three-body", Gravity<3, 2>(), traced(Gravity<3, 2>()));
  agree &= compare("spatial 6-body, pairs", Gravity<6, 3>(), pairs(6));
  agree &= compare("spatial 6-body, written", Gravity<6, 3>(), traced(Gravity<6, 3>()));
  chain(10000);
  if (!agree) fmt::print(stderr, "the three differ by more than {}\n", agreement);
  return agree;
}

}  // namespace
}  // namespace bench

int main() { return bench::run() ? 0 : 1; }
