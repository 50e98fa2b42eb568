#pragma once

namespace extremal {

/// How often this thread has allocated so far: the test program replaces operator new.
long allocations();

}  // namespace extremal
