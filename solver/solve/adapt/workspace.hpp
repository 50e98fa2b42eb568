#pragma once

#include <memory>
#include <vector>

#include "action/recovery.hpp"
#include "analysis/variation.hpp"
#include "solve/mesh/frequency.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/plan.hpp"
#include "solve/newton/iteration.hpp"

/// \file Memory that the stages of a solve share.

namespace extremal {

/// Tables, factors and buffers, kept from solve to solve. No stage leaves a result here for another.
struct Workspace {
  Levels levels;
  NewtonIteration iteration;
  Recovery recovery;
  Resolution resolution;
  Planner planner;
  Frequency frequency;  ///< memory of a measurement
  SecondVariation variation;
  Path other, raised;  ///< while a path moves to other elements
  Scratch scratch;
  Path spare, spare_whole;     ///< memory of the next Outcome, and of an orbit of which that has a part
  std::vector<double> before;  ///< mesh nodes when the present elements were opened
  std::unique_ptr<SchemeTables> pinned_scheme;
  ElementTables pinned;
};

/// Makes polynomials of higher degree (recovery.hpp) from a path on whose elements the workspace's iteration
/// is; false where there are none.
bool recover(const Problem& problem, const Path& path, Workspace& workspace, Path& recovered);
/// The same of the elements of any discrete action; `levels` are of as many coordinates.
bool recover(const Lagrangian& lagrangian, DiscreteAction& action, const Path& path, Recovery& recovery,
             Levels& levels, Path& recovered);

}  // namespace extremal
