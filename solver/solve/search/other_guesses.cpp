#include "solve/search/other_guesses.hpp"

#include <iterator>

#include "solve/search/descent.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

namespace {

constexpr const char* on_finer_elements_from_guess = "newton from the guess on finer elements";

}  // namespace

bool descend(Pursuit& pursuit, int most, double close) {
  if (pursuit.tables().unknowns() > most_dense_unknowns) return false;
  Descent descent(pursuit.path, pursuit.w, [&] { return pursuit.count_step() && --most > 0; });
  return descent.run(pursuit.tables(), close);
}

bool by_descent(Pursuit& pursuit, const GuessMesh& guess, const std::vector<double>& mesh) {
  if (pursuit.exhausted() || pursuit.problem.paired) return false;
  guess.start(pursuit, mesh, guess.bend());
  // Others may need fewer steps.
  return descend(pursuit, pursuit.refinement.steps_left() / 2, limits::descent::close) &&
         pursuit.found("minimisation in windows");
}

bool from_resolved_guess(Pursuit& pursuit, GuessMesh& guess) {
  const Guess& given = pursuit.problem.guess;
  return given.given() && !given.motion() && guess.resolve(pursuit) &&
         pursuit.found(on_finer_elements_from_guess);
}

bool from_finer_elements(Pursuit& pursuit, const GuessMesh& guess) {
  if (pursuit.exhausted()) return false;
  const std::vector<double> finer = halved(guess.mesh());
  if (finer.size() > limits::guess_mesh::most_first_elements + 1) return false;
  guess.start(pursuit, finer, guess.bend());
  return pursuit.found(on_finer_elements_from_guess) || by_descent(pursuit, guess, finer);
}

bool from_line(Pursuit& pursuit, GuessMesh& guess) {
  const Problem& problem = pursuit.problem;
  if (!problem.guess.given() || !problem.has_ends() || problem.duration.free) return false;
  Problem line = problem;
  line.guess = {};
  return guess.instead(line, [&] {
    return guess.begin(pursuit) != GuessMesh::Kind::undefined &&
           (pursuit.found("newton from the straight line") || by_descent(pursuit, guess, guess.mesh()));
  });
}

Trial NoisyGuesses::run(Pursuit& pursuit, const GuessMesh& guess, unsigned tries) {
  constexpr const auto& sizes = limits::search::noise_sizes;
  Trial trial = Trial::none;
  for (const unsigned last = seed_ + tries; seed_ < last && !pursuit.exhausted(); ++seed_) {
    const Bend bend{sizes[seed_ % std::size(sizes)], seed_};
    const auto fill = [&](const ElementTables& tables, Path& path) { guess.fill(bend, tables, path); };
    if (!pursuit.problem.periodic) guess.start(pursuit, guess.mesh(), bend);
    if (pursuit.problem.periodic && !open_fitting(pursuit, fill)) {
      pursuit.count_step();
      continue;
    }
    trial = Trial::in_vain;
    if (pursuit.found("newton from the guess plus smooth noise")) return Trial::found;
  }
  return trial;
}

}  // namespace extremal
