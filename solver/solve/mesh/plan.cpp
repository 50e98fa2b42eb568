#include "solve/mesh/plan.hpp"
#include "solve/mesh/limits.hpp"

#include <algorithm>
#include <cmath>

#include "action/tables.hpp"
#include "machine/simd.hpp"

namespace extremal {

using namespace limits::plan;

namespace {

/// Batches of the widest level.
double batches(double elements) { return std::ceil(elements / most_lanes); }

}  // namespace

double batch_cost(const ElementTables& tables, int degree) {
  const double n = tables.coordinates(), s = tables.scheme().degree;
  if (tables.unknowns() > most_dense_unknowns) return 2e3 * n * (degree + 1);  // one sparse matrix
  const double assembly = std::min(n, 3.0) * n * (degree + 1) * (degree + 1);
  const double elimination =
      s > 1 ? tables.condensation().fronts.work() * std::pow((degree - 1) / (s - 1), 3) / 12 : 0;
  return 200 + assembly + elimination + 1.7 * n * n * n;
}

/// Distances to singularities, bounded by those of neighbours.
void Planner::locate(const Resolution& resolution) {
  degree_ = resolution.degree();
  decays_.clear();
  for (const Resolution::Tail& tail : resolution.tails()) {
    const double distance = 0.25 * tail.h * (1 / tail.fall - tail.fall);
    const double log_size =
        tail.size > 0 ? std::log(tail.size) - resolution.degree() * std::log(tail.fall) : -INFINITY;
    decays_.push_back({tail.h, distance, std::log(4 * distance), log_size});
  }
  const auto limit = [&](std::size_t k, std::size_t neighbour) {
    const double apart = 0.5 * (decays_[k].h + decays_[neighbour].h);
    decays_[k].distance = std::min(decays_[k].distance, decays_[neighbour].distance + apart);
  };
  for (std::size_t k = 1; k < decays_.size(); ++k) limit(k, k - 1);
  for (std::size_t k = decays_.size() - 1; k-- > 0;) limit(k, k + 1);
}

/// The slope at the end of an element of length h is (s+1)(s+2)/h times the coefficient.
Planner::Goal Planner::goal(int degree, const PlanLimits& limits) {
  return {degree, std::log(limits.aim.q), std::log(limits.aim.v / ((degree + 1) * (degree + 2)))};
}

/// h' with size·f'^(s+1) within the goal, h' >= 4 distance f'. Unless the limits allow it there are no fewer
/// nodes an interval of time than now: those resolve the variations of the path too, whatever the path itself
/// may need.
double Planner::length(const ElementDecay& decay, const Goal& goal, const PlanLimits& limits) const {
  const double longest = limits.strongest_growth * decay.h * goal.degree / degree_,
               shortest = decay.h / limits.strongest_cut;
  if (std::isinf(decay.log_size)) return longest;
  const double log_fall = std::min((goal.log_q - decay.log_size) / (goal.degree + 1),
                                   (goal.log_v + decay.log_reach - decay.log_size) / goal.degree);
  if (log_fall >= 0) return longest;
  const double fall = std::exp(log_fall);
  return std::clamp(4 * decay.distance * fall / (1 - fall * fall), shortest, longest);
}

double Planner::elements(int degree, const PlanLimits& limits) const {
  double sum = 0;
  const Goal wanted = goal(degree, limits);
  for (const ElementDecay& decay : decays_) sum += decay.h / length(decay, wanted, limits);
  return spare * sum;
}

Plan Planner::plan(const Resolution& resolution, std::span<const double> mesh, const ElementTables& tables,
                   const PlanLimits& limits) {
  const double present = static_cast<double>(mesh.size()) - 1;
  const auto cost = [&](int degree, double elements) {
    return batches(elements) * batch_cost(tables, degree);
  };
  Plan best;
  int keep = resolution.degree_for(limits.aim, limits.highest_degree);
  if (keep > limits.highest_degree) keep = resolution.degree_for(limits.tolerated, limits.highest_degree);
  keep = std::max(keep, limits.raised_degree);
  double least = INFINITY;
  if (keep <= limits.highest_degree) {
    best.degree = keep;
    least = worth_moving * cost(keep, present);
  }
  // One batch cannot become fewer, and a low degree not much lower.
  if (least < INFINITY && present <= most_lanes && keep <= cheap_degree) return best;
  locate(resolution);
  int moved = 0;
  double count = 0;
  for (int degree = limits.least_degree; degree <= limits.highest_degree; ++degree) {
    if (cost(degree, 1) >= least) break;  // and so do higher ones
    const double needed = elements(degree, limits);
    if (!(needed <= limits.most_elements && cost(degree, needed) < least)) continue;  // not NaN either
    least = cost(degree, needed);
    count = needed;
    moved = degree;
  }
  if (moved == 0) return best;
  density_.clear();
  const Goal wanted = goal(moved, limits);
  for (std::size_t k = 0; k < decays_.size(); ++k) {
    const double density = 1 / length(decays_[k], wanted, limits);
    if (k == 0) density_.add(0, density);
    density_.add(0.5 * (mesh[k] + mesh[k + 1]), density);
    if (k + 1 == decays_.size()) density_.add(1, density);
  }
  return {moved, density_.mesh(most_lanes * static_cast<int>(batches(count)), 0)};
}

}  // namespace extremal
