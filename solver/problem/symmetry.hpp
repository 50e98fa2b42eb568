#pragma once

#include <Eigen/Core>
#include <vector>

/// \file Continuous symmetries of a problem, found from its Lagrangian.

namespace extremal {

struct Problem;

/// δq = G q + c.
struct Generator {
  std::vector<double> matrix;  ///< G, n × n, row-major
  std::vector<double> shift;   ///< c, n
};

/// With more, rotations take too long to find where every solve looks for them.
inline constexpr int most_coordinates_for_rotations = 12;

struct SymmetrySearch {
  int most_coordinates = most_coordinates_for_rotations;  ///< with more only translations are looked for
  /// Points about the guess and their velocities are in turn multiplied by these: far away forces may vanish.
  std::vector<double> scales{1};
  /// Symmetries leave the surfaces on which L is not smooth where they are: about one point L is that of one
  /// side alone.
  bool of_surfaces = false;
};

/// For symmetries of L wherever it is. In one place what breaks them may be below roundoff, as beside the
/// bottom of a flat potential.
inline SymmetrySearch everywhere() { return {.scales = {1, 8, 64}, .of_surfaces = true}; }

/// Independent affine motions of configuration space that leave the boundary relation and the action of every
/// path that satisfies it unchanged: ∂L/∂q · δq + ∂L/∂q' · δq' = 0, or b · q' where the relation holds
/// b · (q(T) − q(0)), at random points about the guess. The momenta ∂L/∂q' · δq − b · q are constants of the
/// motion (Noether).
std::vector<Generator> continuous_symmetries(const Problem& problem, const SymmetrySearch& search = {});

/// Independent combinations of symmetries that satisfy linear conditions: `values` has what each condition is
/// for each symmetry, conditions × symmetries.
std::vector<Generator> symmetries_that_keep(const Eigen::MatrixXd& values,
                                            const std::vector<Generator>& symmetries);

}  // namespace extremal
