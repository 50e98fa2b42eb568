#include <fmt/format.h>

#include <array>
#include <cmath>

#include "action/scheme.hpp"
#include "draft.hpp"

namespace bench {
namespace {

/// The line between the ends and a wave.
std::string wave_about_line(Draft& draft, std::size_t a) {
  const double start = draft.motion.start.q[a], change = draft.motion.end.q[a] - start;
  const double size = draft.random.uniform(-0.5, 0.5) * (std::abs(change) + 0.2 * std::abs(start));
  return quoted(fmt::format("{} + {}*t/T + {}*sin({}*pi*t/T)", number_text(start), number_text(change),
                            number_text(size), draft.random.between(1, 4)));
}

/// A circle about the middle of the box or near it.
std::string closed_wave(Draft& draft, const Span& span) {
  const double middle = (span.low + span.high) / 2, half = (span.high - span.low) / 2;
  const double centre = middle + draft.random.uniform(-0.3, 0.3) * half;
  const double size = draft.random.uniform(-0.8, 0.8) * half;
  return quoted(fmt::format("{} + {}*{}(2*{}*pi*t/T + {:.3f})", number_text(centre), number_text(size),
                            draft.random.chance(0.5) ? "cos" : "sin",
                            draft.random.chance(0.8) ? 1 : draft.random.between(2, 3),
                            draft.random.chance(0.5) ? 0.0 : draft.random.uniform(0, 6)));
}

void guess_formulas(Draft& draft) {
  const std::size_t n = draft.names.size(), size = n / draft.recipe.positions.size();
  for (std::size_t a = 0; a < n; ++a)
    draft.guess.emplace_back(quoted(draft.names[a]),
                             draft.kind == "periodic" ? closed_wave(draft, draft.recipe.positions[a / size])
                                                      : wave_about_line(draft, a));
}

/// The motion's start, somewhat off.
void guess_state(Draft& draft) {
  constexpr std::array disturbances{0.0, 1e-3, 0.03, 0.2};
  const double size = draft.random.pick(disturbances);
  Entries state;
  for (std::size_t a = 0; a < draft.names.size(); ++a) {
    const double factor = 1 + size * draft.random.uniform(-1, 1);
    state.emplace_back(quoted(draft.names[a]), number_text(draft.motion.start.q[a]));
    state.emplace_back(quoted(draft.names[a] + "'"), number_text(draft.motion.start.v[a] * factor));
  }
  draft.guess.emplace_back("state", inline_table(state));
}

/// One by name, or of a family with its degree.
extremal::Scheme random_scheme(Random& random) {
  if (random.chance(0.4)) return random.pick(extremal::schemes());
  const int degree = random.between(1, extremal::max_degree);
  return random.chance(0.5) ? extremal::lobatto(degree) : extremal::gauss(degree);
}

/// What some 10⁴ elements reach: more would try patience alone.
double tightest_for(const extremal::Scheme& scheme) {
  return std::pow(1e-4, std::min(scheme.order, scheme.degree + 1));
}

}  // namespace

void draw_guess(Draft& draft) {
  const double x = draft.random.unit();
  if (draft.kind == "initial") return;
  const bool needed = draft.kind == "periodic";
  if (x < 0.5 && !needed) return;
  if (x < 0.75 || !draft.real)
    guess_formulas(draft);
  else
    guess_state(draft);
}

void draw_solve(Draft& draft) {
  Random& random = draft.random;
  double tightest = 1e-13;
  if (random.chance(0.12)) {
    const extremal::Scheme scheme = random_scheme(random);
    draft.solve.emplace_back("scheme", quoted(scheme.name));
    if (random.chance(0.4)) {
      draft.solve.emplace_back("elements", std::to_string(static_cast<int>(random.log_uniform(1, 200))));
      return;
    }
    tightest = std::max(tightest, tightest_for(scheme));
  }
  if (tightest > 1e-9 || !random.chance(0.1))
    draft.solve.emplace_back("tolerance", fmt::format("{:.1e}", random.log_uniform(tightest, 1e-3)));
}

}  // namespace bench
