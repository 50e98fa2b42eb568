#pragma once

#include <Eigen/Dense>
#include <vector>

#include "motion/flow.hpp"
#include "problem/problem.hpp"
#include "rivals/almost_block_diagonal.hpp"
#include "motion/batch_dop853.hpp"
#include "rivals/conditions.hpp"

/// \file A motion in segments, each from a state of its own: the equations of single and multiple shooting.

namespace extremal {

/// States (q, p) at the start of each segment, 2n × segments; segments are equal parts of the duration.
struct Course {
  Eigen::MatrixXd states;
  double duration = 0;
};

class Segments {
 public:
  /// `problem` must outlive it. Throws std::invalid_argument for less than one segment or a singular constant
  /// mass.
  Segments(const Problem& problem, int segments, const Deadline& deadline = {});

  /// Positions and velocities of the guess; what the problem demands of its start alone is met. False if L is
  /// not finite there.
  bool guess(Course& course);

  /// Integrates; with variations the linear system is made too. False where an integration fails.
  bool evaluate(const Course& course, double tolerance, bool with_variations);
  /// Makes the last variations those that correct() uses.
  void factor();

  /// The correction that the last evaluation calls for, with the last factors.
  struct Correction {
    Eigen::MatrixXd states;
    Eigen::VectorXd end;  ///< of the state at the end
    double duration = 0;
    double size = 0;  ///< largest change of a position or relative one of the duration, by the scale of q
    bool finite = false;
  };
  Correction correct() const;

  int steps() const { return integrator_.steps(); }
  Eigen::VectorXd velocity(const Eigen::VectorXd& state, double t);

 private:
  void free_start(Course& course);
  EndStates end_states(const Course& course);
  void load(const Course& course, int split, int columns);
  bool unload(const Course& course, int split, int columns);
  void end_slopes(const Course& course);
  void close(const Course& course);

  const Problem& problem_;
  const int n_, segments_;
  const Deadline deadline_;
  EndConditions conditions_;
  Flow flow_;
  LaneFlow lane_flow_;
  BatchDop853 integrator_;
  std::vector<MotionSpan> spans_;
  std::vector<double> first_steps_, first_tolerances_;
  std::vector<double> initial_, final_;
  Eigen::MatrixXd basis_;   ///< directions that the start may move in, 2n × their number
  std::vector<int> later_;  ///< conditions that are not met by the start alone
  double scale_ = 1;
  Eigen::MatrixXd ends_;  ///< states at the end of each segment
  AlmostBlockDiagonal::Blocks blocks_;
  AlmostBlockDiagonal system_;
  std::vector<Eigen::VectorXd> right_;
};

}  // namespace extremal
