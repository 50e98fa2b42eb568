#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <stdexcept>
#include <thread>

#include "python/run.hpp"
#include "python/study.hpp"

/// \file One problem after another that differ in their ends and durations, in several threads.

namespace extremal::python {
namespace {

constexpr int together = 8;                      ///< problems that a thread takes at a time
constexpr std::chrono::milliseconds glance{20};  ///< between looks for Ctrl-C

/// An end of the scene that rows replace: where each coordinate's value stands in the relation.
struct ReplacedEnd {
  const double* values = nullptr;  ///< (m, n); null: not replaced
  std::vector<int> rows;           ///< of the relation, one a coordinate
  int first = 0;                   ///< of the end's coordinates in EndMap
};

ReplacedEnd replaced_end(const Problem& problem, const double* values, bool at_end) {
  ReplacedEnd end{values, {}, at_end ? problem.coordinates() : 0};
  if (!values) return end;
  std::vector<int> entries(problem.boundary.rows, 0);
  for (const Triplet& each : problem.boundary.matrix) ++entries[each.row];
  end.rows.assign(problem.coordinates(), -1);
  for (const Triplet& each : problem.boundary.matrix) {
    const int a = each.column - end.first;
    if (a >= 0 && a < problem.coordinates() && entries[each.row] == 1 && each.value == 1)
      end.rows[a] = each.row;
  }
  if (std::count(end.rows.begin(), end.rows.end(), -1) > 0)
    throw std::invalid_argument(
        fmt::format("every coordinate must be fixed at the {}, to be replaced", at_end ? "end" : "start"));
  return end;
}

void replace(const ReplacedEnd& end, std::size_t row, Problem& problem) {
  if (!end.values) return;
  const std::size_t n = problem.coordinates();
  for (std::size_t a = 0; a < n; ++a) {
    const double x = end.values[row * n + a];
    problem.boundary.value[end.rows[a]] = x;
    problem.ends.offset[end.first + a] = x;
    if (problem.initial && end.first == 0) problem.initial->q[a] = x;
  }
}

/// What is kept of each solution. Nothing but the status is set where it has not converged.
struct Kept {
  std::size_t coordinates;
  double *q, *momenta, *action, *energy, *error, *duration;
  bool* energy_known;
  int *status, *index, *iterations;

  void keep(std::size_t row, const Solution& s) const {
    status[row] = static_cast<int>(s.status);
    iterations[row] = s.iterations;
    if (!s.converged()) return;
    const std::size_t n = coordinates, from = 2 * n * row;
    const std::vector<double>& nodes = s.trajectory.nodes;
    std::copy_n(nodes.begin(), n, q + from);
    std::copy_n(nodes.end() - static_cast<std::ptrdiff_t>(n), n, q + from + n);
    // Where L is infinite at an end there is no momentum.
    std::fill_n(momenta + from, 2 * n, std::numeric_limits<double>::quiet_NaN());
    std::copy_n(s.momentum_start.begin(), std::min(n, s.momentum_start.size()), momenta + from);
    std::copy_n(s.momentum_end.begin(), std::min(n, s.momentum_end.size()), momenta + from + n);
    action[row] = s.action;
    energy[row] = s.energy.value_or(0);
    energy_known[row] = s.energy.has_value();
    error[row] = s.error_estimate;
    duration[row] = s.duration();
    index[row] = s.morse_index.value_or(-1);
  }
};

/// What a thread keeps from row to row.
struct Worker {
  Problem problem;
  SolveOptions options;
  Solver solver = {};
};

/// Threads that take rows until none is left or one of them has thrown.
class Rows {
 public:
  Rows(std::size_t count, const Problem& problem, const SolveOptions& options,
       std::function<void(std::size_t row, Worker&)> solve)
      : count_(count), problem_(problem), options_(options), solve_(std::move(solve)) {}

  /// Without the lock of Python. Looks for Ctrl-C meanwhile.
  void run(int threads, Interruptible& work) {
    for (int k = 0; k < threads; ++k) threads_.emplace_back([this] { serve(); });
    {
      std::unique_lock lock(mutex_);
      while (!ended_.wait_for(lock, glance, [&] { return done_ == threads; })) {
        lock.unlock();
        if (work.check_signals()) stop_ = true;
        lock.lock();
      }
    }
    for (std::thread& thread : threads_) thread.join();
    if (error_) std::rethrow_exception(error_);
  }

  /// For deadlines.
  static bool stopped(void* self) { return static_cast<const Rows*>(self)->stop_; }

 private:
  void serve() {
    std::exception_ptr error;
    try {
      Worker worker{problem_, options_};
      for (std::size_t first; !stop_ && (first = next_.fetch_add(together)) < count_;)
        for (std::size_t row = first; row < std::min(first + together, count_) && !stop_; ++row)
          solve_(row, worker);
    } catch (...) {
      error = std::current_exception();
      stop_ = true;
    }
    const std::lock_guard lock(mutex_);
    if (error) error_ = error;
    ++done_;
    ended_.notify_one();
  }

  std::size_t count_;
  const Problem& problem_;
  const SolveOptions& options_;
  std::function<void(std::size_t, Worker&)> solve_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable ended_;
  int done_ = 0;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

/// Rows of what is given, all alike; throws std::invalid_argument.
std::size_t rows_of(const std::optional<Doubles>& start, const std::optional<Doubles>& end,
                    const std::optional<Doubles>& duration, int coordinates) {
  std::optional<std::size_t> rows;
  const auto add = [&](const std::optional<Doubles>& array, const char* name, int dimensions) {
    if (!array) return;
    if (array->ndim() != dimensions || (dimensions == 2 && array->shape(1) != coordinates))
      throw std::invalid_argument(dimensions == 2
                                      ? fmt::format("{} must have the shape (m, {})", name, coordinates)
                                      : fmt::format("{} must have the shape (m,)", name));
    const std::size_t count = array->shape(0);
    if (rows && *rows != count)
      throw std::invalid_argument(fmt::format("{} has {} rows, not {}", name, count, *rows));
    rows = count;
    const double* bad = std::find_if_not(array->data(), array->data() + array->size(),
                                         [](double x) { return std::isfinite(x); });
    if (bad != array->data() + array->size())
      throw std::invalid_argument(
          fmt::format("{}: the number at position {} is not finite", name, bad - array->data()));
  };
  add(start, "start", 2);
  add(end, "end", 2);
  add(duration, "duration", 1);
  if (duration) {
    const double* bad = std::find_if_not(duration->data(), duration->data() + duration->size(),
                                         [](double x) { return x > 0; });
    if (bad != duration->data() + duration->size())
      throw std::invalid_argument(
          fmt::format("duration[{}] = {}; need more than 0", bad - duration->data(), *bad));
  }
  if (!rows) throw std::invalid_argument("give start, end or duration");
  return *rows;
}

const double* data(const std::optional<Doubles>& array) { return array ? array->data() : nullptr; }

}  // namespace

py::dict PyStudy::solve_many(const std::optional<Doubles>& start, const std::optional<Doubles>& end,
                             const std::optional<Doubles>& duration, std::optional<double> tolerance,
                             int threads) const {
  const Problem& scene = study_->problem;
  if (scene.phase)
    throw std::invalid_argument(
        "solve_many needs a Hamiltonian whose second derivative by the momenta is regular; solve one by one");
  const py::ssize_t n = scene.coordinates();
  const py::ssize_t m = static_cast<py::ssize_t>(rows_of(start, end, duration, scene.coordinates()));
  if (threads < 1) throw std::invalid_argument(fmt::format("threads = {}; need at least 1", threads));
  if (duration && scene.duration.free)
    throw std::invalid_argument("the duration is free in the scene; give no durations");
  const ReplacedEnd from = replaced_end(scene, data(start), false), to = replaced_end(scene, data(end), true);
  const double* const durations = data(duration);

  const auto zeros = [](std::vector<py::ssize_t> shape) {
    py::array_t<double> array(std::move(shape));
    std::fill_n(array.mutable_data(), array.size(), 0.0);
    return array;
  };
  py::array_t<double> q = zeros({m, 2, n}), momenta = zeros({m, 2, n}), action = zeros({m}),
                      energy = zeros({m}), error = zeros({m}), times = zeros({m});
  py::array_t<int> status(m), index(m), iterations(m);
  py::array_t<bool> energy_known(m);
  std::fill_n(energy_known.mutable_data(), m, false);
  std::fill_n(index.mutable_data(), m, -1);
  const Kept kept{static_cast<std::size_t>(n), q.mutable_data(),
                  momenta.mutable_data(),      action.mutable_data(),
                  energy.mutable_data(),       error.mutable_data(),
                  times.mutable_data(),        energy_known.mutable_data(),
                  status.mutable_data(),       index.mutable_data(),
                  iterations.mutable_data()};

  SolveOptions options = study_->options;
  if (tolerance) options.tolerance = *tolerance;
  Interruptible work;
  {
    const py::gil_scoped_release unlocked;
    Rows* all = nullptr;
    Rows rows(m, scene, options, [&](std::size_t row, Worker& worker) {
      auto& [problem, each, solver] = worker;
      replace(from, row, problem);
      replace(to, row, problem);
      if (durations) problem.duration.value = durations[row];
      if (problem.copies) problem = make_problem(std::move(problem));
      each.deadline = Deadline(study_->budget).or_stopped(Rows::stopped, all);
      kept.keep(row, solver.solve(problem, each));
    });
    all = &rows;
    rows.run(static_cast<int>(std::min<py::ssize_t>(threads, std::max<py::ssize_t>(m, 1))), work);
  }
  work.raise_error();

  py::dict result;
  result["q"] = q;
  result["momenta"] = momenta;
  result["action"] = action;
  result["energy"] = energy;
  result["energy_known"] = energy_known;
  result["error_estimate"] = error;
  result["duration"] = times;
  result["status"] = status;
  result["index"] = index;
  result["iterations"] = iterations;
  return result;
}

}  // namespace extremal::python
