#pragma once

#include <deque>
#include <string>
#include <vector>

#include "report/layout.hpp"
#include "study/continued.hpp"

/// \file Solutions on a branch, as they are drawn beside its diagram.

namespace extremal {

/// Some solutions of each branch, from its first point to its last, with colours by the number that varies.
class Orbits {
 public:
  Orbits(const FollowedBranch& branch, const Annotation& annotation);

  /// Of one branch a panel or two of that height; of several a small one for each.
  std::vector<Panel> panels(double left, double top, double height) const;
  /// What colours stand for.
  const Axis& scale() const { return scale_; }
  /// How many branches are drawn, if not all.
  std::vector<std::string> remarks() const;

 private:
  struct Orbit {
    Column tau;  ///< t/T
    std::vector<Column> q;
    Colour colour;
  };
  /// Those of one branch.
  struct Group {
    std::string caption;
    std::vector<Orbit> orbits;
  };
  void choose(const FollowedBranch& branch);
  PathCell cell(const Group& group, const std::vector<std::size_t>& axes) const;
  std::vector<std::size_t> moving_axes() const;
  Surroundings around(const std::vector<std::size_t>& axes) const;

  Annotation annotation_;
  std::vector<std::string> names_;
  Bodies bodies_;  ///< without axes: no places; the coordinate that moves most is drawn
  std::size_t widest_ = 0;
  std::size_t branches_ = 0;  ///< of them all
  std::vector<Group> groups_;
  Axis scale_;
};

}  // namespace extremal
