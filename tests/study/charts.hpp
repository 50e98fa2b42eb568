#pragma once

#include <memory>

#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "study/study.hpp"

/// \file Constrained problems with and without minimal coordinates.

namespace extremal::test {

inline const MinimalProblem* minimal(const Study& s) { return s.problem.manifold->parts().minimal.get(); }

/// The solution without minimal coordinates.
inline Solution in_all_coordinates(Study s) {
  Manifold::Parts parts = s.problem.manifold->parts();
  parts.minimal = nullptr;
  s.problem.manifold = std::make_shared<const Manifold>(std::move(parts));
  return run(s);
}

}  // namespace extremal::test
