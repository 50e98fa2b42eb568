#include "study/checks/continuity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "machine/largest.hpp"
#include "problem/nearby.hpp"
#include "study/checks/limits.hpp"
#include "system/kinks.hpp"

namespace extremal {
namespace {

struct State {
  std::vector<double> q, v;
  double t = 0;
};

/// What L does beside one surface.
class Crossing {
 public:
  Crossing(const KinkSurface& surface, const Lagrangian& lagrangian)
      : surface_(surface), lagrangian_(lagrangian) {}

  /// Newton's method across the surface, all coordinates alike; false where it does not come there.
  bool reach(State& at) {
    for (int k = 0; k < limits::continuity::most_steps; ++k) {
      const PointValues u = evaluate_at(*surface_.u, at.q, at.v, at.t, Order::gradient, scratch_);
      double square = 0;
      for (std::size_t a = 0; a < at.q.size(); ++a) square += u.dq[a] * u.dq[a] + u.dv[a] * u.dv[a];
      if (!std::isfinite(u.value) || !std::isfinite(square) || square == 0) return false;
      const double length = std::sqrt(square);
      normal_ = {u.dq, u.dv};
      for (double& part : normal_.q) part /= length;
      for (double& part : normal_.v) part /= length;
      move(at, -u.value / length);
      if (std::abs(u.value) <= limits::continuity::on_surface * length * size_of(at)) return true;
    }
    return false;
  }

  /// How far L jumps at a state on the surface; nothing where it is continuous or infinite.
  std::optional<double> jump(const State& at) { return jump_of(at, Order::value); }
  /// The same of its second derivatives, the largest of them.
  std::optional<double> jump_of_derivatives(const State& at) { return jump_of(at, Order::hessian); }

 private:
  double size(const Lagrangian& l, const State& at, Order order) {
    const PointValues values = evaluate_at(l, at.q, at.v, at.t, order, scratch_);
    if (order == Order::value) return std::abs(values.value);
    double most = 0;
    for (const std::vector<double>* part : {&values.dq, &values.dv, &values.qq, &values.vq, &values.vv}) {
      const double of_part = largest_if_finite(*part);
      if (std::isnan(of_part)) return of_part;
      most = std::max(most, of_part);
    }
    return most;
  }

  /// Of what is continuous the part that changes its sign with u vanishes towards the surface.
  std::optional<double> jump_of(const State& at, Order order) {
    double first = 0, last = 0;
    for (const double distance : {limits::continuity::farther, limits::continuity::nearer}) {
      State beside = at;
      move(beside, distance * size_of(at));
      last = size(*surface_.odd, beside, order);
      if (distance == limits::continuity::farther) first = last;
    }
    const double whole = size(lagrangian_, at, order);
    const double least = limits::continuity::least_jump * (std::isfinite(whole) ? whole : 1);
    const bool stays = std::isfinite(first) && std::abs(last - first) <= limits::continuity::stays * first;
    return stays && first > least ? std::optional(last) : std::nullopt;
  }

  void move(State& at, double distance) const {
    for (std::size_t a = 0; a < at.q.size(); ++a) {
      at.q[a] += distance * normal_.q[a];
      at.v[a] += distance * normal_.v[a];
    }
  }
  static double size_of(const State& at) {
    double size = 1e-3;
    for (const double x : at.q) size = std::max(size, std::abs(x));
    for (const double x : at.v) size = std::max(size, std::abs(x));
    return size;
  }

  const KinkSurface& surface_;
  const Lagrangian& lagrangian_;
  State normal_;
  Scratch scratch_;
};

std::string state_text(const Problem& problem, const State& at) {
  std::string text;
  for (std::size_t a = 0; a < std::min<std::size_t>(problem.names.size(), 4); ++a)
    text += fmt::format("{} = {:.4g}, {}' = {:.4g}, ", problem.names[a], at.q[a], problem.names[a], at.v[a]);
  return text + fmt::format("t = {:.4g}", at.t);
}

/// Calls `visit` with each surface and some states on it about the guess, with `copies` of the coordinates,
/// until that returns false.
template <class Visit>
void visit_surfaces(const Problem& problem, const Lagrangian& lagrangian, int copies, const Visit& visit) {
  const Kinks* const kinks = lagrangian.kinks();
  if (!kinks) return;
  for (const KinkSurface& surface : kinks->surfaces()) {
    NearbyPoints points(problem);
    Crossing crossing(surface, lagrangian);
    int reached = 0;
    for (int k = 0; k < limits::continuity::tries && reached < limits::continuity::telling; ++k) {
      State at;
      at.t = points.next(at.q, at.v);
      for (std::vector<double>* part : {&at.q, &at.v}) {
        const std::vector<double> one = *part;
        for (int copy = 1; copy < copies; ++copy) part->insert(part->end(), one.begin(), one.end());
      }
      if (!crossing.reach(at)) continue;
      ++reached;
      if (!visit(crossing, at)) return;
    }
  }
}

}  // namespace

void check_continuous(const Problem& problem, const SystemTable& system) {
  visit_surfaces(problem, *problem.lagrangian, 1, [&](Crossing& crossing, const State& at) {
    if (const auto jump = crossing.jump(at))
      throw SceneError(
          system.law().at,
          fmt::format(
              "{} jumps by {:.4g} where the argument of abs, or the difference of those of min or max, "
              "passes 0 (near {}), and it must not jump along a motion; give the jump a width, as "
              "tanh(u/0.1) has for u/abs(u)",
              system.hamiltonian ? "H" : "L", *jump, state_text(problem, at)));
    return true;
  });
}

bool stiffness_jumps(const Problem& problem) {
  bool found = false;
  visit_surfaces(problem, problem.motion(), problem.motion_copies(),
                 [&](Crossing& crossing, const State& at) {
                   found = crossing.jump_of_derivatives(at).has_value();
                   return !found;
                 });
  return found;
}

}  // namespace extremal
