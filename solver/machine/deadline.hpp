#pragma once

#include <string>

/// \file When work is to end.

namespace extremal {

/// A time at which work is to end whether it has succeeded or not. Asking whether it has passed takes a few
/// nanoseconds.
class Deadline {
 public:
  Deadline() = default;  ///< never
  /// So many seconds from now on.
  explicit Deadline(double seconds);

  bool passed() const;
  double seconds_left() const;  ///< infinite, or at least 0
  /// After this part of what is left, for one of several that share it.
  Deadline share(double part) const;
  /// The earlier of the two.
  Deadline or_earlier(const Deadline& other) const;
  /// "the budget of 60 s": that of the deadline that was shared.
  std::string budget_text() const;

 private:
  static constexpr long long never = 0;
  long long end_ = never;  ///< in nanoseconds of the clock
  double budget_ = 0;      ///< s
};

}  // namespace extremal
