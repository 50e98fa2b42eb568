#include "machine/deadline.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace extremal {
namespace {

constexpr double nanoseconds = 1e9;  // of a second
constexpr double longest = 1e9;      // seconds; more is never

/// The clock that the kernel updates at each tick, some milliseconds: reading it is cheaper than a step of
/// any method.
long long now() {
  timespec time{};
#ifdef CLOCK_MONOTONIC_COARSE
  clock_gettime(CLOCK_MONOTONIC_COARSE, &time);
#else
  clock_gettime(CLOCK_MONOTONIC, &time);
#endif
  return time.tv_sec * static_cast<long long>(nanoseconds) + time.tv_nsec;
}

}  // namespace

Deadline::Deadline(double seconds) : budget_(seconds) {
  if (seconds < longest) end_ = now() + std::max(1LL, std::llround(seconds * nanoseconds));
}

bool Deadline::passed() const { return (end_ != never && now() >= end_) || (stop_ && stop_(context_)); }

double Deadline::seconds_left() const {
  if (end_ == never) return std::numeric_limits<double>::infinity();
  return std::max(0.0, static_cast<double>(end_ - now()) / nanoseconds);
}

Deadline Deadline::share(double part) const {
  Deadline result = *this;
  if (end_ != never) result.end_ = now() + std::llround(part * seconds_left() * nanoseconds);
  return result;
}

Deadline Deadline::or_earlier(const Deadline& other) const {
  Deadline result = end_ == never || (other.end_ != never && other.end_ < end_) ? other : *this;
  const Deadline& stopped = stop_ ? *this : other;
  return result.or_stopped(stopped.stop_, stopped.context_);
}

Deadline Deadline::or_stopped(bool (*stop)(void*), void* context) const {
  Deadline result = *this;
  result.stop_ = stop;
  result.context_ = context;
  return result;
}

std::string Deadline::budget_text() const {
  std::ostringstream text;
  text << "the budget of " << budget_ << " s";
  return text.str();
}

}  // namespace extremal
