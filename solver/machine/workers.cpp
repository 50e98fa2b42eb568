#include "machine/workers.hpp"

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

namespace extremal {

namespace {

constexpr int most_threads = 1024;

int chosen_threads() {
  const char* const text = std::getenv("EXTREMAL_THREADS");
  if (!text || !*text) return 1;
  char* end = nullptr;
  const long count = std::strtol(text, &end, 10);
  if (*end != 0 || count < 1 || count > most_threads)
    throw std::runtime_error("EXTREMAL_THREADS=" + std::string(text) + ": need a number from 1 to 1024");
  return static_cast<int>(count);
}

using Work = void (*)(const void* context, int thread, int piece);

/// Work that comes again soon is spun for, about as long as sleeping and waking take; later work wakes.
constexpr int most_spins = 1000;

/// Tells the processor that this is a loop of waiting.
inline void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

template <class T>
void wait_while(const std::atomic<T>& value, T old) {
  for (int spin = 0; spin < most_spins; ++spin) {
    if (value.load(std::memory_order_acquire) != old) return;
    relax();
  }
  value.wait(old, std::memory_order_acquire);
}

/// Threads take piece after piece, so that one which sleeps or has lost its core keeps nobody waiting but for
/// the piece it is at. Lives as long as the process.
class Workers {
 public:
  Workers() {
    for (int thread = 1; thread < threads(); ++thread)
      std::thread([this, thread] { serve(thread); }).detach();
  }

  bool try_run(int count, Work work, const void* context) {
    if (getpid() != process_ || taken_.test_and_set(std::memory_order_acquire)) return false;
    work_.store(work, std::memory_order_relaxed);
    context_.store(context, std::memory_order_relaxed);
    count_.store(count, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    const unsigned round = round_.load(std::memory_order_relaxed) + 1;
    ticket_.store(std::uint64_t{round} << 32, std::memory_order_release);
    round_.store(round, std::memory_order_release);
    round_.notify_all();
    do_pieces(round, 0);
    for (int done; (done = done_.load(std::memory_order_acquire)) < count;) wait_while(done_, done);
    taken_.clear(std::memory_order_release);
    return true;
  }

 private:
  void serve(int thread) {
    for (unsigned seen = 0;;) {
      wait_while(round_, seen);
      seen = round_.load(std::memory_order_acquire);
      do_pieces(seen, thread);
    }
  }
  /// A ticket is the round and the next piece of it. That it is taken as it was read shows that the work
  /// read with it is that round's.
  void do_pieces(unsigned round, int thread) {
    std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
    while (ticket >> 32 == round) {
      const int piece = static_cast<int>(ticket), count = count_.load(std::memory_order_relaxed);
      const Work work = work_.load(std::memory_order_relaxed);
      const void* const context = context_.load(std::memory_order_relaxed);
      if (piece >= count) return;
      if (!ticket_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel)) continue;
      work(context, thread, piece);
      if (done_.fetch_add(1, std::memory_order_release) + 1 == count) done_.notify_one();
      ticket = ticket_.load(std::memory_order_acquire);
    }
  }

  const pid_t process_ = getpid();
  std::atomic_flag taken_;
  std::atomic<unsigned> round_ = 0;
  std::atomic<std::uint64_t> ticket_ = 0;
  std::atomic<int> count_ = 0, done_ = 0;
  std::atomic<Work> work_ = nullptr;
  std::atomic<const void*> context_ = nullptr;
};

}  // namespace

int threads() {
  static const int count = chosen_threads();
  return count;
}

void share_out(int count, Work work, const void* context) {
  if (threads() > 1 && count > 1) {
    static Workers& workers = *new Workers;
    if (workers.try_run(count, work, context)) return;
  }
  for (int piece = 0; piece < count; ++piece) work(context, 0, piece);
}

}  // namespace extremal
