#pragma once

#include <functional>
#include <optional>

#include "action/scheme.hpp"
#include "machine/deadline.hpp"
#include "solution/solution.hpp"
#include "solve/external/method.hpp"

/// \file Options of a solve.

namespace extremal {

struct SolveOptions {
  double tolerance = 1e-9;       ///< of q(t), relative to the largest range of a coordinate
  std::optional<Scheme> scheme;  ///< this scheme, N adapted; absent: chosen
  int elements = 0;              ///< with scheme: exactly so many equal elements; excludes tolerance
  bool free_steps = false;       ///< with elements: the times of the nodes are unknowns as well
  Method method = Method::newton;
  int max_iterations = 8000;  ///< Newton steps in all, restarts from other guesses included
  Deadline deadline = {};     ///< after which nothing further is tried
  std::function<void(const Iteration&)> progress;

  /// The same without a scheme: elements are chosen for the tolerance.
  SolveOptions adaptive() const {
    SolveOptions own = *this;
    own.scheme.reset();
    own.elements = 0;
    own.free_steps = false;
    return own;
  }
};

}  // namespace extremal
