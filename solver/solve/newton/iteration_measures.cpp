#include <algorithm>
#include <cmath>
#include <random>

#include "solve/mesh/roundoff.hpp"
#include "solve/newton/iteration.hpp"
#include "solve/newton/limits.hpp"

/// \file Measures of the equations at the path of an iteration.

namespace extremal {

using namespace limits::iteration_measures;

namespace {

/// The largest change of q by `scale` or of T by `duration`.
double difference(const Step& a, const Step& b, double scale, double duration) {
  double largest = 0;
  for (std::size_t k = 0; k < a.nodes.size(); ++k)
    largest = std::max(largest, std::abs(a.nodes[k] - b.nodes[k]));
  return std::max(scale > 0 ? largest / scale : largest, std::abs(a.duration - b.duration) / duration);
}

}  // namespace

double NewtonIteration::residual() const {
  const EndMap& ends = problem_->ends;
  free_.assign(ends.free, 0);
  for (const Triplet& z : ends.z) free_[z.column] += z.value * action_.imbalance(z.row);
  double largest = action_.residual();
  for (double g : free_) largest = std::max(largest, std::abs(g));
  return largest;
}

double NewtonIteration::burden() const {
  const double tested = 1 + trial_burden * std::max(0, trials_ - 1);
  if (tables_->unknowns() > most_dense_unknowns) return tested;
  if (in_twice_the_precision()) return tested;
  if (model_ != condensed_.get()) return sparse_burden * tested;
  const Chain& chain = action_.nodes.chain;
  if (!chain.pivoted()) return tested;
  const auto null_directions = static_cast<double>(chain.deflated().size());
  return tested * pivoted_burden(problem_->coordinates()) * (1 + null_directions);
}

double NewtonIteration::stiffness() const {
  double most = 0;
  for (double x : action_.nodes.first) most = std::max(most, std::abs(x));
  return most;
}

double NewtonIteration::residual_at(const Path& path) {
  action_.evaluate_plain(path);
  return residual();
}

double NewtonIteration::roundoff(Path& path) {
  model_->evaluate_gradient(action_, path);
  if (std::isnan(solve_for_step(path, step_))) return INFINITY;
  const double before = noise_;
  const double result = measure_noise(path);
  noise_ = before;
  return result;
}

/// By how much step_ changes, relative as it, where each node, and the free unknowns of the ends, is moved by
/// some last digits of its own: a step from there takes that back, but all is rounded differently.
double NewtonIteration::measure_noise(Path& path) {
  const std::size_t n = path.coordinates(), nodes = path.nodes().size();
  double magnitude = 0;
  for (double q : path.nodes()) magnitude = std::max(magnitude, std::abs(q));
  std::minstd_rand random;
  std::uniform_real_distribution<double> digits(-moved_digits * magnitude, moved_digits * magnitude);
  saved_.copy_values(path);
  noise_ = 0;
  for (int shift = 0; shift < shifts; ++shift) {
    simplified_.nodes.assign(nodes, 0);
    simplified_.inner.assign(step_.inner.size(), 0);
    for (std::size_t k = n; k + n < nodes; ++k) simplified_.nodes[k] = digits(random);
    free_.resize(problem_->ends.free);
    for (double& x : free_) x = digits(random);
    for (const Triplet& z : problem_->ends.z)
      simplified_.nodes[z.row < path.coordinates() ? z.row : nodes - 2 * n + z.row] +=
          z.value * free_[z.column];
    path.add(simplified_.nodes, simplified_.inner, 1);
    path.load_ends();
    model_->evaluate_gradient(action_, path);
    if (!std::isnan(solve_for_step(path, simplified_))) {
      for (std::size_t k = 0; k < nodes; ++k)
        simplified_.nodes[k] += (path.node(0)[k] - saved_.node(0)[k]) + (path.rest(0)[k] - saved_.rest(0)[k]);
      noise_ = std::max(noise_, difference(simplified_, step_, scale_, path.duration()));
    }
    path.copy_values(saved_);
    path.load_ends();
  }
  return noise_;
}

/// The step, and how it changes by the roundoff of the equations that close the free unknowns: it may have
/// met little of it by chance.
double NewtonIteration::step_under(const ElementTables& quadrature, const Path& path,
                                   const AlignedDoubles& explained) {
  action_.substitute(*problem_->lagrangian, quadrature);
  model_->evaluate_gradient(action_, path);
  double length = solve_for_step(path, step_, true);
  if (!explained.empty()) {
    for (std::size_t k = 0; k < explained.size(); ++k) step_.inner[k] -= explained[k];
    length = this->length(path, step_);
  }
  if (round_equations(path)) {
    model_->solve(action_, problem_->duration.free ? &closing_ : nullptr, simplified_);
    length += difference(simplified_, step_, scale_, path.duration());
  }
  action_.substitute(*problem_->lagrangian, *tables_);
  return length;
}

double NewtonIteration::steepness(const Path& path) const {
  const std::size_t n = path.coordinates(), elements = path.elements();
  const std::span<const double> mesh = path.mesh();
  const auto velocity = [&](const double* q, std::size_t k, std::size_t a) {
    return (q[(k + 1) * n + a] - q[k * n + a]) / (mesh[k + 1] - mesh[k]);
  };
  double most = 0;
  for (std::size_t k = 0; k < elements; ++k) {
    const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, elements - 1);
    const double apart = 0.5 * (mesh[after + 1] + mesh[after] - mesh[before + 1] - mesh[before]);
    for (std::size_t a = 0; a < n; ++a) {
      const double turned = std::abs(velocity(step_.nodes.data(), k, a));
      const double* q = path.node(0);
      const double faster = apart > 0 ? std::abs(velocity(q, after, a) - velocity(q, before, a)) / apart : 0;
      most = std::max(most, turned - last_digits * faster);
    }
  }
  return most / path.duration();
}

/// Sum of the terms of an equation of an end, as the second variation has them, at most the largest momentum.
/// Where the mass vanishes at an end, as at a radius of zero, it is far below. Of a sparse matrix, which is
/// not condensed, the bound alone is known.
double NewtonIteration::terms_at_end(const Path& path, std::size_t e) const {
  const NodeEquations& nodes = action_.nodes;
  if (nodes.first.empty()) return action_.momentum_scale();
  const std::size_t n = path.coordinates();
  const bool start = e < n;
  const std::size_t a = start ? e : e - n, elements = path.elements();
  const double* const block = start ? nodes.first.data() : nodes.last.data();
  const double* const beside = start || elements == 1 ? nodes.first_lower.data() : nodes.last_lower.data();
  const double* const at = path.node(start ? 0 : elements);
  const double* const next = path.node(start ? 1 : elements - 1);
  double sum = 0;
  for (std::size_t b = 0; b < n; ++b)
    sum += std::abs(block[a * n + b] * at[b]) +
           std::abs((start ? beside[b * n + a] : beside[a * n + b]) * next[b]);
  return std::min(sum, action_.momentum_scale());
}

/// Moves the equation that closes the duration, and the momenta at free ends, by half a digit of their terms;
/// those to where step_ points, which they resist least. False if nothing is free.
bool NewtonIteration::round_equations(const Path& path) {
  const std::size_t n = path.coordinates();
  if (closing(path)) {
    double terms = std::abs(closing_.value) + std::abs(action_.slope_duration());
    for (std::size_t e = 0; e < closing_.row.size(); ++e)
      terms += std::abs(closing_.row[e] * (e < n ? path.node(0)[e] : path.node(path.elements())[e - n]));
    closing_.value += half_a_digit * terms;
  }
  const double digit = extended_ ? half_an_extended_digit : half_a_digit;
  std::vector<double> parts(2 * n, 0);
  for (const Triplet& z : problem_->ends.z) {
    const std::size_t at = z.row < path.coordinates() ? z.row : step_.nodes.size() - 2 * n + z.row;
    parts[z.row] -= std::copysign(digit * terms_at_end(path, z.row), step_.nodes[at]);
  }
  model_->add_at_ends(action_, parts);
  return problem_->duration.free || problem_->ends.free > 0;
}

}  // namespace extremal
