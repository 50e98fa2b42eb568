#include "solve/search/from_flow.hpp"

#include <algorithm>
#include <cmath>

#include "solve/mesh/mesh.hpp"
#include "solve/search/gradient_flow.hpp"
#include "solve/search/held_in_time.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/on_family.hpp"
#include "solve/search/other_guesses.hpp"

namespace extremal {

namespace flow_limits = limits::gradient_flow;

FlowSearch::FlowSearch(Pursuit& pursuit, const GuessMesh& guess)
    : pursuit_(pursuit), guess_(guess), family_steps_(limits::continuum::most_steps_in_all) {}

bool FlowSearch::run(double side) {
  if (from_guess(guess_.bend(), side) || (stages() && from_guess(guess_.bend(), side, true))) {
    leave_saddles();
    return true;
  }
  return pursuit_.acceptance() && (aside(INFINITY) || (stages() && aside(INFINITY, true)));
}

/// Whether the flow may begin with less time. A guess of the user has the times of its rests.
bool FlowSearch::stages() const {
  return pursuit_.problem.lagrangian->structure().autonomous && !pursuit_.problem.guess.given();
}

/// From the guess bent by noise, more and more, to an extremal of less action.
bool FlowSearch::aside(double action, bool staged) {
  const unsigned most = pursuit_.problem.coordinates() > 1 ? flow_limits::bends_aside : 0;
  for (unsigned seed = 1; seed <= most && !pursuit_.options.deadline.passed(); ++seed)
    if (from_guess({flow_limits::bend_aside * seed, seed}, 1, staged) &&
        pursuit_.acceptance()->solution().action < action)
      return true;
  return false;
}

bool FlowSearch::from_guess(const Bend& bend, double side, bool staged) {
  const int elements = GradientFlow::elements_for(pursuit_.problem);
  if (elements == 0) return false;
  const ElementTables& linear = GradientFlow::linear_elements(pursuit_.w.levels);
  const std::vector<double> mesh = uniform_mesh(elements);
  pursuit_.refinement.open(mesh, 1);
  pursuit_.path.reset(linear, mesh, pursuit_.problem.duration.value);
  guess_.fill(bend, linear, pursuit_.path);
  return from_path(0, side, staged);
}

/// Saddles that were accepted are left for extremals of less action.
void FlowSearch::leave_saddles() {
  for (int left = 0; left < flow_limits::most_saddles; ++left) {
    if (!pursuit_.acceptance() || pursuit_.acceptance()->solution().morse_index.value_or(0) == 0) return;
    const Solution saddle = pursuit_.acceptance()->solution();
    const Outcome found = pursuit_.outcome;
    const auto left_to = [&](double side) {
      return descend_from(saddle.trajectory, side) &&
             pursuit_.acceptance()->solution().action < saddle.action;
    };
    if (left_to(1) || left_to(-1) || aside(saddle.action)) continue;
    pursuit_.acceptance()->put_back(saddle);
    pursuit_.outcome = found;
    pursuit_.refinement.rebind();
    return;
  }
}

bool FlowSearch::descend_from(const Trajectory& saddle, double side) {
  const int elements = GradientFlow::elements_for(pursuit_.problem);
  if (elements == 0) return false;
  const ElementTables& linear = GradientFlow::linear_elements(pursuit_.w.levels);
  const double T = saddle.duration();
  const int parts = std::max(1, elements / saddle.elements());
  std::vector<double> mesh;
  for (int k = 0; k < saddle.elements(); ++k)
    for (int j = 0; j < parts; ++j)
      mesh.push_back((saddle.times[k] + (saddle.times[k + 1] - saddle.times[k]) * j / parts) / T);
  mesh.push_back(1);
  const std::size_t n = saddle.coordinates;
  std::vector<double> ends(2 * n), v(n);
  saddle.at(0, {ends.data(), n}, v);
  saddle.at(T, {ends.data() + n, n}, v);
  pursuit_.refinement.open(mesh, 1);
  pursuit_.path.reset(linear, mesh, T);
  fill_path(ends, linear, pursuit_.path, [&](double tau, double* q) {
    saddle.at(std::min(tau * T, T), {q, n}, v);
  });
  return pursuit_.conclude(from_path(side, side));
}

/// From the path, which is on linear elements, to a minimiser, and by Newton's method on elements made of
/// several of those to the tolerance.
bool FlowSearch::from_path(double away, double side, bool staged) {
  constexpr const char* strategy = "minimisation by the gradient flow";
  // A search for several solutions renews its effort with each.
  const int most = pursuit_.acceptance() ? pursuit_.options.max_iterations
                                         : pursuit_.outcome.attempts + pursuit_.allowance();
  if (pursuit_.outcome.attempts >= most) return false;
  const auto count = [&] {
    pursuit_.outcome.record(pursuit_.w.iteration, pursuit_.options);
    return !pursuit_.options.deadline.passed() && pursuit_.outcome.attempts < most;
  };
  GradientFlow flow(pursuit_.problem, pursuit_.path, pursuit_.w, count);
  flow.prefer(side);
  if (staged) flow.lengthen_by_stages();
  if (!flow.run(away * flow_limits::kick)) return false;
  // Newton's method may have spent all on long intervals, where its equations are nearly singular.
  const auto renew = [&] {
    pursuit_.refinement.allow_at_least(std::min(pursuit_.allowance(), most - pursuit_.outcome.attempts),
                                       flow_limits::share);
  };
  MonotoneCubic curve;
  curve.fit(pursuit_.path);
  const std::span<const double> nodes = curve.mesh();
  std::vector<double> mesh;
  for (std::size_t k = 0; k + 1 < nodes.size(); k += flow_limits::nodes_an_element) mesh.push_back(nodes[k]);
  mesh.push_back(1);
  mesh = graded(std::move(mesh), flow_limits::steepest_grading);
  const auto reopen = [&](int degree) {
    pursuit_.refinement.open(mesh, degree);
    curve.fill(pursuit_.refinement.tables(), pursuit_.path);
  };
  reopen(Refinement::first_degree);
  renew();
  if (pursuit_.found(strategy)) return true;
  reopen(Refinement::first_degree);
  // Minimisers that are a family, as arcs in all planes through both ends, are one degenerate minimum.
  if (family_steps_ > 0) {
    if (reach_nearest_member(pursuit_, guess_, false, family_steps_) == FamilySearch::found) return true;
    reopen(Refinement::first_degree);
  }
  if (hold_in_time(pursuit_, guess_.ends(), strategy, renew)) return true;
  // Linear elements hold a path where forces are smaller than their errors.
  reopen(flow_limits::finishing_degree);
  renew();
  return descend(pursuit_, flow_limits::most_steps, flow_limits::finished) && pursuit_.found(strategy);
}

}  // namespace extremal
