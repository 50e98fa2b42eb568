#include "system/in_all_coordinates.hpp"

#include <algorithm>

#include "system/derivative.hpp"

namespace extremal {

using expression_matrix::add_product;
using expression_matrix::Row;

namespace {

bool zero(const Scaled& x) { return x.zero(); }

}  // namespace

InAllCoordinates::InAllCoordinates(const ConstrainedGraph& system, const Chart& chart)
    : algebra(graph), n(chart.coordinates), d(chart.free), m(n - d) {
  lagrangian = algebra.import(system.graph, system.lagrangian, inputs_of_system(system, chart, -1));
  for (const int k : chart.order) {
    const Row inputs = inputs_of_system(system, chart, k);
    g.push_back(algebra.import(system.graph, system.constraints[k], inputs));
    g_y.push_back(slopes(g.back(), 0, n));
    g_t.push_back(slopes(g.back(), 2 * n, 1)[0]);
    Scaled rate = g_t.back();
    for (int b = 0; b < n; ++b) add_product(algebra, rate, g_y.back()[b], algebra.input(n + b));
    rates.push_back(rate);
    rate_y.push_back(slopes(rate, 0, n));
  }
  lagrangian_z = slopes(lagrangian, 0, 2 * n);
  Scaled sum = lagrangian;
  for (int k = 0; k < m; ++k) {
    add_product(algebra, sum, algebra.input(2 * n + 1 + k), g[k]);
    add_product(algebra, sum, algebra.input(2 * n + 1 + m + k), rates[k]);
  }
  first = slopes(sum, 0, 2 * n);
  for (int z = 0; z < 2 * n; ++z) second.push_back(slopes(first[z], 0, z + 1));
  if (!system.forces.empty()) put_forces(system, chart);
}

void InAllCoordinates::put_forces(const ConstrainedGraph& system, const Chart& chart) {
  const Row inputs = inputs_of_system(system, chart, -1);
  force.resize(n);
  for (int a = 0; a < n; ++a) {
    const Scaled acting = algebra.import(system.graph, system.forces[a], inputs);
    const Row by_y = slopes(inputs[a], 0, n);
    for (int b = 0; b < n; ++b) add_product(algebra, force[b], acting, by_y[b]);
  }
  for (const Scaled& component : force) force_z.push_back(slopes(component, 0, 2 * n));
}

bool InAllCoordinates::timed() {
  return !std::ranges::all_of(g_t, zero) || !slopes(lagrangian, 2 * n, 1)[0].zero();
}

bool InAllCoordinates::timed_forces() {
  return !std::ranges::all_of(force, [&](const Scaled& f) { return slopes(f, 2 * n, 1)[0].zero(); });
}

/// What the system reads, as B z and B z'; of a constraint that does not depend on an angle, at the angle 0.
Row InAllCoordinates::inputs_of_system(const ConstrainedGraph& system, const Chart& chart, int constraint) {
  Row z;
  for (int b = 0; b < 2 * n; ++b) z.push_back(algebra.input(b));
  for (const Polar& p : chart.polar) put_polar(p, std::ranges::count(p.invariants, constraint) > 0, z);
  Row inputs;
  for (const int from : {0, n})
    for (int a = 0; a < n; ++a) {
      Scaled sum;
      for (int b = 0; b < n; ++b)
        if (const double factor = chart.basis[a * n + b]; factor != 0)
          add_product(algebra, sum, algebra.constant(factor), z[from + b]);
      inputs.push_back(sum);
    }
  inputs.push_back(algebra.input(2 * n));
  for (const double parameter : system.parameters) inputs.push_back(algebra.constant(parameter));
  return inputs;
}

/// (x + r cos φ, y + r sin φ) and its rate.
void InAllCoordinates::put_polar(const Polar& p, bool at_zero, Row& z) {
  const Scaled r = algebra.input(p.radius), dr = algebra.input(n + p.radius);
  const Scaled turn = algebra.multiply(algebra.constant(1 / p.unit), algebra.input(n + p.angle));
  const Scaled angle = algebra.multiply(algebra.constant(1 / p.unit), algebra.input(p.angle));
  const Scaled c = at_zero ? algebra.constant(1) : algebra.unary(Op::cos, angle);
  const Scaled s = at_zero ? Scaled{} : algebra.unary(Op::sin, angle);
  const Scaled along = algebra.multiply(r, turn);
  const auto placed = [&](double centre, Scaled direction) {
    Scaled sum = algebra.constant(centre);
    add_product(algebra, sum, r, direction);
    return sum;
  };
  const auto moved = [&](Scaled outward, Scaled across) {
    Scaled sum;
    add_product(algebra, sum, dr, outward);
    add_product(algebra, sum, along, across);
    return sum;
  };
  z[p.angle] = placed(p.x, c);
  z[p.radius] = placed(p.y, s);
  z[n + p.angle] = moved(c, -s);
  z[n + p.radius] = moved(s, c);
}

Row InAllCoordinates::slopes(Scaled f, int from, int count) {
  Row result(count);
  if (f.zero()) return result;
  std::vector<bool> wanted(from + count);
  std::fill_n(wanted.begin() + from, count, true);
  for (const Partial& p : differentiate(algebra, f, wanted)) result[p.input - from] = p.value;
  return result;
}

}  // namespace extremal
