#pragma once

#include <functional>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/march/element_solver.hpp"

/// \file A motion from its initial data, element after element. The equations are block lower triangular:
/// each element is solved by itself, and nothing is iterated over the whole.

namespace extremal {

/// A motion as far as it could be followed.
struct March {
  enum class End {
    complete,
    no_element,  ///< there is no next element, however short; or none of the length that is asked for
    deadline,
    memory,  ///< it takes more elements than can be kept
  };
  End end = End::no_element;
  double reached = 0;          ///< the time up to which there are elements
  double wanted = 0;           ///< length of the element that is missing
  bool stays_on_kink = false;  ///< why it is
  ElementSolver::Result reason = ElementSolver::Result::solved;
  Trajectory trajectory;
  MotionState last;  ///< at `reached`
  double action = 0,
         finer_action = 0;  ///< the second by a quadrature with more points, where it is asked for
  double residual = 0;      ///< largest component of δS_h divided by the largest momentum
  long long steps = 0;      ///< of Newton's method

  bool complete() const { return end == End::complete; }
};

/// Reports a number of elements, a degree, a residual and a step now and then.
using MarchProgress = std::function<void(const Iteration&)>;

/// `elements` equal elements; with `recovering` the trajectory has the velocities of their momenta
/// (dense_output.hpp). With `finer`, its quadrature sums the action of the same path up as well.
March march_uniform(const InitialData& start, double duration, const StepTables& tables, int elements,
                    bool recovering, const Deadline& deadline, const MarchProgress& progress = {},
                    const StepTables* finer = nullptr);

/// Elements as long as truncation allows: `truncation` for q, relative to the largest range of a coordinate
/// so far, ten times that for q'; and no longer than `longest`. A trajectory that is near serves as the first
/// guess of each element.
March march_adaptive(const InitialData& start, double duration, const StepTables& tables, double truncation,
                     double longest, const Deadline& deadline, const Trajectory* near = nullptr,
                     const MarchProgress& progress = {});

}  // namespace extremal
