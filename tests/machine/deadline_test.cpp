#include "machine/deadline.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

namespace extremal {
namespace {

TEST(Deadline, PassesAfterItsSeconds) {
  const Deadline soon(0.05), never, endless(INFINITY);
  EXPECT_FALSE(soon.passed());
  EXPECT_LE(soon.seconds_left(), 0.05 + 0.01);
  std::this_thread::sleep_for(std::chrono::milliseconds(80));
  EXPECT_TRUE(soon.passed());
  EXPECT_EQ(soon.seconds_left(), 0);
  for (const Deadline& other : {never, endless}) {
    EXPECT_FALSE(other.passed());
    EXPECT_TRUE(std::isinf(other.seconds_left()));
  }
  EXPECT_TRUE(Deadline(0).share(0.5).passed() || Deadline(0).seconds_left() < 0.01);
}

TEST(Deadline, IsSharedAndNamed) {
  const Deadline whole(100);
  EXPECT_NEAR(whole.share(0.25).seconds_left(), 25, 0.1);
  EXPECT_EQ(whole.share(0.25).budget_text(), "the budget of 100 s");
  EXPECT_NEAR(whole.or_earlier(Deadline(10)).seconds_left(), 10, 0.1);
  EXPECT_NEAR(Deadline().or_earlier(whole).seconds_left(), 100, 0.1);
  EXPECT_NEAR(whole.or_earlier(Deadline()).seconds_left(), 100, 0.1);
}

TEST(Deadline, PassesWhereItIsStopped) {
  bool stopped = false;
  const auto stop = [](void* context) { return *static_cast<bool*>(context); };
  const Deadline never = Deadline().or_stopped(stop, &stopped),
                 later = Deadline(100).or_stopped(stop, &stopped);
  const Deadline both = later.or_earlier(Deadline(50)), other = Deadline(50).or_earlier(later);
  for (const Deadline& each : {never, later, both, other, later.share(0.5)}) EXPECT_FALSE(each.passed());
  EXPECT_NEAR(both.seconds_left(), 50, 0.1);
  EXPECT_NEAR(other.seconds_left(), 50, 0.1);
  stopped = true;
  for (const Deadline& each : {never, later, both, other, later.share(0.5)}) EXPECT_TRUE(each.passed());
}

TEST(Deadline, IsAskedInNanoseconds) {
  const Deadline whole(100);
  const auto begin = std::chrono::steady_clock::now();
  int passed = 0;
  for (int k = 0; k < 1'000'000; ++k) passed += whole.passed();
  EXPECT_EQ(passed, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

}  // namespace
}  // namespace extremal
