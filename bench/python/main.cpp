#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "study/study.hpp"

// What Python costs: a call of solve() beside Solver::solve(), and solve_many() beside a loop in C++, one
// thread each. Both take turns in one run, and the best turn of each counts.

namespace bench {
namespace {

using namespace extremal;
using Clock = std::chrono::steady_clock;

constexpr int calls = 3000, arcs = 5000, warm = 20, turns = 5;

/// The same numbers from both languages.
struct Measured {
  double one = INFINITY, many = INFINITY;  ///< seconds of a call, of all arcs
  double action = 0, actions = 0;
  int converged = 0;

  void keep_best(const Measured& other) {
    const double best_one = std::min(one, other.one), best_many = std::min(many, other.many);
    *this = other;
    one = best_one;
    many = best_many;
  }
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

Measured in_cpp(const std::string& scene) {
  const Study study = load(scene, {}, Purpose::solution);
  Solver solver;
  Measured found;
  for (int k = 0; k < warm; ++k) solver.solve(study.problem, study.options);
  Clock::time_point begin = Clock::now();
  for (int k = 0; k < calls; ++k) found.action = solver.solve(study.problem, study.options).action;
  found.one = seconds_since(begin) / calls;

  Problem problem = study.problem;
  begin = Clock::now();
  for (int k = 0; k < arcs; ++k) {
    const double angle = 0.5 + 2.0 * k / (arcs - 1);
    const std::array end{std::cos(angle), std::sin(angle)};
    for (const Triplet& each : problem.boundary.matrix)
      if (each.column >= 2) {
        problem.boundary.value[each.row] = end[each.column - 2];
        problem.ends.offset[each.column] = end[each.column - 2];
      }
    const Solution arc = solver.solve(problem, study.options);
    found.converged += arc.converged();
    if (arc.converged()) found.actions += arc.action;
  }
  found.many = seconds_since(begin);
  return found;
}

Measured in_python(const std::string& scene) {
  const std::string command =
      fmt::format("PYTHONPATH='{0}' '{1}' '{2}/bench/python/calls.py' '{3}' {4} {5}", EXTREMAL_PYTHON_MODULE,
                  EXTREMAL_PYTHON_PROGRAM, EXTREMAL_SOURCE_DIR, scene, calls, arcs);
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (!pipe) throw std::runtime_error("cannot start " + command);
  std::string text;
  for (int c; (c = std::fgetc(pipe.get())) != EOF;) text += static_cast<char>(c);
  const nlohmann::json read = nlohmann::json::parse(text, nullptr, false);
  if (!read.is_object()) throw std::runtime_error("no numbers from " + command);
  return {read.at("one"), read.at("many"), read.at("action"), read.at("actions"), read.at("converged")};
}

void measure() {
  const std::string scene = std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/kepler.toml";
  Measured cpp, python;
  for (int turn = 0; turn < turns; ++turn) {
    cpp.keep_best(in_cpp(scene));
    python.keep_best(in_python(scene));
  }
  if (cpp.action != python.action || cpp.converged != python.converged ||
      std::abs(cpp.actions - python.actions) > 1e-9 * std::abs(cpp.actions))
    throw std::runtime_error("both must find the same arcs");
  fmt::print("one arc:    C++ {:.1f} us, Python {:.1f} us: {:.1f} us of a call are Python's\n", 1e6 * cpp.one,
             1e6 * python.one, 1e6 * (python.one - cpp.one));
  fmt::print("{} arcs: C++ {:.1f} ms, solve_many {:.1f} ms: {:.2f} of its rate\n", arcs, 1e3 * cpp.many,
             1e3 * python.many, cpp.many / python.many);
}

}  // namespace
}  // namespace bench

int main() {
  try {
    bench::measure();
  } catch (const std::exception& e) {
    fmt::print(stderr, "bench_python: {}\n", e.what());
    return 1;
  }
}
