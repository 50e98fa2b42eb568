#include "machine/workers.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <thread>
#include <vector>

namespace extremal {
namespace {

[[maybe_unused]] const int chosen = ::setenv("EXTREMAL_THREADS", "3", 1);

TEST(Workers, DoEachPieceOnce) {
  ASSERT_EQ(threads(), 3);
  for (const int count : {0, 1, 2, 3, 7, 100, 1000}) {
    std::vector<int> done(count, 0), by(count, -1);
    share_out(count, [&](int thread, int piece) {
      ++done[piece];
      by[piece] = thread;
    });
    for (int piece = 0; piece < count; ++piece) {
      EXPECT_EQ(done[piece], 1) << piece << " of " << count;
      EXPECT_LT(by[piece], threads());
      EXPECT_GE(by[piece], 0);
    }
  }
}

TEST(Workers, ComeBackAtOnceAndAfterSleep) {
  std::atomic<long> sum = 0;
  for (int round = 0; round < 2000; ++round) {
    share_out(8, [&](int, int piece) { sum += piece; });
    if (round % 500 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(sum, 2000 * 28);
}

/// Work may share out work of its own, and other callers may come at the same time.
TEST(Workers, ServeOneCallerAtATime) {
  std::atomic<int> inner = 0;
  share_out(4, [&](int, int) { share_out(5, [&](int, int) { ++inner; }); });
  EXPECT_EQ(inner, 20);
  std::atomic<int> both = 0;
  const auto call = [&] {
    for (int round = 0; round < 200; ++round) share_out(6, [&](int, int) { ++both; });
  };
  std::thread other(call);
  call();
  other.join();
  EXPECT_EQ(both, 2 * 200 * 6);
}

TEST(Workers, AreLeftBehindByAFork) {
  share_out(4, [](int, int) {});
  const pid_t child = ::fork();
  if (child == 0) {
    int done = 0;
    share_out(4, [&](int thread, int) { done += thread == 0; });
    ::_exit(done);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 4);
}

}  // namespace
}  // namespace extremal
