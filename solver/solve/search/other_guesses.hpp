#pragma once

#include <vector>

#include "solve/search/guess_mesh.hpp"

/// \file Paths beside the guess: finer elements, paths of less action, noise, and the straight line.

namespace extremal {

/// Downhill in windows, from the path that there is: at most so many steps, to a path this `close` to a
/// minimum of the action.
bool descend(Pursuit& pursuit, int most, double close);
/// The same from the guess on a mesh; whether an extremal was found.
bool by_descent(Pursuit& pursuit, const GuessMesh& guess, const std::vector<double>& mesh);

/// From a guess that is given, on elements that resolve it.
bool from_resolved_guess(Pursuit& pursuit, GuessMesh& guess);
/// From the guess on halved elements.
bool from_finer_elements(Pursuit& pursuit, const GuessMesh& guess);
/// From the default guess, where the user's fails.
bool from_line(Pursuit& pursuit, GuessMesh& guess);

/// The guess plus smooth noise, again and again.
class NoisyGuesses {
 public:
  /// From the next ones, so many at most.
  Trial run(Pursuit& pursuit, const GuessMesh& guess, unsigned tries);

 private:
  unsigned seed_ = 0;
};

}  // namespace extremal
