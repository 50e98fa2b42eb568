#pragma once

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Solutions as guesses.

namespace extremal {

/// A trajectory as a guess: so many samples of each element, or as many as its degree. Where it bends most
/// its elements are shortest, and so are the steps between samples.
Guess guess_of(const Trajectory& trajectory, int samples_an_element = 0);

/// The problem with a solution as its guess.
Problem guessed_by(const Problem& problem, const Solution& solution);

}  // namespace extremal
