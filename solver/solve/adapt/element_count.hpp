#pragma once

#include <cmath>
#include <string>

#include "action/scheme.hpp"
#include "solve/mesh/resolution.hpp"

/// \file How many equal elements of a scheme a tolerance needs.

namespace extremal {

/// A number that grows as the errors of those before it ask for.
class ElementCount {
 public:
  ElementCount(const Scheme& scheme, double tolerance, int first, int most);

  int now() const { return now_; }
  int most() const { return most_; }

  /// So many times more, where no extremal was found.
  void multiply(int factor) { now_ *= factor; }

  /// What the elements so far were.
  struct Trials {
    bool dear = false;    ///< they have cost much
    bool kinked = false;  ///< kinks of L are inside some, which takes the order from the scheme
  };
  /// More of them. `excess` is the error by the tolerance, more than 1. False if more would be of no use, or
  /// are too many.
  bool grow(double excess, const Scales& size, Trials so_far);
  const std::string& failure() const { return failure_; }  ///< why not

  /// Whether an extremal has been found.
  bool any() const { return least_.elements > 0; }

 private:
  struct Tried {
    int elements = 0;
    double error = INFINITY;
  };
  double needed(const Tried& now, const Tried& before, double goal) const;

  const Scheme& scheme_;
  double tolerance_;
  int now_, most_;
  Tried first_, least_, latest_;
  double expected_ = 0;  ///< error
  std::string failure_;
};

/// Why elements of a scheme are no solution where elements of higher degree confirm none near theirs.
std::string no_companion(int elements);

}  // namespace extremal
