#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <functional>
#include <utility>

#include "machine/deadline.hpp"

/// \file Work without Python's lock that Python can still end: by Ctrl-C, or by an exception of a callback.

namespace extremal::python {

namespace py = pybind11;

/// Lives in one thread, which holds the lock where it is made and where it ends. Neither copied nor moved:
/// deadlines and callbacks point to it.
class Interruptible {
 public:
  Interruptible() = default;
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  /// A deadline that has also passed where the work is to end.
  Deadline deadline(double seconds) { return Deadline(seconds).or_stopped(poll, this); }

  /// Calls `function` with the cast of each value; empty for None. An exception ends the work.
  template <class Value>
  std::function<void(const Value&)> callback(const py::object& function) {
    if (function.is_none()) return {};
    return [this, &function](const Value& value) {
      if (stopped_) return;
      const py::gil_scoped_acquire lock;
      keep_error([&] { function(value); });
    };
  }

  /// What work() returns, which runs without the lock. Throws what Python raised meanwhile.
  template <class Work>
  auto run(Work&& work) {
    auto result = [&] {
      const py::gil_scoped_release unlocked;
      return std::forward<Work>(work)();
    }();
    raise_error();
    return result;
  }

  /// Asks Python now whether to end; the lock is taken.
  bool check_signals();
  bool stopped() const { return stopped_; }
  void raise_error() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds interval{20};  ///< Ctrl-C is answered at once, for a person

  static bool poll(void* self);

  template <class Call>
  void keep_error(Call&& call) {
    try {
      call();
    } catch (...) {
      error_ = std::current_exception();
      stopped_ = true;
    }
  }

  Clock::time_point next_ = Clock::now() + interval;
  bool stopped_ = false;
  std::exception_ptr error_;
};

}  // namespace extremal::python
