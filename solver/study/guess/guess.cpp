#include "study/guess/guess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "scene/schema.hpp"
#include "study/files/guess_file.hpp"
#include "study/guess/guess_momenta.hpp"
#include "study/model/naming.hpp"

namespace extremal {
namespace {

/// Enough equal steps for cubic interpolation to be as good as the formula; fewer where there are many
/// coordinates.
int steps_for(int coordinates) { return std::clamp((1 << 16) / coordinates, 256, 1024); }

std::vector<double> equal_steps(int steps) {
  std::vector<double> tau(steps + 1);
  for (int k = 0; k <= steps; ++k) tau[k] = double(k) / steps;
  return tau;
}

/// The line between the fixed ends of each coordinate.
void fill_default(const EndMap& ends, Guess& guess) {
  const std::size_t n = ends.offset.size() / 2;
  for (std::size_t a = 0; a < n; ++a) {
    const double start = ends.fixed[a] ? ends.offset[a] : ends.fixed[n + a] ? ends.offset[n + a] : 0;
    const double end = ends.fixed[n + a] ? ends.offset[n + a] : start;
    for (std::size_t k = 0; k < guess.tau.size(); ++k)
      guess.q[k * n + a] = start + guess.tau[k] * (end - start);
  }
}

/// Coordinate a from a formula; `index` is the i of an array, or 0.
void fill_formula(const Quantity& quantity, int a, int index, const System& system, double duration,
                  Guess& guess) {
  const std::size_t n = system.names.size();
  if (!quantity.formula()) {
    for (std::size_t k = 0; k < guess.tau.size(); ++k) guess.q[k * n + a] = std::get<double>(quantity.value);
    return;
  }
  std::vector<double> times = guess.tau;
  for (double& t : times) t *= duration;
  const Text text{std::get<std::string>(quantity.value), quantity.at};
  const std::vector<double> values = placed(text, [&](const std::string& formula) {
    return tabulate(formula, system, duration, times, index, "guess");
  });
  for (std::size_t k = 0; k < times.size(); ++k) guess.q[k * n + a] = values[k];
}

/// Of phase space. Where the guess names neither a coordinate nor its momentum, one that an end gives is
/// better than that of a line which hardly moves.
std::vector<GuessKnows> known_of(const GuessTable& table, const System& system, const EndMap& ends) {
  const std::size_t n = system.names.size() / 2;
  std::vector<char> named(2 * n, 0);
  for (const Assignment& a : table.formulas) {
    const Range range = range_of(a.name, a.name_at, system);
    std::fill_n(named.begin() + range.first, range.count, 1);
  }
  std::vector<GuessKnows> known(n, GuessKnows::velocity);
  for (std::size_t a = 0; a < n; ++a) {
    if (named[n + a])
      known[a] = GuessKnows::both;
    else if (!named[a] && (ends.fixed[n + a] || ends.fixed[3 * n + a]))
      known[a] = GuessKnows::momentum;
  }
  return known;
}

/// Names and velocities differ by the prime alone.
void refuse_velocity(const Assignment& a, const System& system) {
  if (!a.name.ends_with("'")) return;
  const std::string name = a.name.substr(0, a.name.size() - 1), stem = name.substr(0, name.find('['));
  if (std::ranges::none_of(system.coordinates, [&](const Coordinate& c) { return c.name == stem; })) return;
  throw SceneError(
      a.name_at, fmt::format("\"{0}\" is a velocity, which follows from {1}: give {1} as a formula of t, or "
                             "a motion by its initial state: state = {{ {1} = …, \"{0}\" = … }}",
                             a.name, name));
}

void tabulate_formulas(const GuessTable& table, const System& system, Problem& problem) {
  const int n = problem.coordinates();
  Guess& guess = problem.guess;
  guess.tau = equal_steps(steps_for(n));
  guess.q.resize(guess.tau.size() * n);
  fill_default(problem.ends, guess);
  for (const Assignment& a : table.formulas) {
    if (!system.hamiltonian && is_momentum(a.name, system)) continue;
    refuse_velocity(a, system);
    const Range range = range_of(a.name, a.name_at, system, keys_of("guess"));
    for_each_value(a, range, [&](int coordinate, const Quantity& q, int index) {
      fill_formula(q, coordinate, index, system, problem.duration.value, guess);
    });
  }
}

/// Times scaled linearly onto [0, 1].
void use_path(GuessFile&& file, Guess& guess) {
  const double first = file.t.front(), length = file.t.back() - first;
  for (const double t : file.t) guess.tau.push_back((t - first) / length);
  guess.q = std::move(file.q);
}

/// A state of a file, as a scene would write it.
std::vector<Assignment> state_of(const GuessFile& file, const System& system, const Location& at) {
  std::vector<Assignment> state;
  for (std::size_t a = 0; a < system.names.size(); ++a) {
    state.push_back({system.names[a], at, {{file.start_q[a], at}}, false, at});
    state.push_back({system.names[a] + "'", at, {{file.start_v[a], at}}, false, at});
  }
  return state;
}

/// In phase space a file may have coordinates alone: momenta are then zero, and to be completed.
GuessFile read_states(const GuessTable& table, const std::string& path, const System& system,
                      bool& incomplete) {
  if (!system.hamiltonian) return read_guess_file(path, system.names, table.orbit);
  const std::size_t n = system.names.size() / 2;
  GuessFile file;
  try {
    file = read_guess_file(path, system.names, table.orbit);
  } catch (const SceneError&) {
    incomplete = true;
    file = read_guess_file(path, {system.names.begin(), system.names.begin() + static_cast<int>(n)},
                           table.orbit);
  }
  if (!file.start_q.empty())
    throw SceneError(table.file->at,
                     "this file gives a state by velocities, which do not determine the momenta of this "
                     "Hamiltonian; give 'state' with momenta, or a path");
  if (!incomplete) return file;
  std::vector<double> states(file.t.size() * 2 * n, 0);
  for (std::size_t k = 0; k < file.t.size(); ++k)
    std::copy_n(file.q.begin() + static_cast<std::ptrdiff_t>(k * n), n,
                states.begin() + static_cast<std::ptrdiff_t>(2 * k * n));
  file.q = std::move(states);
  return file;
}

double guessed_duration(const GuessTable& table, const System& system, std::optional<double> of_file) {
  if (!table.duration && !of_file)
    throw SceneError(table.file->at, "this file does not tell a duration; give 'duration' in [guess]");
  if (!table.duration) return *of_file;
  const double value = evaluate(*table.duration, system);
  if (!(value > 0))
    throw SceneError(table.duration->at, fmt::format("duration = {}; it must be positive", value));
  return value;
}

}  // namespace

bool names_momenta(const GuessTable& table, const System& system) {
  const auto any = [&](const std::vector<Assignment>& values) {
    return std::ranges::any_of(values, [&](const Assignment& a) { return is_momentum(a.name, system); });
  };
  return any(table.formulas) || (table.state && any(*table.state));
}

std::string beside(const std::string& scene, const std::string& file) {
  return (std::filesystem::path(scene).parent_path() / file).string();
}

void read_guess(const Scene& scene, const System& system, const Deadline& deadline, Problem& problem) {
  const GuessTable& table = scene.guess;
  if (table.file) {
    const std::string path = beside(scene.path, table.file->value);
    require_file(path, *table.file);
    bool incomplete = false;
    GuessFile file = read_states(table, path, system, incomplete);
    if (problem.duration.free || scene.boundary.infinite)
      problem.duration.value = guessed_duration(table, system, file.duration);
    if (!file.start_q.empty())
      return integrate_state(state_of(file, system, table.file->at), system, table.file->at, deadline,
                             problem);
    use_path(std::move(file), problem.guess);
    if (incomplete)
      complete_momenta(*system.hamiltonian,
                       std::vector<GuessKnows>(system.names.size() / 2, GuessKnows::velocity), problem);
    return;
  }
  if (problem.duration.free || table.duration) problem.duration.value = guessed_duration(table, system, {});
  const bool paths = system.hamiltonian && !table.state && !problem.initial;
  if (!table.formulas.empty() || paths) tabulate_formulas(table, system, problem);
  if (paths) complete_momenta(*system.hamiltonian, known_of(table, system, problem.ends), problem);
  if (table.state) integrate_state(*table.state, system, table.at, deadline, problem);
}

}  // namespace extremal
