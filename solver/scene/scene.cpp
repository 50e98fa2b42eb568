#include "scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "scene/read.hpp"
#include "scene/systems.hpp"

namespace extremal {
namespace {

/// What the scene writes is added to the file's and replaces entries of the same name.
template <class Entry>
void overlay(std::vector<Entry>& entries, const std::vector<Entry>& changes) {
  for (const Entry& change : changes) {
    const auto old =
        std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == change.name; });
    if (old == entries.end())
      entries.push_back(change);
    else
      *old = change;
  }
}

SystemTable merge(SystemTable file, const SystemTable& scene) {
  file.at = scene.at;
  file.use = scene.use;
  overlay(file.parameters, scene.parameters);
  overlay(file.definitions, scene.definitions);
  if (scene.lagrangian || scene.hamiltonian) {
    file.lagrangian = scene.lagrangian;
    file.hamiltonian = scene.hamiltonian;
  }
  overlay(file.force, scene.force);
  if (!scene.constraints.empty()) file.constraints = scene.constraints;
  if (scene.curvature) file.curvature = scene.curvature;
  return file;
}

void check_system(const SystemTable& system) {
  if (system.coordinates.empty())
    throw SceneError(system.at, "[system] has no 'coordinates'; list them, or name a system by 'use'");
  if (!system.lagrangian && !system.hamiltonian)
    throw SceneError(
        system.at, "[system] has no 'lagrangian'; write one, or a 'hamiltonian', or name a system by 'use'");
  if (system.hamiltonian && !system.constraints.empty())
    throw SceneError(
        position(system.constraints.front(), 0),
        "constraints hold a system that a Lagrangian describes, and this one has a Hamiltonian; write "
        "its 'lagrangian' instead");
  if (system.curvature && system.curvature->value < 0)
    throw SceneError(system.curvature->at,
                     fmt::format("curvature = {}; need 0 or more", system.curvature->value));
}

/// Where there are unknowns, or several conditions: each condition determines one number.
void check_where_list(const Scene& scene) {
  const BoundaryTable& boundary = scene.boundary;
  const std::size_t given = boundary.where_list.size(),
                    wanted = boundary.unknowns.size() + (boundary.free && !boundary.energy ? 1 : 0);
  const Location at = given > 0 ? boundary.where_list.front().at : boundary.unknowns.front().name_at;
  if (given != wanted)
    throw SceneError(
        at, fmt::format("'where' has {} equation{}, and {} {} to be determined: the unknowns{}; "
                        "give {}",
                        given, given == 1 ? "" : "s", wanted, wanted == 1 ? "number is" : "numbers are",
                        boundary.free && !boundary.energy ? " and the duration" : "",
                        given < wanted ? "as many equations, between end values that are not fixed"
                                       : "as many equations, or more unknowns"));
  if (!boundary.free && boundary.energy)
    throw SceneError(
        boundary.energy->at,
        "'energy' closes a free duration, but duration is fixed; write duration = \"free\" or leave "
        "'energy' out");
  if (!boundary.free && scene.guess.duration)
    throw SceneError(
        scene.guess.duration->at,
        "'duration' in [guess] needs duration = \"free\" in [boundary]; write that, or leave the guess out");
}

/// Ends at infinity exclude what relates both ends, and what is not made for them.
void check_infinite(const Scene& scene) {
  const BoundaryTable& boundary = scene.boundary;
  const auto refuse = [](const Location& at, const std::string& what) {
    throw SceneError(at, "duration = \"infinite\": " + what);
  };
  if (boundary.periodic)
    refuse(boundary.duration.at, "a periodic orbit has a period; write a number or \"free\"");
  if (!scene.system.force.empty())
    refuse(boundary.duration.at, "ends at infinity need an action without forces; give a finite duration");
  if (scene.guess.state)
    refuse(scene.guess.state->empty() ? scene.guess.at : scene.guess.state->front().name_at,
           "a motion from a state leaves the equilibrium; give formulas or a file as the guess");
  if (!scene.system.constraints.empty())
    refuse(boundary.duration.at, "constraints need ends at finite times; give a finite duration");
  if (scene.fit) refuse(scene.fit->at, "a fit needs ends at finite times; leave [fit] out");
  if (scene.solve.steps)
    refuse(scene.solve.steps->at, "free steps need ends at finite times; leave 'steps' out");
  if (scene.search)
    refuse(scene.search->solutions.at, "[search] needs ends at finite times; leave it out, and give guesses");
}

/// What the duration allows and asks for.
void check_duration(const Scene& scene) {
  const BoundaryTable& boundary = scene.boundary;
  if (!boundary.unknowns.empty() || !boundary.where_list.empty()) return check_where_list(scene);
  const Location* closing = boundary.energy  ? &boundary.energy->at
                            : boundary.where ? &boundary.where->at
                                             : nullptr;
  const char* name = boundary.energy ? "energy" : "where";
  if (!boundary.free && closing)
    throw SceneError(*closing,
                     std::string("'") + name +
                         "' closes a free duration, but duration is fixed; write "
                         "duration = \"free\" or leave '" +
                         name + "' out" +
                         (boundary.energy ? "" : "; what the ends are held to stands in 'conditions'"));
  if (!boundary.free && !boundary.infinite && scene.guess.duration)
    throw SceneError(
        scene.guess.duration->at,
        "'duration' in [guess] needs duration = \"free\" in [boundary]; write that, or leave the guess out");
  if (boundary.infinite) check_infinite(scene);
  const bool forced = !scene.system.force.empty();
  if (forced && boundary.energy)
    throw SceneError(boundary.energy->at,
                     boundary.periodic
                         ? "with forces the energy is no constant, and the orbit has a period of its own; "
                           "leave 'energy' out"
                         : "with forces the energy is no constant; close the duration by 'where'");
  if (forced && boundary.periodic && boundary.where)
    throw SceneError(boundary.where->at, "with forces an orbit has a period of its own; leave 'where' out");
}

void check_guess(const Scene& scene) {
  const GuessTable& guess = scene.guess;
  if (scene.boundary.periodic && guess.formulas.empty() && !guess.file && !guess.state)
    throw SceneError(scene.boundary.at,
                     "a periodic orbit needs a guess: formulas, a file or a state in [guess]");
}

void check_solve(const SolveTable& solve) {
  if (solve.tolerance && !(solve.tolerance->value > 0 && solve.tolerance->value < 1))
    throw SceneError(solve.tolerance->at,
                     fmt::format("tolerance = {}; need more than 0 and less than 1", solve.tolerance->value));
  if (solve.budget && !(solve.budget->value > 0))
    throw SceneError(solve.budget->at,
                     fmt::format("budget = {}; need more than 0 seconds", solve.budget->value));
  if (solve.elements && !(solve.elements->value >= 1 && solve.elements->value <= 1e9))
    throw SceneError(solve.elements->at,
                     fmt::format("elements = {}; need 1 to 1000000000", solve.elements->value));
  if (solve.steps && solve.steps->value != "free")
    throw SceneError(position(*solve.steps, 0),
                     fmt::format("steps = \"{}\"; write steps = \"free\", or leave it out for equal steps",
                                 solve.steps->value));
}

void check_spectrum(const SpectrumTable& spectrum) {
  if (spectrum.lines && !(spectrum.lines->value >= 1 && spectrum.lines->value <= 1000))
    throw SceneError(spectrum.lines->at, fmt::format("lines = {}; need 1 to 1000", spectrum.lines->value));
}

void check_search(const SearchTable& search) {
  if (!(search.solutions.value >= 1 && search.solutions.value <= 1000))
    throw SceneError(search.solutions.at,
                     fmt::format("solutions = {}; need 1 to 1000", search.solutions.value));
}

void check_continuation(const ContinuationTable& continuation) {
  if (const auto& points = continuation.points; points && !(points->value >= 2 && points->value <= 100000))
    throw SceneError(points->at, fmt::format("points = {}; need 2 to 100000", points->value));
}

const toml::table* table(const Document& document, std::string_view name, bool needed) {
  const toml::table* found = document.root[name].as_table();
  if (!found && needed)
    throw SceneError({document.at(document.root).source, 0, 0},
                     "the table [" + std::string(name) + "] is missing");
  return found;
}

}  // namespace

std::shared_ptr<const Source> scene_source(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const bool here = fs::exists(path, error) || fs::exists(path + ".toml", error);
  const std::string other = here ? "" : find_scene(fs::path(path).filename().string());
  if (other.empty()) return read_source(path);
  const auto source = std::make_shared<Source>(Source{path, ""});
  throw SceneError({source, 0, 0}, fmt::format("no such file; did you mean '{}'?", other));
}

Scene read_scene(const std::string& path, const std::vector<std::string>& sets) {
  Scene scene = read_scene(scene_source(path), sets);
  scene.files.insert(scene.files.begin(), path);
  return scene;
}

Scene read_scene(const std::shared_ptr<const Source>& text, const std::vector<std::string>& sets) {
  const std::string& path = text->name;
  Document document = parse_document(text);
  for (const std::string& argument : sets) set_value(document, argument);
  check_keys(document, document.root, "");
  check_relations(document);

  Scene scene;
  scene.path = path;
  scene.title = document.root["title"].value_or(std::string());
  scene.system = read_system_table(document, *table(document, "system", true));
  if (scene.system.use) {
    SystemTable used = read_system(*scene.system.use, path);
    if (used.at.source) scene.files.push_back(used.at.source->name);
    scene.system = merge(std::move(used), scene.system);
  }
  scene.boundary = read_boundary_table(document, *table(document, "boundary", true));
  if (const toml::array* waypoints = document.root["waypoints"].as_array())
    scene.waypoints = read_waypoint_tables(document, *waypoints);
  if (const auto* path_table = table(document, "path", false))
    scene.inequalities = read_path_table(document, *path_table);
  if (const auto* guess = table(document, "guess", false)) scene.guess = read_guess_table(document, *guess);
  if (const auto* solve = table(document, "solve", false)) scene.solve = read_solve_table(document, *solve);
  if (const auto* search = table(document, "search", false))
    scene.search = read_search_table(document, *search);
  if (const auto* spectrum = table(document, "spectrum", false))
    scene.spectrum = read_spectrum_table(document, *spectrum);
  if (const auto* continuation = table(document, "continuation", false))
    scene.continuation = read_continuation_table(document, *continuation);
  if (const auto* units = table(document, "units", false)) scene.units = read_units_table(document, *units);
  if (const auto* fit = table(document, "fit", false)) scene.fit = read_fit_table(document, *fit);
  check_system(scene.system);
  check_duration(scene);
  check_guess(scene);
  check_solve(scene.solve);
  if (scene.search) check_search(*scene.search);
  if (scene.spectrum) check_spectrum(*scene.spectrum);
  if (scene.continuation) check_continuation(*scene.continuation);
  return scene;
}

}  // namespace extremal
