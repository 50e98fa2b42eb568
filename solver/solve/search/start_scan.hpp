#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "motion/flow.hpp"
#include "problem/problem.hpp"

/// \file Motions of one coordinate from all starts that the conditions there allow.

namespace extremal {

inline constexpr const char* from_start = "newton from a motion that meets the end";

/// With one coordinate, of which an end is natural or has a given momentum, the condition at the start leaves
/// one number w: the momentum where q(0) is fixed, q(0) where it is not. The motions that meet the condition
/// at T are the zeros of one function of w.
class StartScan {
 public:
  struct State {
    double q, v;
  };

  explicit StartScan(const Problem& problem);
  bool usable() const { return usable_; }

  /// w of a motion with this state at the start.
  double unknown(State start);
  /// The state of a motion at the start; nothing if no velocity belongs to w.
  std::optional<State> state(double w);
  /// The w of motions that meet the condition at the end, between two values. False if there were not enough
  /// integrator steps: `more` is told how many were taken.
  bool zeros(double from, double to, const std::function<bool(int steps)>& more, std::vector<double>& found);

 private:
  struct Sample {
    double w, miss;  ///< not finite where there is no motion until T
  };
  Sample sample(double w);
  void divide(const Sample& a, const Sample& b, int halvings, std::vector<double>& found);
  void enclose(Sample a, Sample b, std::vector<double>& found);

  const Problem& problem_;
  bool usable_;
  std::optional<Flow> flow_;
  std::function<bool(int)> more_;
};

}  // namespace extremal
