#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "system/tape.hpp"

/// \file Lagrangians of every kind that the tape must serve.

namespace extremal::systems {

inline LagrangianGraph kepler() {
  return trace_graph(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
}

/// The circular restricted problem of three bodies in the rotating frame: gyroscopic, constant mass.
inline LagrangianGraph restricted() {
  return trace_graph(3, [](auto q, auto v, auto) {
    const double mu = 0.0121505856;
    const auto a = v[0] - q[1], b = v[1] + q[0];
    const auto rest = q[1] * q[1] + q[2] * q[2];
    return (a * a + b * b + v[2] * v[2]) / 2 + (1 - mu) / sqrt((q[0] + mu) * (q[0] + mu) + rest) +
           mu / sqrt((q[0] - 1 + mu) * (q[0] - 1 + mu) + rest);
  });
}

inline LagrangianGraph double_pendulum() {
  return trace_graph(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[1] * v[1] / 2 + v[0] * v[1] * cos(q[0] - q[1]) +
           9.81 * (2 * cos(q[0]) + cos(q[1]));
  });
}

inline LagrangianGraph three_bodies() {
  return trace_graph(6, [](auto q, auto v, auto) {
    Symbol sum = 0;
    for (int k = 0; k < 6; ++k) sum += v[k] * v[k] / 2;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < i; ++j) {
        const auto dx = q[2 * i] - q[2 * j], dy = q[2 * i + 1] - q[2 * j + 1];
        sum += 1 / sqrt(dx * dx + dy * dy);
      }
    }
    return sum;
  });
}

/// A charge in a field that varies in the plane.
inline LagrangianGraph magnetic() {
  return trace_graph(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + (1 + 0.3 * q[0]) * (q[0] * v[1] - q[1] * v[0]) / 2;
  });
}

/// A charge in a uniform field with a constant vector potential besides.
inline LagrangianGraph uniform_magnetic() {
  return trace_graph(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + 3 * v[1] * v[1]) / 2 + 0.7 * (q[0] * v[1] - q[1] * v[0]) + 5 * v[0] - exp(q[1]);
  });
}

/// A geodesic of a surface of revolution.
inline LagrangianGraph torus() {
  return trace_graph(2, [](auto q, auto v, auto) {
    const auto r = 2 + cos(q[0]);
    return sqrt(r * r * v[1] * v[1] + v[0] * v[0]);
  });
}

inline LagrangianGraph driven() {
  return trace_graph(
      1, [](auto q, auto v, auto t) { return v[0] * v[0] / 2 - pow(q[0], 4) / 4 + q[0] * sin(1.3 * t); });
}

/// Every function and operation of the formula language.
inline LagrangianGraph functions() {
  return trace_graph(3, [](auto q, auto v, auto t) {
    const auto x = q[0], y = q[1], z = q[2];
    return sin(x * v[0]) + cos(y - t) + tan(x / 3) + asin(x / 4) * acos(y / 5) + atan(z * v[1]) +
           atan2(y, x + z) + sinh(x) * cosh(y) - tanh(v[2] * z) + exp(-x * y) + log(1 + z * z) +
           sqrt(x + v[0] * v[0]) + abs(x - y) + min(x * x, y) * max(v[1], z) + pow(x, y) + pow(z, 2.3) +
           pow(y, -1.5) + x / (1 + y * v[2]) + pow(x, 3);
  });
}

/// Particles with neighbours coupled by V(d) = d²/2 + d³/12 + d⁴/40, an open chain or a ring.
inline LagrangianGraph chain(int n, bool ring) {
  LagrangianGraph l;
  l.coordinates = n;
  const Symbol a(&l.graph, l.graph.input(0)), b(&l.graph, l.graph.input(1)), d = b - a;
  Term kinetic{(a * a / 2).node(l.graph), 1, {}};
  Term bonds{(-(d * d / 2 + d * d * d / 12 + d * d * d * d / 40)).node(l.graph), 2, {}};
  for (int i = 0; i < n; ++i) kinetic.table.push_back(n + i);
  for (int i = 0; i + (ring ? 0 : 1) < n; ++i) {
    bonds.table.push_back(i);
    bonds.table.push_back((i + 1) % n);
  }
  l.terms = {kinetic, bonds};
  return l;
}

/// Gravity in space as one kernel over pairs, with masses and the constant of gravity as uniforms; the
/// latter, the first uniform, is active.
inline LagrangianGraph bodies(int n) {
  LagrangianGraph l;
  l.coordinates = 3 * n;
  l.parameters = 1;
  l.uniforms = {0.9};
  std::vector<Symbol> x;
  for (std::uint32_t k = 0; k < 9; ++k) x.emplace_back(&l.graph, l.graph.input(k));
  const Symbol dx = x[0] - x[3], dy = x[1] - x[4], dz = x[2] - x[5];
  Term pairs{(x[8] * x[6] * x[7] / sqrt(dx * dx + dy * dy + dz * dz)).node(l.graph), 9, {}};
  Term kinetic{(x[1] * x[0] * x[0] / 2).node(l.graph), 2, {}};
  const auto first = static_cast<std::uint32_t>(2 * l.coordinates + 1);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
    l.uniforms.push_back(1 + 0.25 * i);
    for (std::uint32_t k = 0; k < 3; ++k) {
      kinetic.table.push_back(3 * n + 3 * i + k);
      kinetic.table.push_back(first + 1 + i);
    }
    for (std::uint32_t j = 0; j < i; ++j)
      for (const std::uint32_t input :
           {3 * i, 3 * i + 1, 3 * i + 2, 3 * j, 3 * j + 1, 3 * j + 2, first + 1 + i, first + 1 + j, first})
        pairs.table.push_back(input);
  }
  l.terms = {pairs, kinetic};
  return l;
}

struct Named {
  std::string name;
  LagrangianGraph lagrangian;
  friend void PrintTo(const Named& system, std::ostream* out) { *out << system.name; }
};

inline std::vector<Named> all() {
  return {{"kepler", kepler()},
          {"restricted", restricted()},
          {"double_pendulum", double_pendulum()},
          {"three_bodies", three_bodies()},
          {"magnetic", magnetic()},
          {"uniform_magnetic", uniform_magnetic()},
          {"torus", torus()},
          {"driven", driven()},
          {"functions", functions()},
          {"chain", chain(40, false)},
          {"ring", chain(40, true)},
          {"bodies", bodies(6)}};
}

}  // namespace extremal::systems
