#pragma once

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "problem/closing.hpp"
#include "problem/problem.hpp"

/// \file Parts of orbits, of which discrete symmetries of a Lagrangian make the whole.

namespace extremal {

/// Orbits with q(t + T/parts) = S q(t), where S^parts is the closing map of the whole.
struct Segment {
  Problem problem;  ///< of duration T/parts, closed by S; without a guess
  int parts = 1;
  ClosingMap map;  ///< S
};

/// Symmetries drawn at random, each once: changes of sign of coordinates (of all elements of an array alike),
/// permutations of the elements of arrays of the same length (bodies that are alike), all times a power of
/// the closing map. None unless the problem is periodic and autonomous, its duration given or closed by the
/// energy.
class SegmentSource {
 public:
  explicit SegmentSource(const Problem& problem);
  /// The next; none if many draws find no more.
  std::optional<Segment> draw();

 private:
  Eigen::MatrixXd candidate();
  bool leaves_unchanged(const Eigen::MatrixXd& s);
  int parts_of(const Eigen::MatrixXd& s) const;
  Segment segment(const Eigen::MatrixXd& s, int parts) const;
  int below(int count);

  const Problem& problem_;
  ClosingMap whole_;
  bool usable_ = false;
  std::vector<int> array_, index_;  ///< of each coordinate
  int arrays_ = 0, longest_ = 0;
  double extent_ = 1;
  std::minstd_rand random_{1};
  std::vector<Eigen::MatrixXd> drawn_;
};

}  // namespace extremal
