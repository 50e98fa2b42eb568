#pragma once

#include <memory>

#include "system/hamiltonian.hpp"
#include "system/symbol.hpp"
#include "system/tape.hpp"

/// \file Systems that the tests of the action share: separable, gyroscopic, with a mass that depends on
/// the configuration, with explicit time.

namespace extremal::systems {

inline std::shared_ptr<const Lagrangian> oscillator(double omega) {
  return trace(1, [=](auto q, auto v, auto) { return (v[0] * v[0] - omega * omega * q[0] * q[0]) / 2; });
}

inline std::shared_ptr<const Lagrangian> pendulum() {
  return trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); });
}

inline std::shared_ptr<const Lagrangian> kepler() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
}

inline std::shared_ptr<const Lagrangian> double_pendulum() {
  return trace(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[1] * v[1] / 2 + v[0] * v[1] * cos(q[0] - q[1]) + 2 * 9.81 * cos(q[0]) +
           9.81 * cos(q[1]);
  });
}

/// The rotating frame: (x' − y)² + (y' + x)², two centres.
inline std::shared_ptr<const Lagrangian> restricted_three_body() {
  return trace(3, [](auto q, auto v, auto) {
    const double mu = 0.2;
    const auto a = v[0] - q[1], b = v[1] + q[0];
    const auto r1 = sqrt((q[0] + mu) * (q[0] + mu) + q[1] * q[1] + q[2] * q[2]);
    const auto r2 = sqrt((q[0] - 1 + mu) * (q[0] - 1 + mu) + q[1] * q[1] + q[2] * q[2]);
    return (a * a + b * b + v[2] * v[2]) / 2 + (1 - mu) / r1 + mu / r2;
  });
}

/// A field that varies in space: gyroscopic coupling that depends on q.
inline std::shared_ptr<const Lagrangian> magnetic() {
  return trace(2, [](auto q, auto v, auto) {
    const auto field = 1 + q[0] * q[0] / 4;
    return (v[0] * v[0] + v[1] * v[1]) / 2 + field * (q[0] * v[1] - q[1] * v[0]) / 2 - q[0] * q[0] * q[1];
  });
}

/// A Hamiltonian whose Legendre transform has no expression; the momenta couple with each other and with q.
inline std::shared_ptr<const Lagrangian> quartic_hamiltonian() {
  return trace_hamiltonian(2, [](auto q, auto p, auto) {
    const auto square = p[0] * p[0] + p[0] * p[1] / 2 + p[1] * p[1];
    return square * (1 + q[0] * q[0] / 4) / 2 + square * square / 16 + (q[0] * p[1] - q[1] * p[0]) / 4 +
           q[0] * q[0] * q[1];
  });
}

inline std::shared_ptr<const Lagrangian> driven() {
  return trace(1, [](auto q, auto v, auto t) {
    return v[0] * v[0] / 2 + cos(q[0]) + q[0] * sin(2 * t) + t * v[0] * q[0];
  });
}

inline std::shared_ptr<const Lagrangian> henon_heiles() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - q[1] * q[1]) / 2 - q[0] * q[0] * q[1] +
           q[1] * q[1] * q[1] / 3;
  });
}

/// q'' = −λ eᑫ: from 0 to 0 in T there are two extremals where λT² < 3.5138, none where it is more.
inline std::shared_ptr<const Lagrangian> bratu(double lambda) {
  return trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 - lambda * exp(q[0]); });
}

}  // namespace extremal::systems
