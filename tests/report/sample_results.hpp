#pragma once

#include "report/result.hpp"

/// \file What the tests of reports share.

namespace extremal {

/// A converged result of two coordinates in which every number is known.
inline Result transfer_result() {
  Result result{.title = "Planar transfer", .names = {"x", "y"}, .seconds_read = 1e-4};
  Solution& solution = result.solution;
  solution.status = Status::converged;
  solution.message = "the tolerance 1e-09 is met";
  solution.strategy = "newton from the guess";
  solution.trajectory = {.coordinates = 2, .degree = 8, .times = {0, 1, 2.5}, .nodes = {}};
  solution.degree = 8;
  solution.action = 1.234;
  solution.energy = -0.4;
  solution.energy_drift = 1e-14;
  solution.error_estimate = 3e-10;
  solution.residual = 2e-15;
  solution.morse_index = 0;
  solution.nullity = 1;
  solution.minimizing = true;
  solution.windows = {{0, 1.2}, {1.2, 2.5}};
  solution.conjugate_times = {1.25};
  solution.conjugate_times_known = true;
  solution.certificate = Certificate::sampled;
  solution.momentum_start = {0.1, 0.9};
  solution.momentum_end = {-0.3, 0.7};
  solution.unknowns = 62;
  solution.iterations = 5;
  solution.seconds_solve = 4e-5;
  solution.seconds_analyse = 1e-5;
  result.samples = Samples{.t = {0, 2.5},
                           .q = {{1, -0.6}, {0, 0.9}},
                           .v = {{0.1, 0.2}, {0.3, 0.4}},
                           .p = {{0.5, 0.6}, {0.7, 0.8}}};
  return result;
}

}  // namespace extremal
