#include "study/checks/continuity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

  /// How far L jumps at a state on the surface; nothing where it is continuous or infinite. Of a continuous
  /// one the part that changes its sign with u vanishes towards the surface.
  std::optional<double> jump(const State& at) {
    double first = 0, last = 0;
    for (const double distance : {limits::continuity::farther, limits::continuity::nearer}) {
      State beside = at;
      move(beside, distance * size_of(at));
      last = std::abs(evaluate_at(*surface_.odd, beside.q, beside.v, at.t, Order::value, scratch_).value);
      if (distance == limits::continuity::farther) first = last;
    }
    const double l = evaluate_at(lagrangian_, at.q, at.v, at.t, Order::value, scratch_).value;
    const double least = limits::continuity::least_jump * (std::isfinite(l) ? std::abs(l) : 1);
    const bool stays = std::isfinite(first) && std::abs(last - first) <= limits::continuity::stays * first;
    return stays && first > least ? std::optional(last) : std::nullopt;
  }

 private:
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

}  // namespace

void check_continuous(const Problem& problem, const SystemTable& system) {
  const Kinks* const kinks = problem.lagrangian->kinks();
  if (!kinks) return;
  for (const KinkSurface& surface : kinks->surfaces()) {
    NearbyPoints points(problem);
    Crossing crossing(surface, *problem.lagrangian);
    int reached = 0;
    for (int k = 0; k < limits::continuity::tries && reached < limits::continuity::telling; ++k) {
      State at;
      at.t = points.next(at.q, at.v);
      if (!crossing.reach(at)) continue;
      ++reached;
      if (const auto jump = crossing.jump(at))
        throw SceneError(
            system.law().at,
            fmt::format(
                "{} jumps by {:.4g} where the argument of abs, or the difference of those of min or max, "
                "passes 0 (near {}), and it must not jump along a motion; give the jump a width, as "
                "tanh(u/0.1) has for u/abs(u)",
                system.hamiltonian ? "H" : "L", *jump, state_text(problem, at)));
    }
  }
}

}  // namespace extremal
