#include "study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>

#include "linear/dense.hpp"
#include "machine/clock.hpp"
#include "machine/simd.hpp"
#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "problem/phase_space.hpp"
#include "problem/recurrence.hpp"
#include "scene/scene.hpp"
#include "solution/extension_values.hpp"
#include "solve/adapt/refinement.hpp"
#include "study/checks/checks.hpp"
#include "study/checks/continuity.hpp"
#include "study/checks/memory.hpp"
#include "study/checks/regularity.hpp"
#include "study/checks/usage.hpp"
#include "study/constraints/constraints.hpp"
#include "study/constraints/limits.hpp"
#include "study/extension.hpp"
#include "study/fitting.hpp"
#include "study/guess/guess.hpp"
#include "study/independent_conditions.hpp"
#include "study/infinite.hpp"
#include "study/minimal/minimal_coordinates.hpp"
#include "study/model/boundary.hpp"
#include "study/model/modelling.hpp"
#include "study/model/naming.hpp"
#include "study/model/unknown_constants.hpp"
#include "study/path_constraints.hpp"
#include "study/phase.hpp"
#include "study/phase_space.hpp"
#include "study/singular_ends.hpp"
#include "study/suggestion.hpp"
#include "system/deferred_lagrangian.hpp"

namespace extremal {
namespace {

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
  options.free_steps = table.steps.has_value();
  if (!table.scheme) return options;
  try {
    options.scheme = scheme(table.scheme->value);
  } catch (const std::invalid_argument& e) {
    throw SceneError(position(*table.scheme, 0), e.what());
  }
  return options;
}

/// What makes motions recur: a map, or the duration.
Location recurrence_location(const BoundaryTable& boundary) {
  return boundary.map.empty() ? boundary.duration.at : boundary.map.front().name_at;
}

/// From initial data there is one motion: nothing is guessed, searched for, closed or continued.
void check_initial_data(const Scene& scene, Purpose purpose) {
  const auto refuse = [](const Location& at, const std::string& what) {
    throw SceneError(at, "'start' gives initial data, every coordinate and every momentum: " + what);
  };
  if (scene.boundary.free)
    refuse(scene.boundary.duration.at, "the duration must be a number, for nothing at the end closes it");
  if (scene.boundary.where)
    refuse(position(*scene.boundary.where, 0), "'where' has nothing to close; leave it out");
  if (!scene.guess.formulas.empty() || scene.guess.file || scene.guess.state)
    refuse(scene.guess.at, "the motion is computed without a guess; leave [guess] out");
  if (scene.search) refuse(scene.search->solutions.at, "they have one motion; leave [search] out");
  if (scene.continuation && purpose == Purpose::family)
    refuse(scene.continuation->at,
           "families are continued between conditions at both ends; change the data with --set instead");
  if (scene.solve.method && scene.solve.method->value != name(Method::newton))
    refuse(position(*scene.solve.method, 0),
           fmt::format("elements are solved one by one by Newton's method, without {}; leave 'method' out",
                       scene.solve.method->value));
}

/// What a free duration asks for, between ends that are no initial data.
void check_free_duration(const Scene& scene) {
  const BoundaryTable& boundary = scene.boundary;
  if (!boundary.free) return;
  const bool closed = boundary.energy || boundary.where || !boundary.where_list.empty(),
             forced = !scene.system.force.empty();
  const auto refuse = [&](const char* what) { throw SceneError(boundary.duration.at, what); };
  if (!closed && forced && !boundary.periodic)
    refuse("a free duration with forces needs 'where' to close it");
  if (!closed && !forced) refuse("a free duration needs 'energy' or 'where' to close it");
  if (!scene.guess.duration && !scene.guess.file)
    refuse("a free duration needs 'duration' in [guess], or a guess file");
}

[[noreturn]] void refuse_initial_data(const Scene& scene) {
  throw SceneError(
      scene.boundary.at,
      "'start' gives initial data, every coordinate and every momentum: integrals, unknowns, nonlinear "
      "conditions and waypoints have nothing to determine; leave them out");
}

/// The duration, or a guess of it; 0 where a file has it.
double expected_duration(const Scene& scene, const System& system, const Problem& problem) {
  if (!problem.duration.free) return problem.duration.value;
  return scene.guess.duration ? evaluate(*scene.guess.duration, system) : 0;
}

/// Whether one solution is asked for, without a scheme.
bool only_near_guess(const Scene& scene, Purpose purpose) {
  const bool family = scene.continuation && purpose == Purpose::family;
  return purpose != Purpose::comparison && !family && !scene.boundary.periodic && !scene.search &&
         !scene.spectrum && !scene.fit && !scene.inequalities && !scene.solve.scheme && !scene.solve.method &&
         !scene.guess.state;
}

/// With the ends that are made of unknowns at the guesses of these.
Problem with_guessed_ends(const Scene& scene, const ExtendedScene& parts, const System& system,
                          Problem problem) {
  BoundaryTable boundary = parts.linear;
  boundary.start = scene.boundary.start;
  boundary.end = scene.boundary.end;
  set_relation(boundary, system, problem);
  return problem;
}

/// Puts a guess, and that of a free duration, into a problem, in place of what its scene gives.
using PutGuess = std::function<void(const System& system, Problem& problem)>;

/// The guess, and what constraints make of it and of the ends, which become points near them. False as
/// complete_ends().
bool read_constrained_guess(const Scene& scene, const ExtendedScene& parts, const System& system,
                            const PutGuess& put_guess, Purpose purpose, EndPoints& ends, Problem& problem) {
  const bool extended = parts.extended;
  const bool deferred = !extended && purpose == Purpose::solution && only_near_guess(scene, purpose);
  const double time = expected_duration(scene, system, problem);
  if (!(time > 0)) {
    put_guess(system, problem);
    constrain(scene.system, system, problem.duration.value, deferred, problem);
  } else {
    constrain(scene.system, system, time, deferred, problem);
    put_guess(system, problem);
  }
  ends = end_points(extended ? with_guessed_ends(scene, parts, system, problem) : problem);
  check_independent(scene, ends, problem);
  // Ends that an unknown decides on are conditions, and a guess through waypoints is still to be made.
  if (extended && !problem.periodic && constraints_vary(scene)) return false;
  const bool suited = complete_ends(scene, ends, problem);
  if (!extended) project_guess(scene, ends, problem);
  return suited;
}

/// Nothing where a Hamiltonian needs phase space and `system` is its Legendre transform. `extended` as
/// split().
std::optional<Problem> read_problem(const Scene& scene, const System& system, const PutGuess& put_guess,
                                    Purpose purpose, bool extended = false) {
  Problem problem;
  problem.lagrangian = system.lagrangian;
  problem.copies = system.copies;
  problem.names = system.names;
  problem.periodic = scene.boundary.periodic;
  if (scene.system.curvature) problem.curvature = scene.system.curvature->value;
  const ExtendedScene parts = split(scene, system, extended);
  const bool legendre = scene.system.hamiltonian && !system.hamiltonian;
  if (legendre && maps_momenta(parts.linear, system)) return std::nullopt;
  set_relation(parts.linear, system, problem);
  if (problem.initial)
    check_initial_data(scene, purpose);
  else
    check_free_duration(scene);
  if (system.hamiltonian) check_phase_space(scene, parts, purpose);
  problem.duration = read_duration(parts.linear, system);
  if (parts.extended) {
    if (problem.initial) refuse_initial_data(scene);
    check_extended(scene, purpose);
    problem.lagrangian = extended_lagrangian(scene);
    problem.curvature.reset();
  }
  // A state is integrated, which takes a regular mass matrix; a constant one is the same at all points.
  const bool constrained = !scene.system.constraints.empty();
  if (scene.guess.state && system.lagrangian->structure().quadratic && !constrained)
    check_regular(problem, scene.system);
  if (legendre && names_momenta(scene.guess, system) && !has_legendre_transform(problem)) return std::nullopt;
  std::optional<InfiniteEnds> infinite;
  if (scene.boundary.infinite) infinite = read_infinite_ends(scene, purpose, problem);
  bool suited = true;
  EndPoints ends;
  if (constrained)
    suited = read_constrained_guess(scene, parts, system, put_guess, purpose, ends, problem);
  else
    put_guess(system, problem);
  if (infinite)
    reach_equilibria(
        scene, *infinite, [&](Problem& longer) { put_guess(system, longer); }, problem);
  if (legendre && !has_legendre_transform(problem)) return std::nullopt;
  if (parts.extended) {
    read_extension(scene, parts, system, {suited, ends}, problem);
    suited = true;
  }
  if (infinite) leave_infinite_ends(scene, *std::move(infinite), problem);
  try {
    if (system.hamiltonian) set_phase_space(*system.hamiltonian, problem);
    problem = make_problem(std::move(problem));
  } catch (const RecurrenceError& e) {
    throw SceneError(recurrence_location(scene.boundary), e.what());
  } catch (const std::invalid_argument& e) {
    throw SceneError(scene.boundary.at, e.what());
  }
  if (!parts.extended && (suited || only_near_guess(scene, purpose)))
    put_minimal_coordinates(scene.system, system, !suited, problem);
  if (!suited && !problem.manifold->parts().minimal) {
    if (system.lagrangian->kinks() || !may_be_extended(scene, purpose)) refuse_partly_free(scene, problem);
    return read_problem(scene, system, put_guess, purpose, true);
  }
  check_continuous(problem, scene.system);
  if (!problem.manifold || !has_regular_chart(problem)) {
    problem.lagrangian = as_made(std::move(problem.lagrangian));
    problem.copies = as_made(std::move(problem.copies));
    check_regular(problem, scene.system);
    check_guess_finite(problem, scene.guess.at, legendre);
  }
  if (parts.extended) check_determined(scene, parts, problem);
  if (problem.duration.where && problem.ends.free == 0)
    throw SceneError(position(*scene.boundary.where, 0),
                     "'where' names ends that are fixed, so it does not determine the duration; give the "
                     "duration, or 'energy' instead of 'where'");
  if (problem.duration.where && !where_determines(problem))
    throw SceneError(position(*scene.boundary.where, 0),
                     fmt::format("the condition '{}' follows from what else is given at the ends, or "
                                 "contradicts it; give the duration, or 'energy' instead of 'where'",
                                 scene.boundary.where->value));
  if (scene.boundary.energy && !problem.extension) check_energy_at_ends(problem, scene.boundary.energy->at);
  put_inequalities(scene, system, problem);
  return problem;
}

/// System and problem. A Hamiltonian has its Legendre transform where there is one, else it is in phase
/// space.
void read_law(const Scene& scene, const PutGuess& put_guess, Purpose purpose, Study& study) {
  const auto read = [&](Formulation formulation) {
    study.system = make_system(scene.system, {}, formulation);
    std::optional<Problem> problem = read_problem(scene, study.system, put_guess, purpose);
    if (problem) study.problem = *std::move(problem);
    return problem.has_value();
  };
  try {
    if (read(Formulation::legendre)) return;
  } catch (const NoLegendreTransform&) {
  }
  read(Formulation::phase_space);
}

void read_law(const Scene& scene, Purpose purpose, Study& study) {
  const Deadline deadline(study.budget);
  read_law(
      scene, [&](const System& system, Problem& problem) { read_guess(scene, system, deadline, problem); },
      purpose, study);
}

/// With constraints a fit begins with, and leads to, a solution as any other. Where the scene has no guess
/// the data make the path near which the constraints and the ends are considered.
void read_fitted_law(Scene scene, Purpose purpose, Study& study) {
  const FitTable table = *scene.fit;
  scene.fit.reset();
  const Deadline deadline(study.budget);
  read_law(
      scene,
      [&](const System& system, Problem& problem) {
        read_guess(scene, system, deadline, problem);
        if (!problem.guess.given()) problem.guess = observed_path(table, scene.path, system, problem);
      },
      purpose, study);
}

/// Refuses what would not fit into memory. Without a scheme, the elements that a search begins with.
void check_memory(const Scene& scene, const Study& study) {
  const bool adaptive = !study.options.scheme;
  const int n = study.problem.coordinates();
  const int elements = std::max(study.options.elements, adaptive && !study.problem.initial ? most_lanes : 1);
  const int degree = adaptive ? Refinement::first_degree : study.options.scheme->degree;
  const double needed = study.problem.initial
                            ? march_bytes(n, elements, degree)
                            : solve_bytes(study.problem.motion().structure(), elements, degree);
  const double available = available_bytes();
  if (needed > available)
    throw SceneError(
        scene.solve.elements ? scene.solve.elements->at : scene.system.at,
        fmt::format("{} coordinates and {} elements of degree {} need {} of memory; {} are available; {}", n,
                    elements, degree, byte_text(needed), byte_text(available),
                    scene.solve.elements ? "lower 'elements'" : "take, or couple, fewer coordinates"));
}

/// What forces exclude: several extremals are told apart, and interior points found, by the action.
void check_forces(const Scene& scene) {
  if (scene.system.force.empty()) return;
  if (scene.search)
    throw SceneError(scene.search->solutions.at,
                     "[search] looks for extremals, and with forces there are none; leave it out, and give "
                     "a guess for each motion");
  const std::optional<Text>& method = scene.solve.method;
  if (method && method->value == name(Method::ipopt))
    throw SceneError(position(*method, 0),
                     "method 'ipopt' needs an action without forces; write \"newton\" or \"ceres\"");
}

Study make_study(const Scene& scene, Purpose purpose) {
  Study study;
  study.scene = scene.path;
  study.files = scene.files;
  if (scene.guess.file) study.files.push_back(beside(scene.path, scene.guess.file->value));
  if (scene.spectrum && scene.spectrum->against)
    study.files.push_back(beside(scene.path, scene.spectrum->against->value));
  if (scene.fit) study.files.push_back(beside(scene.path, scene.fit->data.value));
  study.title = scene.title;
  study.forces = scene.system.force;
  study.constraints = scene.system.constraints;
  study.integrals = scene.boundary.integrals;
  if (scene.inequalities) study.inequalities = scene.inequalities->constraints;
  check_forces(scene);
  check_inequalities(scene, purpose);
  study.axes = scene.system.axes;
  study.centres = scene.system.centres;
  study.options = read_options(scene.solve);
  if (scene.solve.budget) study.budget = scene.solve.budget->value;
  if (scene.search) study.solutions = static_cast<int>(scene.search->solutions.value);
  if (scene.fit && !scene.system.constraints.empty())
    read_fitted_law(scene, purpose, study);
  else
    read_law(scene, purpose, study);
  check_singular_ends(scene, purpose, study.problem);
  if (scene.solve.steps) check_free_steps(study.problem, scene.solve.steps->at);
  check_memory(scene, study);
  if (scene.units) study.units = read_units(*scene.units);
  if (scene.spectrum) {
    if (scene.solve.elements) check_samples(study, scene.solve.elements->at);
    study.spectrum = read_spectrum(*scene.spectrum, scene.path, coordinate_names(study.problem));
  }
  if (scene.fit) {
    const auto request = read_fit(scene, study, [](const Scene& other, const Guess& guess, double duration) {
      Study there;
      read_law(
          other,
          [&](const System&, Problem& problem) {
            problem.guess = guess;
            if (problem.duration.free) problem.duration.value = duration;
          },
          Purpose::solution, there);
      return std::move(there.problem);
    });
    if (const GuessTable& guess = scene.guess; !guess.formulas.empty() || guess.file || guess.state)
      request->from_data = [scene, purpose] {
        Scene bare = scene;
        bare.guess.formulas.clear();
        bare.guess.file.reset();
        bare.guess.state.reset();
        return make_study(bare, purpose).fit;
      };
    const bool open_at_end = std::ranges::any_of(request->task.unknowns,
                                                 [](const FitUnknown& unknown) { return unknown.last >= 0; });
    if (open_at_end && !study.problem.duration.free && !study.problem.periodic)
      request->lasting = [scene, purpose](double duration) {
        Scene other = scene;
        other.boundary.duration.value = duration;
        return make_study(other, purpose).fit;
      };
    study.fit = request;
  }
  if (scene.continuation && purpose == Purpose::family)
    study.continuation = read_continued(scene, study.system, study.problem);
  return study;
}

/// work(); OutOfMemory where there is not enough of it for the `subject`.
template <class Work>
auto within_memory(const std::string& scene, const std::string& subject, const Work& work) {
  try {
    return work();
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(
        fmt::format("{}: {} needs more memory than the {} that are available; take, or couple, fewer "
                    "coordinates, or take "
                    "fewer elements",
                    scene, subject, byte_text(available_bytes())));
  }
}

/// Of a path or a text.
template <class Where>
Study load_checked(const Where& where, const std::vector<std::string>& sets, Purpose purpose) {
  const Scene scene = with_unknowns(read_scene(where, sets));
  try {
    return within_memory(scene.path, "the system", [&] {
      return with_parameters_used(scene, [&] { return make_study(scene, purpose); });
    });
  } catch (const FormulaError& e) {  // of a definition that an end, a duration or a guess names
    throw at_its_place(scene.system, e);
  }
}

template <class Where>
Study load_timed(const Where& where, const std::vector<std::string>& sets, Purpose purpose) {
  const auto begin = Clock::now();
  Study study = with_suggestion([&] { return load_checked(where, sets, purpose); });
  study.seconds_read = seconds_since(begin);
  return study;
}

std::string path_of(const Study& study) {
  return fmt::format("a path of {} coordinates", study.problem.coordinates());
}

/// What solve() returns the last time, with the medians of the times it took.
template <class Solve>
std::vector<Solution> repeated(const Study& study, int repeat, const Solve& solve) {
  if (repeat < 1) throw std::invalid_argument(fmt::format("repeat = {}; need at least 1", repeat));
  std::vector<Solution> solutions;
  std::vector<std::vector<double>> solving, analysing;  // for each solution, of each time
  SolveOptions options = study.options;
  for (int k = 0; k < repeat && !(k > 0 && options.deadline.passed()); ++k) {
    options.deadline = deadline_of(study);
    solutions = solve(options);
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

/// How many free directions of the ends leave the constraints, so that no motion has them.
int normal_directions(const Problem& problem) {
  const int n = problem.coordinates(), m = problem.manifold->constraints();
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(2 * n, problem.ends.free);
  for (const Triplet& entry : problem.ends.z) z(entry.row, entry.column) += entry.value;
  const EndPoints near = end_points(problem);
  Eigen::MatrixXd by_free(2 * m, z.cols());
  by_free << problem.manifold->at(near.start, 0).slopes * z.topRows(n),
      problem.manifold->at(near.end, problem.duration.value).slopes * z.bottomRows(n);
  return numerical_rank(by_free, limits::constraints::rank);
}

}  // namespace

void use_constants(const Solution& solution, Study& study) {
  if (!solution.extension) return;
  study.problem.lagrangian = solution.extension->lagrangian;
  if (solution.extension->manifold) study.problem.manifold = solution.extension->manifold;
  if (!study.problem.inequalities || !study.problem.inequalities->at) return;
  Inequalities inequalities = *study.problem.inequalities;
  inequalities.all = inequalities.at(solution.extension->constants());
  study.problem.inequalities = std::make_shared<const Inequalities>(std::move(inequalities));
}

int natural_conditions(const Problem& problem) {
  if (problem.manifold && problem.manifold->parts().minimal)
    return natural_conditions(problem.manifold->parts().minimal->problem);
  const std::vector<double>& given = problem.boundary.momenta;
  const auto zeros = std::count(given.begin(), given.end(), 0.0);
  if (problem.periodic || problem.initial) return 0;
  int free = problem.ends.free - static_cast<int>(given.size() - zeros);
  if (problem.phase) {  // of coordinates alone: momenta are free where these are fixed
    const std::vector<char>& fixed = problem.ends.fixed;
    const std::size_t n = problem.degrees_of_freedom();
    free = 0;
    for (std::size_t e = 0; e < fixed.size(); ++e) free += e % (2 * n) < n && !fixed[e] && !fixed[e + n];
  }
  if (problem.infinite)
    for (const std::vector<double>* end : {&problem.infinite->start, &problem.infinite->end})
      if (!end->empty()) free -= problem.coordinates();
  if (problem.manifold) free -= normal_directions(problem);
  if (problem.extension) free -= static_cast<int>(problem.extension->conditions.size());
  return free;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

Deadline deadline_of(const Study& study) {
  const double left = std::max(0.0, 1 - study.seconds_read / study.budget);
  return Deadline(study.budget).share(left).or_earlier(study.options.deadline);
}

Study load(const std::string& path, const std::vector<std::string>& sets, Purpose purpose) {
  return load_timed(path, sets, purpose);
}

Study load(const std::shared_ptr<const Source>& text, const std::vector<std::string>& sets, Purpose purpose) {
  return load_timed(text, sets, purpose);
}

Solution run(const Study& study, int repeat) {
  Solver solver;
  return within_memory(study.scene, path_of(study), [&] {
    return repeated(study, repeat,
                    [&](const SolveOptions& options) {
                      return std::vector<Solution>{solver.solve(study.problem, options)};
                    })
        .front();
  });
}

std::vector<Solution> run_all(const Study& study, int repeat) {
  Solver solver;
  return within_memory(study.scene, path_of(study), [&] {
    return repeated(study, repeat, [&](const SolveOptions& options) {
      return solver.solve_all(study.problem, options, study.solutions);
    });
  });
}

}  // namespace extremal
