#include <fmt/format.h>

#include "draft.hpp"

namespace bench {
namespace {

constexpr double own_parameters = 0.5;

double value_in(const Span& span, Random& random) {
  return span.low > 0 ? random.log_uniform(span.low, span.high) : random.uniform(span.low, span.high);
}

std::string parameter_text(const Span& span, int size, Random& random) {
  if (!span.list) return number_text(value_in(span, random));
  std::string text = "[";
  for (int k = 0; k < size; ++k) text += (k ? ", " : "") + number_text(value_in(span, random));
  return text + "]";
}

/// Small sizes more often than large ones.
int random_size(const Recipe& recipe, Random& random) {
  return static_cast<int>(random.log_uniform(recipe.least, recipe.most + 0.99));
}

}  // namespace

void draw_system(Draft& draft) {
  const Recipe& recipe = draft.recipe;
  Random& random = draft.random;
  Entries parameters;
  int size = 1;
  if (recipe.most > 0) {
    size = random_size(recipe, random);
    parameters.emplace_back("n", std::to_string(size));
  }
  const bool written = !recipe.lagrangian.empty();
  const bool own = written || random.chance(own_parameters);
  for (const Span& span : recipe.parameters) {
    if (!span.list && !own) continue;
    parameters.emplace_back(span.name, parameter_text(span, size, random));
    if (!span.list) draft.varied.emplace_back(parameters.back());
  }
  if (written) {
    std::string coordinates;
    for (const Span& span : recipe.positions)
      coordinates += (coordinates.empty() ? "" : ", ") + quoted(span.name + (recipe.most > 0 ? "[n]" : ""));
    draft.system.emplace_back("coordinates", "[" + coordinates + "]");
    draft.system.emplace_back("lagrangian", quoted(recipe.lagrangian));
  } else {
    draft.system.emplace_back("use", quoted(recipe.system));
  }
  if (!parameters.empty()) draft.system.emplace_back("parameters", inline_table(parameters));
  for (const Span& span : recipe.positions)
    for (int k = 1; k <= size; ++k)
      draft.names.push_back(recipe.most > 0 ? fmt::format("{}[{}]", span.name, k) : span.name);
}

State random_state(Draft& draft) {
  State state;
  const std::size_t size = draft.names.size() / draft.recipe.positions.size();
  for (const Span& span : draft.recipe.positions)
    for (std::size_t k = 0; k < size; ++k) state.q.push_back(draft.random.uniform(span.low, span.high));
  for (const Span& span : draft.recipe.velocities)
    for (std::size_t k = 0; k < size; ++k) state.v.push_back(draft.random.uniform(span.low, span.high));
  return state;
}

std::string text_of(const Draft& draft, const std::string& title) {
  return fmt::format("title = {}\n", quoted(title)) + table_text("system", draft.system) +
         table_text("boundary", draft.boundary) + table_text("guess", draft.guess) +
         table_text("solve", draft.solve) + table_text("search", draft.search) +
         table_text("continuation", draft.continuation);
}

}  // namespace bench
