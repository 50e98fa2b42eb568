#pragma once

/// \file Threads that wait for work which comes in many equal pieces.

namespace extremal {

/// Threads of work to go on at once, the caller's included: what EXTREMAL_THREADS says, or one. Throws
/// std::runtime_error if that is not a number from 1 to 1024.
int threads();

/// Calls work(context, thread, piece) for pieces 0 … count − 1, 0 <= thread < threads(), and returns when all
/// are done; which thread does which may differ each time. Work must not throw. The threads are started when
/// first needed and belong to one caller at a time: all is done by the thread that calls where another has
/// them, and in a process forked from theirs.
void share_out(int count, void (*work)(const void* context, int thread, int piece), const void* context);

/// The same for any callable.
template <class Work>
void share_out(int count, const Work& work) {
  share_out(
      count,
      [](const void* context, int thread, int piece) { (*static_cast<const Work*>(context))(thread, piece); },
      &work);
}

}  // namespace extremal
