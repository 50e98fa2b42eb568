#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "action/discrete_action.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Newton's method across a family of extremals: its null directions, steps that leave these out, and
/// steps along them.

namespace extremal {

/// A change of a path: the step, and its values at the Lobatto nodes of all elements.
struct FamilyDirection {
  Step step;
  Eigen::VectorXd values;
};

/// The largest range of a coordinate of a path, or the unit of length where that vanishes.
double unit_of(const Path& path, const ElementTables& tables);

/// Extremals about a path on given elements, as far as a guess tells them apart. With two copies of the
/// coordinates the null directions are those of the linearised equations of motion and of their adjoint. A
/// family extends along the first; a force along the others is one that no step removes.
class ExtremalFamily {
 public:
  /// `count` counts a step; false ends the attempt.
  ExtremalFamily(const Problem& problem, const std::function<bool()>& count);

  /// Binds to elements; `guess` is the path that is to be near.
  void reset(const ElementTables& tables, const Path& guess);

  /// Directions of the least eigenvalues, those that stand apart from the others by `apart`: by inverse
  /// iteration in a subspace of one more than can be null. At least so many. False if K is not finite.
  bool find_null(const Path& path, double apart, int least = 0);
  int null_directions() const { return static_cast<int>(null_.size()); }
  /// Directions along which the coordinates move, all copies alike.
  int dimension() const;

  /// One step across the null directions, and, if `to_guess`, along them to where the distance from the guess
  /// is stationary. Its largest value, or infinity.
  double step(Path& path, bool to_guess);
  /// The same to the guess, one of several: longer or shorter where the family is curved.
  double slide(Path& path);
  /// Steps until they are roundoff.
  bool converge(Path& path, bool to_guess);
  /// The force along the null directions, relative to the largest momentum; at rest to the force that holds
  /// the path across them. Zero on a family.
  double force(const Path& path);
  /// Whether members of the family are on both sides. `closer` becomes the one of these that is nearest to
  /// the guess, if it is nearer than the path.
  bool extends(const Path& path, double no_force, std::optional<Path>& closer);
  /// A force that counts as none at members of a family. What a null direction moves and turns at the ends
  /// makes forces as large as its square: what lies between two rests is shifted in time by hardly more, and
  /// is no family. Zero if that is roundoff.
  double no_force(const Path& path) const;
  /// Of the second variation across the family.
  int index(const Path& path);

 private:
  Eigen::VectorXd values(const Path& path) const;
  Eigen::VectorXd applied(const Path& path, const Step& step, double factor) const;
  double product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const;
  double distance(const Path& path) const;
  void scale(FamilyDirection& x, double factor) const;
  void orthonormalise(std::vector<FamilyDirection>& directions) const;
  bool answers_all(const Path& path);
  FamilyDirection response(const Path& path, const Eigen::VectorXd& force);
  Eigen::MatrixXd first_directions(const Path& path, int size) const;
  Eigen::VectorXd subspace(const Path& path, int size, std::vector<FamilyDirection>& found);
  std::vector<FamilyDirection> tangents() const;
  void hold();
  double step_along(Path& path, bool to_guess, bool relaxed);
  double relaxation(const Eigen::VectorXd& along);

  const Problem& problem_;
  const std::function<bool()>& count_;
  std::unique_ptr<SecondVariationModel> model_;
  const ElementTables* tables_ = nullptr;
  DiscreteAction action_;
  PhaseConditions phases_;
  int elements_ = 0, n_ = 0;
  Eigen::VectorXd guess_, weights_;
  AlignedDoubles load_;
  std::vector<FamilyDirection> null_;  ///< orthonormal in L2
  double stiffness_ = 0;               ///< the least eigenvalue that is not null
  double relaxation_ = 1;              ///< of steps to the guess
  Eigen::VectorXd last_along_;         ///< the last of these, before relaxation
};

}  // namespace extremal
