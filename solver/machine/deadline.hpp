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
  /// The earlier of the two, and what stops one of them.
  Deadline or_earlier(const Deadline& other) const;
  /// The same, passed also once stop(context) is true. That is asked as often as the time, in one thread; it
  /// must not throw, and from its first true on it must stay true.
  Deadline or_stopped(bool (*stop)(void* context), void* context) const;
  /// "the budget of 60 s": that of the deadline that was shared.
  std::string budget_text() const;

 private:
  static constexpr long long never = 0;
  long long end_ = never;  ///< in nanoseconds of the clock
  double budget_ = 0;      ///< s
  bool (*stop_)(void*) = nullptr;
  void* context_ = nullptr;
};

}  // namespace extremal
