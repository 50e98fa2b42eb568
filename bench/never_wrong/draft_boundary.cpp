#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "draft.hpp"

namespace bench {
namespace {

/// One end: what is said of it, coordinate by coordinate.
void add_end(Draft& draft, const char* key, const std::vector<double>& q, const std::vector<char>& fixed) {
  Entries entries;
  for (std::size_t a = 0; a < q.size(); ++a)
    if (fixed[a]) entries.emplace_back(quoted(draft.names[a]), number_text(q[a]));
  if (!entries.empty()) draft.boundary.emplace_back(key, inline_table(entries));
}

std::vector<char> some(Draft& draft, double probability) {
  std::vector<char> fixed(draft.names.size());
  for (char& f : fixed) f = draft.random.chance(probability);
  return fixed;
}

void fix_ends(Draft& draft, const std::vector<char>& start, const std::vector<char>& end) {
  add_end(draft, "start", draft.motion.start.q, start);
  add_end(draft, "end", draft.motion.end.q, end);
}

std::vector<char> all(const Draft& draft) { return std::vector<char>(draft.names.size(), 1); }
std::vector<char> none(const Draft& draft) { return std::vector<char>(draft.names.size(), 0); }

void set_duration(Draft& draft) { draft.boundary.emplace_back("duration", number_text(draft.duration())); }

void draw_fixed(Draft& draft) {
  fix_ends(draft, all(draft), all(draft));
  set_duration(draft);
  draft.known = draft.real;
}

/// Nothing is said of one end, or of neither.
void draw_natural(Draft& draft) {
  const bool start = draft.random.chance(0.5);
  if (draft.random.chance(0.9))
    fix_ends(draft, start ? none(draft) : all(draft), start ? all(draft) : none(draft));
  set_duration(draft);
  draft.known = draft.real && start && draft.motion.starts_without_momentum;
}

void draw_mixed(Draft& draft) {
  const std::vector<char> start = some(draft, 0.65), end = some(draft, 0.65);
  fix_ends(draft, start, end);
  set_duration(draft);
}

/// Rows in echelon form, so that none follows from the others; the motion's ends meet them.
void draw_coupled(Draft& draft) {
  const std::size_t n = draft.names.size();
  Random& random = draft.random;
  std::vector<std::size_t> order(2 * n);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t k = 2 * n; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  const std::size_t rows = 1 + random.below(2 * n);
  std::string conditions = "[";
  for (std::size_t r = 0; r < rows; ++r) {
    std::string row;
    double value = 0;
    for (std::size_t k = r; k < 2 * n; ++k) {
      if (k > r && !random.chance(1.0 / static_cast<double>(2 * n))) continue;
      const std::size_t e = order[k];
      const bool at_end = e >= n;
      const double c = random.chance(0.5) ? (k > r ? -1.0 : 1.0) : random.uniform(0.3, 2);
      value += c * (at_end ? draft.motion.end.q[e - n] : draft.motion.start.q[e]);
      row += fmt::format("{}{}*{}({})", k > r ? " + " : "", number_text(c), draft.names[e % n],
                         at_end ? "T" : "0");
    }
    conditions += fmt::format("{}\"{} = {}\"", r ? ", " : "", row, number_text(value));
  }
  draft.boundary.emplace_back("conditions", conditions + "]");
  set_duration(draft);
}

/// All of the start, momenta too, and nothing of the end.
void draw_initial(Draft& draft) {
  Entries entries;
  for (std::size_t a = 0; a < draft.names.size(); ++a) {
    entries.emplace_back(quoted(draft.names[a]), number_text(draft.motion.start.q[a]));
    entries.emplace_back(quoted("p_" + draft.names[a]), number_text(draft.motion.momentum[a]));
  }
  draft.boundary.emplace_back("start", inline_table(entries));
  set_duration(draft);
  draft.known = draft.real;
}

/// energy or where, for a duration that is free.
void close_duration(Draft& draft, const std::vector<std::size_t>& open) {
  draft.boundary.emplace_back("duration", quoted("free"));
  draft.guess.emplace_back("duration", number_text(draft.duration() * draft.random.uniform(0.8, 1.25)));
  if (open.empty() || draft.random.chance(0.6)) {
    draft.boundary.emplace_back("energy", number_text(draft.motion.energy));
    return;
  }
  const std::size_t a = draft.random.pick(open);
  draft.boundary.emplace_back(
      "where", quoted(fmt::format("{}(0) = {}", draft.names[a], number_text(draft.motion.start.q[a]))));
}

/// A multiple of the period, half of it, or another duration, after which nothing repeats.
void set_driven_duration(Draft& draft) {
  Random& random = draft.random;
  if (draft.recipe.period.empty() || random.chance(0.15)) return set_duration(draft);
  const double multiple = random.chance(0.2) ? 0.5 : random.between(1, 3);
  draft.boundary.emplace_back("duration", quoted(fmt::format("{}*{}", multiple, draft.recipe.period)));
}

void draw_periodic(Draft& draft) {
  draft.boundary.emplace_back("periodic", "true");
  if (!draft.recipe.maps.empty() && draft.random.chance(0.4))
    draft.boundary.emplace_back("map", draft.random.pick(draft.recipe.maps));
  if (!draft.recipe.autonomous) return set_driven_duration(draft);
  if (draft.recipe.forced) {
    draft.boundary.emplace_back("duration", quoted("free"));
    draft.guess.emplace_back("duration", number_text(draft.duration()));
    return;
  }
  if (draft.random.chance(0.5)) return set_duration(draft);
  std::vector<std::size_t> open(draft.names.size());
  std::iota(open.begin(), open.end(), 0);
  close_duration(draft, open);
}

void draw_free(Draft& draft) {
  const std::size_t n = draft.names.size();
  if (draft.random.chance(0.6)) {
    fix_ends(draft, all(draft), all(draft));
    close_duration(draft, {});
    draft.known = draft.real;
    return;
  }
  std::vector<char> start = all(draft);
  const std::size_t left_out = draft.random.below(n);
  start[left_out] = 0;
  fix_ends(draft, start, all(draft));
  close_duration(draft, {left_out});
}

}  // namespace

void draw_boundary(Draft& draft) {
  struct Kind {
    const char* name;
    double share;
    void (*draw)(Draft&);
    bool autonomous = false;
  };
  constexpr Kind kinds[] = {{"fixed", 0.32, draw_fixed},     {"natural", 0.12, draw_natural},
                            {"initial", 0.08, draw_initial}, {"mixed", 0.10, draw_mixed},
                            {"coupled", 0.12, draw_coupled}, {"periodic", 0.12, draw_periodic},
                            {"free", 0.14, draw_free, true}};
  double x = draft.random.unit();
  const Kind* chosen = kinds;
  for (const Kind& kind : kinds) {
    chosen = &kind;
    if ((x -= kind.share) < 0) break;
  }
  const bool has_energy = draft.recipe.autonomous && !draft.recipe.forced;
  if (chosen->autonomous && !has_energy) chosen = kinds;
  if (chosen->draw == draw_initial && draft.motion.momentum.empty()) chosen = kinds;
  draft.kind = chosen->name;
  chosen->draw(draft);
}

}  // namespace bench
