#include "solve/branch/chord_steps.hpp"

#include <algorithm>
#include <utility>

#include "solve/branch/limits.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::chord_steps;

Progress ChordSteps::take(bool solved, int k) {
  if (!solved) {
    left_problem_ = !branch_.defined();
    return Progress::failed;
  }
  const Move& move = branch_.correction;
  along_ += branch_.dot(tangent_, move);
  const double way = std::sqrt(branch_.dot(move, move)), size = branch_.largest(move);
  const double rate = k > 0 ? size / before_ : 1;
  factorisations_ += anew_;
  roundoff_ = anew_ && size < largest_roundoff && rate > stagnation;
  const bool noise = roundoff_ && size < std::max(amplified_roundoff, negligible * enough_);
  // Old factors may hide corrections: growth is measured against the last correction of new ones.
  const double growth = way / (anew_ ? std::exchange(way_of_newton_, way) : way_before_);
  const double fastest = way > small_correction * length_ ? contraction : slowest;
  if (!noise && (!(way <= longest_correction * length_) || growth > fastest)) return Progress::failed;
  if (!branch_.apply(move, 1)) {
    left_problem_ = !branch_.defined();
    return Progress::failed;
  }
  if (k > 0 && newton_) curvature_ = rate / before_;
  // The remainder after a step of Newton's method, and by how much a step with its factors, which are off by
  // all of the last move and not by half of it, shrinks that.
  const double left = size * (anew_ ? curvature_ * size : newton_ ? 2 * rate : rate);
  const double shrinking = anew_ ? 2 * curvature_ * size : left / size;
  if (noise || left <= goal_) return Progress::arrived;
  newton_ = anew_;
  anew_ = !branch_.factored() || (k > 0 && !(left * shrinking * shrinking <= goal_));
  before_ = size;
  way_before_ = way;
  return Progress::more;
}

}  // namespace extremal
