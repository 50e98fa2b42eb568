#include "machine/workers.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

namespace extremal {

namespace {

constexpr int most_threads = 1024;

int chosen_threads() {
  const char* const text = std::getenv("EXTREMAL_THREADS");
  if (!text || !*text)
    return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, most_threads);
  char* end = nullptr;
  const long count = std::strtol(text, &end, 10);
  if (*end != 0 || count < 1 || count > most_threads)
    throw std::runtime_error("EXTREMAL_THREADS=" + std::string(text) + ": need a number from 1 to 1024");
  return static_cast<int>(count);
}

/// Work that comes again soon is spun for, about as long as sleeping and waking take; later work wakes.
constexpr int most_spins = 1000;

void wait_while(const std::atomic<unsigned>& value, unsigned old) {
  for (int spin = 0; spin < most_spins; ++spin) {
    if (value.load(std::memory_order_acquire) != old) return;
    __builtin_ia32_pause();
  }
  value.wait(old, std::memory_order_acquire);
}

/// Lives as long as the process: its threads sleep until that ends.
class Workers {
 public:
  Workers() {
    for (int thread = 1; thread < threads(); ++thread)
      std::thread([this, thread] { serve(thread); }).detach();
  }

  bool try_run(int count, void (*work)(const void*, int, int), const void* context) {
    const std::unique_lock held(mutex_, std::try_to_lock);
    if (!held || getpid() != process_) return false;
    count_ = count;
    work_ = work;
    context_ = context;
    busy_.store(threads() - 1, std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
    do_share(0);
    while (const unsigned left = busy_.load(std::memory_order_acquire)) wait_while(busy_, left);
    return true;
  }

 private:
  void do_share(int thread) const {
    const long first = long{count_} * thread / threads(), last = long{count_} * (thread + 1) / threads();
    for (long piece = first; piece < last; ++piece) work_(context_, thread, static_cast<int>(piece));
  }
  void serve(int thread) {
    for (unsigned round = 0;; ++round) {
      wait_while(round_, round);
      do_share(thread);
      if (busy_.fetch_sub(1, std::memory_order_release) == 1) busy_.notify_one();
    }
  }

  const pid_t process_ = getpid();
  std::mutex mutex_;
  std::atomic<unsigned> round_ = 0, busy_ = 0;
  int count_ = 0;
  void (*work_)(const void*, int, int) = nullptr;
  const void* context_ = nullptr;
};

}  // namespace

int threads() {
  static const int count = chosen_threads();
  return count;
}

void share_out(int count, void (*work)(const void*, int, int), const void* context) {
  if (threads() > 1 && count > 1) {
    static Workers& workers = *new Workers;
    if (workers.try_run(count, work, context)) return;
  }
  for (int piece = 0; piece < count; ++piece) work(context, 0, piece);
}

}  // namespace extremal
