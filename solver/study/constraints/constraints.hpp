#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "system/constraints.hpp"
#include "system/formula.hpp"

/// \file Constraints of a system in a problem.

namespace extremal {

/// Points of the motion, or near it, at its ends.
struct EndPoints {
  std::vector<double> start, end;  ///< n each
};

/// Puts L̃ and the manifold of the constraints into a problem that has its relation; `time` is about its
/// duration. Does nothing without constraints. `deferred`: L̃ is made when it is first evaluated, if it does
/// not depend on t. Throws SceneError.
void constrain(const SystemTable& table, const System& system, double time, bool deferred, Problem& problem);

/// The same with the metric and ω of another problem of the family. `active` as make_system().
void constrain_like(const Manifold& other, const SystemTable& table, const System& system, Problem& problem,
                    const std::vector<std::string>& active = {});

/// The manifold alone, with the same; `problem` has the Lagrangian of the system. Returns both as
/// expressions.
ConstrainedGraph put_manifold_like(const Manifold& other, const SystemTable& table, const System& system,
                                   Problem& problem);

/// L̃ and the manifold of constraints.
struct ConstrainedSystem {
  std::shared_ptr<const Lagrangian> lagrangian;  ///< null where there are as many constraints as coordinates
  std::shared_ptr<const Lagrangian> copies;      ///< with forces: of two copies of it; null: there are none
  std::shared_ptr<const Manifold> manifold;
};

/// The metric of the motions near the guess of a problem.
Eigen::MatrixXd metric_of_motion(const System& system, const Problem& problem);

/// Of all constraints of a graph, for their values and derivatives: there may be more than coordinates.
std::shared_ptr<const Manifold> constrained_values(const ConstrainedGraph& graph, const System& system,
                                                   const Eigen::MatrixXd& metric, double rate = 0);

/// How points are moved with a metric of fewer coordinates than a system has: the others are constants.
NormalMotion normal_motion(const Eigen::MatrixXd& metric, double rate, int coordinates);

/// Of a motion with this metric and rate ω.
ConstrainedSystem constrained_system(const ConstrainedGraph& graph, const System& system,
                                     const Eigen::MatrixXd& metric, double rate, bool deferred = false);

/// The ends of the guess, or near those that the relation fixes.
EndPoints end_points(const Problem& problem);

/// Throws SceneError where constraints depend on each other at all points tried near the guess and the ends.
void check_independent(const Scene& scene, const EndPoints& ends, const Problem& problem);

/// Makes the relation of a constrained problem one of ends on the manifold. Ends that are given must satisfy
/// the constraints; coordinates that follow from those given are fixed too, near `near`, which becomes points
/// on the manifold. Momenta of initial data become those of L̃. Throws SceneError with the amount by which a
/// constraint is missed. False where the natural conditions of L̃ are not those on the manifold: only minimal
/// coordinates have these.
bool complete_ends(const Scene& scene, EndPoints& near, Problem& problem);

/// Throws SceneError: an end is fixed in part, and there are neither minimal coordinates for it nor may it
/// be a condition.
[[noreturn]] void refuse_partly_free(const Scene& scene, const Problem& problem);

/// Moves the guess onto the manifold. The line between the ends, which is the default, is bent aside where
/// that is impossible or makes it jump; of any other guess a SceneError is thrown.
void project_guess(const Scene& scene, const EndPoints& ends, Problem& problem);

/// The same of lines through waypoints at these t/T, which are the guess by default.
void project_lines(const Scene& scene, const std::vector<double>& waypoints, Problem& problem);

}  // namespace extremal
