#include "report/interrupts.hpp"

#include <iterator>

namespace extremal {
namespace {

/// A handler has no other argument than the signal.
volatile std::sig_atomic_t noted = 0;

extern "C" void note_signal(int signal) { noted = signal; }

}  // namespace

HeldInterrupts::HeldInterrupts() {
  noted = 0;
  for (std::size_t k = 0; k < std::size(signals); ++k) {
    struct sigaction action = {};
    action.sa_handler = signals[k] == SIGPIPE ? SIG_IGN : note_signal;
    sigemptyset(&action.sa_mask);
    sigaction(signals[k], nullptr, &before_[k]);
    // What the parent has the process ignore, as nohup does, stays ignored.
    if (before_[k].sa_handler != SIG_IGN) sigaction(signals[k], &action, nullptr);
  }
}

HeldInterrupts::~HeldInterrupts() {
  for (std::size_t k = 0; k < std::size(signals); ++k) sigaction(signals[k], &before_[k], nullptr);
  if (const int signal = noted) raise(signal);
}

void HeldInterrupts::check() {
  if (noted) throw Interrupted{};
}

}  // namespace extremal
