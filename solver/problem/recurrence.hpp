#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

/// \file Whether a path that closes is a motion that recurs.

namespace extremal {

struct Problem;

/// What q → R q + c, t → t + T changes. Motions go to motions, each into a motion that recurs, if and only if
/// it leaves
///   ∂L/∂q − d/dt ∂L/∂q'  at all t, and  ∂L/∂q'  from t = 0 to t = T
/// unchanged, both brought back by Rᵀ: stationarity closes momenta, and velocities follow from them. What a
/// total time derivative adds to L is no change of the first.
struct ClosingChange {
  int coordinate;
  bool momentum;  ///< of ∂L/∂q'; else of the force
  double change;  ///< the largest that was found at points about the guess
  double size;    ///< of the same where they are largest
};

/// For a periodic problem, its ends solved, with another `duration`; nothing where all is unchanged to
/// roundoff.
std::optional<ClosingChange> closing_change(const Problem& problem, double duration);

/// The shortest duration in which nothing changes, where t enters L by sin, cos and tan alone and their
/// periods have a common multiple.
std::optional<double> recurrence_time(const Problem& problem);

struct RecurrenceError : std::invalid_argument {
  std::string change;  ///< what changes, without the mend
  RecurrenceError(std::string change, const std::string& mend)
      : std::invalid_argument(change + mend), change(std::move(change)) {}
};

/// Throws RecurrenceError with the amounts, if the closing map or the duration of a periodic problem changes
/// motions. Costs nothing where L does not depend on t and paths close without a map.
void check_recurrence(const Problem& problem);

}  // namespace extremal
