#include "problem/own_symmetries.hpp"

#include <cmath>

#include "problem/copies.hpp"
#include "problem/phase_space.hpp"

namespace extremal {

namespace {

/// Those that leave both equilibria where they are.
std::vector<Generator> symmetries_about_rest(const Problem& problem) {
  std::vector<Generator> found = continuous_symmetries(problem);
  const std::size_t n = problem.coordinates();
  std::erase_if(found, [&](const Generator& generator) {
    constexpr double roundoff = 1e-9;
    for (const std::vector<double>* q : {&problem.infinite->start, &problem.infinite->end})
      for (std::size_t a = 0; a < n; ++a) {
        double moved = generator.shift[a], size = std::abs(moved);
        for (std::size_t b = 0; b < n; ++b) {
          moved += generator.matrix[a * n + b] * (*q)[b];
          size += std::abs(generator.matrix[a * n + b] * (*q)[b]);
        }
        if (std::abs(moved) > roundoff * std::max(size, 1.0)) return true;
      }
    return false;
  });
  return found;
}

}  // namespace

std::vector<Generator> own_symmetries(const Problem& problem) {
  std::vector<Generator> found;
  if (problem.periodic)
    found = problem.phase ? phase_symmetries(problem) : continuous_symmetries(problem);
  else if (problem.infinite && problem.infinite->both())
    found = symmetries_about_rest(problem);
  return problem.paired ? symmetries_of_copies(found) : found;
}

}  // namespace extremal
