#include "profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "machine/simd.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/newton/iteration.hpp"
#include "solve/newton/node_system.hpp"
#include "study/study.hpp"

namespace bench {
namespace {

using extremal::Order;
using extremal::Path;

/// Nanoseconds of one call: the least of several means, since whatever else happens only adds.
template <class Call>
double nanoseconds(const Call& call) {
  using Clock = std::chrono::steady_clock;
  const auto time = [&](int calls) {
    const auto start = Clock::now();
    for (int k = 0; k < calls; ++k) call();
    return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  };
  int calls = 1;
  double best = time(1);
  while (best < 2e5) best = time(calls *= 2);
  for (int sample = 0; sample < 15; ++sample) best = std::min(best, time(calls));
  return best / calls;
}

/// Pieces of one damped Newton step that is accepted at once, in nanoseconds.
struct Pieces {
  double points = 0;    ///< q and q' at the quadrature points
  double tape = 0;      ///< L with gradient and Hessian there
  double elements = 0;  ///< the elements' gradients and Hessians, inner unknowns eliminated
  double factor = 0;    ///< of the system of the nodes between elements
  double solve = 0;     ///< that system
  double back = 0;      ///< inner unknowns from the nodes
  double test = 0;      ///< gradient at the new path and simplified step
  double step = 0;      ///< the whole, as NewtonIteration takes it
  double other() const { return step - points - tape - elements - factor - solve - back - test; }
};

/// Elements, degree, and how many iterations of the solve had them.
struct Stage {
  int elements, degree, iterations;
};

std::vector<Stage> stages(const extremal::Solution& solution) {
  std::vector<Stage> result;
  for (const extremal::Iteration& step : solution.history) {
    const bool same =
        !result.empty() && result.back().elements == step.elements && result.back().degree == step.degree;
    if (same)
      ++result.back().iterations;
    else
      result.push_back({step.elements, step.degree, 1});
  }
  return result;
}

/// The trajectory on elements of a stage: its own mesh where the number agrees, else equal elements.
void resample(const extremal::Trajectory& trajectory, const Stage& stage,
              const extremal::ElementTables& tables, Path& path) {
  const std::size_t n = trajectory.coordinates;
  const double duration = trajectory.duration();
  std::vector<double> mesh(stage.elements + 1), q((stage.degree + 1) * n), v(n);
  for (int k = 0; k <= stage.elements; ++k)
    mesh[k] = stage.elements == trajectory.elements() ? trajectory.times[k] / duration
                                                      : static_cast<double>(k) / stage.elements;
  path.reset(tables, mesh, duration);
  for (int k = 0; k < stage.elements; ++k) {
    for (int j = 0; j <= stage.degree; ++j) {
      const double tau = mesh[k] + tables.scheme().lobatto[j] * (mesh[k + 1] - mesh[k]);
      trajectory.at(std::min(tau, 1.0) * duration, {q.data() + j * n, n}, v);
    }
    path.set_element(k, q.data());
  }
  path.load_ends();
}

/// The tape alone, over the points of all batches.
double time_tape(const extremal::Lagrangian& lagrangian, const extremal::Trajectory& trajectory,
                 const extremal::ElementTables& tables, int batches) {
  const int count = tables.shape().points * extremal::simd_lanes();
  const std::size_t n = trajectory.coordinates;
  extremal::AlignedDoubles q(n * count), v(n * count), t(count),
      out(static_cast<std::size_t>(lagrangian.rows(Order::hessian)) * count);
  std::vector<double> here(n), speed(n);
  for (int i = 0; i < count; ++i) {
    t[i] = trajectory.duration() * i / count;
    trajectory.at(t[i], here, speed);
    for (std::size_t a = 0; a < n; ++a) q[a * count + i] = here[a], v[a * count + i] = speed[a];
  }
  extremal::Scratch scratch;
  const extremal::Points points{count, count, q.data(), v.data(), t.data()};
  return batches * nanoseconds([&] { lagrangian.evaluate(points, Order::hessian, out.data(), scratch); });
}

Pieces time_pieces(const extremal::Problem& problem, const extremal::Trajectory& trajectory,
                   const extremal::ElementTables& tables, Path& path, extremal::NewtonIteration& newton) {
  Pieces p;
  extremal::DiscreteAction& action = newton.action();
  const extremal::ClosingEquation* closing = newton.closing(path);
  extremal::NodeSystem system;
  extremal::Step step;
  system.reset(problem.ends, path.elements(), path.coordinates(), problem.duration.free);
  p.tape = time_tape(*problem.lagrangian, trajectory, tables, path.batches());
  const double rows = nanoseconds([&] {
    for (int b = 0; b < path.batches(); ++b) action.rows(path, b, Order::hessian);
  });
  p.points = rows - p.tape;
  p.elements = nanoseconds([&] { action.evaluate(path); }) - rows;
  p.factor = nanoseconds([&] { system.factor(action.nodes, closing); });
  p.solve = nanoseconds([&] { system.solve(action.nodes, closing, step.nodes, step.duration); });
  p.back = nanoseconds([&] { action.expand_step(step.nodes, step.duration, step.inner); });
  p.test = nanoseconds([&] { action.evaluate_gradient(path); }) + p.solve + p.back;
  return p;
}

void print_line(const Stage& stage, const Pieces& p) {
  fmt::print("{:>8}{:>7}{:>6} |", stage.elements, stage.degree, stage.iterations);
  for (double piece : {p.points, p.tape, p.elements, p.factor, p.solve, p.back, p.test, p.other()})
    fmt::print("{:>9}", p.tape > 0 ? fmt::format("{:.0f}", piece) : "-");
  fmt::print(" |{:>10.0f}\n", p.step);
}

void print_shares(const Pieces& p) {
  if (!(p.tape > 0)) {
    fmt::print(
        "its elements are large: the Hessian is held as one sparse matrix, which is not taken apart\n");
    return;
  }
  const auto share = [&](double piece) { return 100 * piece / p.step; };
  fmt::print(
      "a step on the last elements: evaluation {:.0f} %, assembly and condensation {:.0f} %, nodes "
      "{:.0f} %, test of the step {:.0f} %, rest {:.0f} %\n",
      share(p.points + p.tape), share(p.elements), share(p.factor + p.solve + p.back), share(p.test),
      share(p.other()));
}

/// Guess and error estimate, once each.
struct Frame {
  double guess = 0, estimate = 0;
};
Frame print_frame(const extremal::Problem& problem, const extremal::ElementTables& tables, const Path& path) {
  extremal::Resolution resolution;
  Path start;
  const std::vector<double> mesh(path.mesh().begin(), path.mesh().end());
  const double guess = nanoseconds([&] {
    const std::vector<double> ends = extremal::starting_ends(problem);
    start.reset(tables, mesh, problem.duration.value);
    extremal::start_path(problem, ends, tables, start);
  });
  const double estimate = nanoseconds([&] {
    extremal::scales(path, tables);
    resolution.measure(path, tables);
  });
  fmt::print("once on the last elements: guess {:.0f} ns, error estimate {:.0f} ns\n", guess, estimate);
  return {guess, estimate};
}

}  // namespace

void print_profile(const std::string& name, const std::string& scene, double tolerance) {
  extremal::Study study = extremal::load(scene);
  study.options.tolerance = tolerance;
  extremal::Solution solution = extremal::run(study);
  if (!solution.converged()) {
    fmt::print("\n{} at {:.0e}: {}\n", name, tolerance, solution.message);
    return;
  }
  const int repeats = std::clamp(static_cast<int>(0.1 / solution.seconds_solve), 1, 1001);
  solution = extremal::run(study, repeats);
  const double whole = 1e9 * solution.seconds_solve;
  fmt::print("\n{} at {:.0e}: {:.1f} µs; nanoseconds of one Newton step:\n", name, tolerance, 1e-3 * whole);
  fmt::print("elements degree steps |{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9} |{:>10}\n", "points", "tape",
             "elements", "factor", "solve", "back", "test", "other", "step");
  extremal::Levels levels;
  levels.bind(study.problem.lagrangian);
  extremal::NewtonIteration newton;
  Path path;
  const extremal::ElementTables* tables = nullptr;
  Pieces pieces;
  double steps = 0;
  for (const Stage& stage : stages(solution)) {
    tables = &levels.at(stage.degree);
    resample(solution.trajectory, stage, *tables, path);
    newton.reset(study.problem, *tables, stage.elements);
    newton.set_scale(1);
    newton.full_step(path, 0);
    const bool condensed = tables->unknowns() <= extremal::most_dense_unknowns;
    pieces = condensed ? time_pieces(study.problem, solution.trajectory, *tables, path, newton) : Pieces();
    pieces.step = nanoseconds([&] { newton.full_step(path, 0); });
    steps += stage.iterations * pieces.step;
    print_line(stage, pieces);
  }
  print_shares(pieces);
  const Frame frame = print_frame(study.problem, *tables, path);
  fmt::print(
      "steps {:.0f} %, guess {:.0f} %, error estimate {:.0f} % of the solve; a step that keeps its factors "
      "costs "
      "less than counted here\n",
      100 * steps / whole, 100 * frame.guess / whole, 100 * frame.estimate / whole);
}

}  // namespace bench
