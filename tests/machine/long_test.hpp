#pragma once

#include <gtest/gtest.h>

#include <cstdlib>

#include "machine/sanitizer.hpp"

/// \file Tests that run for seconds in a release build by repeating what short tests run once.

namespace extremal::test {

/// They run for minutes under sanitizers, and again at each instruction set that is asked for.
inline bool long_tests() {
  return std::getenv("EXTREMAL_LONG_TESTS") || !(EXTREMAL_ADDRESS_SANITIZER || std::getenv("EXTREMAL_SIMD"));
}

}  // namespace extremal::test

/// First in such a test.
#define LONG_TEST() \
  if (!extremal::test::long_tests()) GTEST_SKIP() << "long; EXTREMAL_LONG_TESTS=1 runs it"
