#include "python/run.hpp"

namespace extremal::python {

bool Interruptible::check_signals() {
  const py::gil_scoped_acquire lock;
  keep_error([] {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  });
  return stopped_;
}

bool Interruptible::poll(void* self) {
  auto& run = *static_cast<Interruptible*>(self);
  if (run.stopped_) return true;
  const Clock::time_point now = Clock::now();
  if (now < run.next_) return false;
  run.next_ = now + interval;
  return run.check_signals();
}

}  // namespace extremal::python
