#include "study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "scene/scene.hpp"
#include "study/boundary.hpp"
#include "study/checks.hpp"
#include "study/guess.hpp"
#include "study/memory.hpp"
#include "study/modelling.hpp"
#include "study/suggestion.hpp"

namespace extremal {
namespace {

using Clock = std::chrono::steady_clock;

Method read_method(const Text& text) {
  Method method = Method::newton;
  for (const Method other : {Method::ceres, Method::ipopt})
    if (text.value == name(other)) method = other;
  if (!available(method))
    throw SceneError(position(text, 0),
                     fmt::format("method '{}' is not part of this build; build with -DEXTREMAL_{}=ON",
                                 text.value, method == Method::ceres ? "CERES" : "IPOPT"));
  return method;
}

SolveOptions read_options(const SolveTable& table) {
  SolveOptions options;
  if (table.method) options.method = read_method(*table.method);
  if (table.tolerance) options.tolerance = table.tolerance->value;
  if (table.elements) options.elements = static_cast<int>(table.elements->value);
  if (!table.scheme) return options;
  try {
    options.scheme = scheme(table.scheme->value);
  } catch (const std::invalid_argument& e) {
    throw SceneError(position(*table.scheme, 0), e.what());
  }
  return options;
}

Problem read_problem(const Scene& scene, const System& system) {
  Problem problem;
  problem.lagrangian = system.lagrangian;
  problem.names = system.names;
  problem.periodic = scene.boundary.periodic;
  if (scene.system.curvature) problem.curvature = scene.system.curvature->value;
  set_relation(scene.boundary, system, problem);
  problem.duration = read_duration(scene.boundary, system);
  read_guess(scene, system, problem);
  try {
    problem = make_problem(std::move(problem));
  } catch (const std::invalid_argument& e) {
    throw SceneError(scene.boundary.at, e.what());
  }
  check_regular(problem, scene.system.lagrangian->at);
  check_guess_finite(problem, scene.guess.at);
  if (!scene.boundary.map.empty())
    check_symmetry(read_closure(scene.boundary, system), problem, scene.boundary.map.front().name_at);
  return problem;
}

Study load_checked(const std::string& path, const std::vector<std::string>& sets) {
  const Scene scene = read_scene(path, sets);
  Study study;
  study.scene = path;
  study.title = scene.title;
  study.system = make_system(scene.system);
  study.options = read_options(scene.solve);
  if (scene.search) study.solutions = static_cast<int>(scene.search->solutions.value);
  study.problem = read_problem(scene, study.system);
  if (scene.spectrum) study.spectrum = read_spectrum(*scene.spectrum, path, study.problem.names);
  if (scene.continuation) study.continuation = read_continued(scene, study.system, study.problem);
  return study;
}

/// Refuses what would not fit into memory. Without a scheme, the least that a solve begins with.
void check_memory(const Study& study) {
  const int n = study.problem.coordinates(), elements = std::max(study.options.elements, 1);
  const int degree = study.options.scheme ? study.options.scheme->degree : 2;
  const double needed = solve_bytes(study.problem.lagrangian->structure(), elements, degree);
  const double available = available_bytes();
  if (needed > available)
    throw std::length_error(
        fmt::format("{}: {} coordinates and {} elements of degree {} need {} of memory; {} are available",
                    study.scene, n, elements, degree, byte_text(needed), byte_text(available)));
}

/// What solve() returns the last time, with the medians of the times it took.
template <class Solve>
std::vector<Solution> repeated(const Study& study, int repeat, const Solve& solve) {
  if (repeat < 1) throw std::invalid_argument(fmt::format("repeat = {}; need at least 1", repeat));
  check_memory(study);
  std::vector<Solution> solutions;
  std::vector<std::vector<double>> solving, analysing;  // for each solution, of each time
  for (int k = 0; k < repeat; ++k) {
    solutions = solve();
    solving.resize(solutions.size());
    analysing.resize(solutions.size());
    for (std::size_t i = 0; i < solutions.size(); ++i) {
      solving[i].push_back(solutions[i].seconds_solve);
      analysing[i].push_back(solutions[i].seconds_analyse);
    }
  }
  for (std::size_t i = 0; i < solutions.size(); ++i) {
    solutions[i].seconds_solve = median(std::move(solving[i]));
    solutions[i].seconds_analyse = median(std::move(analysing[i]));
  }
  return solutions;
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

Study load(const std::string& path, const std::vector<std::string>& sets) {
  const auto begin = Clock::now();
  Study study = with_suggestion([&] { return load_checked(path, sets); });
  study.seconds_read = std::chrono::duration<double>(Clock::now() - begin).count();
  return study;
}

Solution run(const Study& study, int repeat) {
  Solver solver;
  const auto solve = [&] { return std::vector<Solution>{solver.solve(study.problem, study.options)}; };
  return repeated(study, repeat, solve).front();
}

std::vector<Solution> run_all(const Study& study, int repeat) {
  Solver solver;
  return repeated(study, repeat,
                  [&] { return solver.solve_all(study.problem, study.options, study.solutions); });
}

}  // namespace extremal
