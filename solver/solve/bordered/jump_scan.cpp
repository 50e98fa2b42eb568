#include "solve/bordered/jump_scan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/bordered/limits.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

/// Equal steps, and ever shorter ones towards both ends, where the jump tends to infinity.
std::vector<double> scanned_times(double from, double to) {
  const double step = (to - from) / scanned_steps;
  std::vector<double> times;
  for (int k = 1; k < scanned_steps; ++k) times.push_back(from + k * step);
  for (double part = step / 2; times.front() - from > shortest_scanned * (to - from); part /= 2) {
    times.insert(times.begin(), from + part);
    times.push_back(to - part);
  }
  return times;
}

class JumpScan {
 public:
  explicit JumpScan(const SolveAtTime& solve) : solve_(solve) {}

  std::vector<JumpAtTime> run(double from, double to) {
    for (const double time : scanned_times(from, to)) samples_.push_back(at(time, last()));
    for (std::size_t k = 0; k + 1 < samples_.size(); ++k) {
      if (samples_[k] && samples_[k + 1]) bracket(*samples_[k], *samples_[k + 1]);
      if (k > 0 && samples_[k - 1] && samples_[k] && samples_[k + 1])
        descend(*samples_[k - 1], *samples_[k], *samples_[k + 1]);
    }
    return std::move(zeros_);
  }

 private:
  static bool differ(const JumpAtTime& a, const JumpAtTime& b) { return (a.jump < 0) != (b.jump < 0); }

  const JumpAtTime* last() const {
    return samples_.empty() || !samples_.back() ? nullptr : &*samples_.back();
  }

  std::optional<JumpAtTime> at(double time, const JumpAtTime* near) const {
    if (near)
      if (std::optional<JumpAtTime> found = solve_(time, near)) return found;
    return solve_(time, nullptr);
  }

  std::optional<JumpAtTime> between(const JumpAtTime& a, const JumpAtTime& b) const {
    return at(0.5 * (a.time + b.time), std::abs(a.jump) < std::abs(b.jump) ? &a : &b);
  }

  /// At a zero |jump| becomes smaller, at a pole larger.
  void bracket(JumpAtTime a, JumpAtTime b) {
    if (!differ(a, b)) return;
    const double least = std::min(std::abs(a.jump), std::abs(b.jump));
    for (int k = 0; k < bisections; ++k) {
      std::optional<JumpAtTime> middle = between(a, b);
      if (!middle) return;
      (differ(a, *middle) ? b : a) = *std::move(middle);
    }
    JumpAtTime& nearer = std::abs(a.jump) < std::abs(b.jump) ? a : b;
    if (std::abs(nearer.jump) < least) zeros_.push_back(std::move(nearer));
  }

  /// Of three with one sign, the middle one the least.
  void descend(JumpAtTime a, JumpAtTime b, JumpAtTime c) {
    const auto size = [](const JumpAtTime& x) { return std::abs(x.jump); };
    if (differ(a, b) || differ(b, c) || size(b) > size(a) || size(b) > size(c)) return;
    for (int k = 0; k < descents; ++k) {
      std::optional<JumpAtTime> left = between(a, b), right = between(b, c);
      if (!left || !right) return;
      for (const auto& beside : {left, right})
        if (differ(*beside, b)) {
          bracket(a, *beside);
          return bracket(*beside, c);
        }
      if (size(*left) < size(b) && size(*left) <= size(*right)) {
        c = std::exchange(b, *std::move(left));
      } else if (size(*right) < size(b)) {
        a = std::exchange(b, *std::move(right));
      } else {
        a = *std::move(left);
        c = *std::move(right);
      }
    }
  }

  const SolveAtTime& solve_;
  std::vector<std::optional<JumpAtTime>> samples_;
  std::vector<JumpAtTime> zeros_;
};

}  // namespace

std::vector<JumpAtTime> zeros_of_jump(double from, double to, const SolveAtTime& solve) {
  return JumpScan(solve).run(from, to);
}

}  // namespace extremal
