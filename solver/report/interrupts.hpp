#pragma once

#include <csignal>

/// \file Interrupts while files are half written.

namespace extremal {

/// Thrown where work ends early because the process is to end.
struct Interrupted {};

/// While it lives, SIGINT, SIGTERM and SIGHUP are noted and SIGPIPE is ignored; at its end the process has
/// its own dispositions again, and a signal that was noted is raised. One at a time.
class HeldInterrupts {
 public:
  HeldInterrupts();
  ~HeldInterrupts();
  HeldInterrupts(const HeldInterrupts&) = delete;
  HeldInterrupts& operator=(const HeldInterrupts&) = delete;

  /// Throws Interrupted where a signal was noted.
  static void check();

 private:
  static constexpr int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};
  struct sigaction before_[4];
};

}  // namespace extremal
