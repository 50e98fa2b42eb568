#include "random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "draft.hpp"
#include "study/study.hpp"

namespace bench {
namespace {

/// Durations in units of the recipe's time.
constexpr double shortest = 0.003, longest = 8;
constexpr double real_motions = 0.65, from_rest = 0.15;

const Recipe& choose(const std::string& only, Random& random) {
  const std::vector<Recipe>& all = catalogue();
  if (only.empty()) return random.pick(all);
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Recipe& recipe) { return recipe.system == only; });
  if (found == all.end()) throw std::invalid_argument(fmt::format("there is no system '{}'", only));
  return *found;
}

/// The drawn system, read as any other.
extremal::Problem system_alone(const Draft& draft, const State& start, const std::string& scratch) {
  Entries ends;
  for (std::size_t a = 0; a < draft.names.size(); ++a)
    ends.emplace_back(quoted(draft.names[a]), number_text(start.q[a]));
  const Entries boundary{{"start", inline_table(ends)}, {"duration", "1.0"}};
  write_text(scratch, table_text("system", draft.system) + table_text("boundary", boundary));
  return extremal::load(scratch).problem;
}

/// A motion of the system or, where that is not wanted or fails, two states and the energy of the first.
void draw_motion(Draft& draft, const std::string& scratch) {
  State start = random_state(draft);
  if (draft.random.chance(from_rest)) std::fill(start.v.begin(), start.v.end(), 0.0);
  const double duration = draft.recipe.time * draft.random.log_uniform(shortest, longest);
  draft.real = draft.random.chance(real_motions);
  const extremal::Problem problem = system_alone(draft, start, scratch);
  draft.motion = follow(problem, start, draft.real ? duration : draft.recipe.time * shortest);
  draft.real = draft.real && draft.motion.duration > 0;
  if (draft.real) return;
  draft.motion.duration = duration;
  draft.motion.end = random_state(draft);
}

}  // namespace

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw std::runtime_error(fmt::format("{} cannot be written", path));
}

RandomScene read_scene_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(fmt::format("{} cannot be read", path));
  std::ostringstream text;
  text << file.rdbuf();
  return {.system = std::filesystem::path(path).stem(), .kind = "kept", .text = text.str()};
}

RandomScene random_scene(std::uint64_t seed, std::uint64_t index, const std::string& only,
                         const std::string& scratch) {
  Random random(seed, index);
  Draft draft{.recipe = choose(only, random), .random = random};
  draw_system(draft);
  draw_motion(draft, scratch);
  draw_boundary(draft);
  draw_guess(draft);
  draw_solve(draft);
  draw_more(draft);
  return {draft.recipe.system, draft.kind, draft.known,
          text_of(draft, fmt::format("Random scene {} of seed {}", index, seed))};
}

}  // namespace bench
