#include "action/corners.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "action/momentum_jump.hpp"
#include "action/rule.hpp"
#include "action/tables.hpp"
#include "machine/aligned.hpp"
#include "machine/largest.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Steps about a minimum of |u|.
constexpr int finer = 16;
/// Of T: crossings nearer to an end than this are at the end, and two nearer than this are one.
constexpr double same_time = 1e-12;
/// An element beside a corner becomes at most so many times shorter or longer in one step.
constexpr double most_stretch = 2;
/// Of the shorter element beside a corner: a move that changes those two alone. Others keep all their digits.
constexpr double near = 0.01;
/// Of a change of u over an element: a value of u that is on its side of the surface.
constexpr double beside = 0x1p-40;
/// A jump that falls to less than the second part, from so many times as far from the surface, is none on it:
/// so that of |u|^p with p > 1 falls.
constexpr double farther = 1024, falling = 0.9;
/// Of the change of the momentum beside a surface: what is left of it on the surface if the momentum jumps.
constexpr double jumping = 0.01;
/// Of the terms of u: a value of u that no rounding makes.
constexpr double roundings = 0x1p-50;
/// Halvings of an interval, after which the crossing is known to the last digit.
constexpr int most_halvings = 60;

/// A path by its elements.
struct Copy {
  std::vector<double> times, nodes;
  Polynomials pieces;

  explicit Copy(const Path& path, double duration) {
    const std::size_t size = static_cast<std::size_t>(path.degree() + 1) * path.coordinates();
    for (const double tau : path.mesh()) times.push_back(tau * duration);
    nodes.resize(path.elements() * size);
    for (int k = 0; k < path.elements(); ++k) path.element(k, nodes.data() + k * size);
    pieces = {path.coordinates(), path.degree(), times, nodes};
  }
};

/// A point of a path.
struct State {
  std::vector<double> q, v;
  double t = 0;
};

/// Into `state`, by the values of the basis at τ.
void read_state(const Polynomials& path, int element, double tau, const double* value,
                const double* derivative, State& state) {
  const int n = path.coordinates, count = path.degree + 1;
  const double start = path.times[element], h = path.times[element + 1] - start;
  state.q.assign(n, 0);
  state.v.assign(n, 0);
  state.t = start + tau * h;
  const double* nodes = path.nodes.data() + static_cast<std::size_t>(element) * count * n;
  for (int j = 0; j < count; ++j)
    for (int a = 0; a < n; ++a) {
      state.q[a] += value[j] * nodes[j * n + a];
      // Differences from the first node keep the digits of small ones.
      state.v[a] += derivative[j] / h * (nodes[j * n + a] - nodes[a]);
    }
}

void read_state(const Polynomials& path, int element, double tau, State& state) {
  std::array<double, max_degree + 1> value, derivative;
  lobatto_basis_at(path.degree, tau, value.data(), derivative.data());
  read_state(path, element, tau, value.data(), derivative.data(), state);
}

State state_at(const Polynomials& path, int element, double tau) {
  State state;
  read_state(path, element, tau, state);
  return state;
}

/// 0, 1/2s, …, 1.
std::vector<double> scanned(int degree) {
  std::vector<double> places;
  for (int i = 0; i <= 2 * degree; ++i) places.push_back(static_cast<double>(i) / (2 * degree));
  return places;
}

/// q(T + t) = R q(t) + c.
void continue_beyond(const Polynomials& path, const ClosingMap& closed, State& state) {
  const auto n = static_cast<Eigen::Index>(state.q.size());
  Eigen::Map<Eigen::VectorXd> q(state.q.data(), n), v(state.v.data(), n);
  q = (closed.r * q + closed.c).eval();
  v = (closed.r * v).eval();
  state.t += path.times.back();
}

/// Values of the surfaces along a path.
class Along {
 public:
  explicit Along(const Polynomials& path)
      : path_(path), places_(scanned(path.degree)), basis_(lobatto_basis(path.degree, places_)) {}

  double at(const Lagrangian& f, const State& s) {
    return evaluate_at(f, s.q, s.v, s.t, Order::value, scratch_).value;
  }
  double at(const Lagrangian& f, int element, double tau) {
    read_state(path_, element, tau, state_);
    return at(f, state_);
  }
  PointValues gradient(const Lagrangian& f, const State& s) {
    return evaluate_at(f, s.q, s.v, s.t, Order::gradient, scratch_);
  }
  std::vector<double> slope(const Lagrangian& f, const State& s) { return gradient(f, s).dq; }

  /// The times of crossings in one element.
  void find(const Kinks& kinks, int element, std::vector<double>& times);

 private:
  /// Of an element, in τ, with the values of u.
  struct Interval {
    double left, right, at_left, at_right;
  };
  double root(const Lagrangian& u, int element, double left, double right, double at_left);
  void between(const Lagrangian& u, int element, Interval in, std::vector<double>& times);
  void about_minimum(const Lagrangian& u, int element, Interval in, std::vector<double>& times);

  const Polynomials& path_;
  std::vector<double> places_;  ///< where elements are looked at
  Basis basis_;
  std::vector<State> states_;
  State state_;
  Scratch scratch_;
};

/// Where u changes its sign, by bisection.
double Along::root(const Lagrangian& u, int element, double left, double right, double at_left) {
  for (int k = 0; k < most_halvings; ++k) {
    const double middle = 0.5 * (left + right);
    if (middle == left || middle == right) break;
    ((at(u, element, middle) < 0) == (at_left < 0) ? left : right) = middle;
  }
  return 0.5 * (left + right);
}

void Along::between(const Lagrangian& u, int element, Interval in, std::vector<double>& times) {
  if ((in.at_left < 0) == (in.at_right < 0)) return;
  const double start = path_.times[element], h = path_.times[element + 1] - start;
  times.push_back(start + h * root(u, element, in.left, in.right, in.at_left));
}

/// Two crossings may hide about a minimum of |u|, which is looked at in finer steps.
void Along::about_minimum(const Lagrangian& u, int element, Interval in, std::vector<double>& times) {
  const double step = (in.right - in.left) / finer;
  double left = in.left, at_left = in.at_left;
  for (int j = 1; j <= finer; ++j) {
    const double right = j == finer ? in.right : in.left + j * step;
    const double at_right = j == finer ? in.at_right : at(u, element, right);
    between(u, element, {left, right, at_left, at_right}, times);
    left = right;
    at_left = at_right;
  }
}

void Along::find(const Kinks& kinks, int element, std::vector<double>& times) {
  const int parts = static_cast<int>(places_.size()) - 1;
  states_.resize(places_.size());
  for (int i = 0; i <= parts; ++i) {
    const Basis::Row row = basis_.row(i);
    read_state(path_, element, places_[i], row.value, row.derivative, states_[i]);
  }
  std::vector<double> value(states_.size());
  const auto interval = [&](int from, int to) {
    return Interval{places_[from], places_[to], value[from], value[to]};
  };
  for (const KinkSurface& surface : kinks.surfaces()) {
    const Lagrangian& u = *surface.u;
    for (int i = 0; i <= parts; ++i) value[i] = at(u, states_[i]);
    for (int i = 0; i < parts; ++i) {
      between(u, element, interval(i, i + 1), times);
      if (i == 0) continue;
      const double before = value[i - 1], here = value[i], after = value[i + 1];
      const bool one_side = (before < 0) == (here < 0) && (here < 0) == (after < 0);
      if (one_side && std::abs(here) <= std::min(std::abs(before), std::abs(after)))
        about_minimum(u, element, interval(i - 1, i + 1), times);
    }
  }
}

double product(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Moves a point along the slope of u by as much as changes u so, to first order.
void move_along(std::span<double> x, std::span<const double> slope, double change) {
  const double square = product(slope, slope);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] += slope[k] * change / square;
}

/// A node and what is next to it.
struct Sides {
  int node;
  State before, after;     ///< at the node, by the velocities of either side
  double u_left, u_right;  ///< at the next points within the elements
  double shorter;          ///< of the elements
};

/// Calls take(surface, sides, rising) at each node beside which u changes its sign.
template <class Take>
void for_crossed(const Kinks& kinks, const Polynomials& path, const ClosingMap* closed, Along& along,
                 Take&& take) {
  const int s = path.degree, elements = path.elements();
  if (s < 2) return;
  const std::vector<double>& lobatto = lobatto_barycentric(s).nodes;
  State left, right;
  for (int k = 1; k < elements + (closed != nullptr); ++k) {
    const bool at_end = k == elements;
    read_state(path, k - 1, lobatto[s - 1], left);
    read_state(path, at_end ? 0 : k, lobatto[1], right);
    if (at_end) continue_beyond(path, *closed, right);
    for (const KinkSurface& surface : kinks.surfaces()) {
      const double u_left = along.at(*surface.u, left), u_right = along.at(*surface.u, right);
      if ((u_left < 0) == (u_right < 0)) continue;
      Sides at{.node = k,
               .before = state_at(path, k - 1, 1),
               .after = state_at(path, at_end ? 0 : k, 0),
               .u_left = u_left,
               .u_right = u_right,
               .shorter = std::min(path.times[k] - path.times[k - 1],
                                   at_end ? path.times[1] : path.times[k + 1] - path.times[k])};
      if (at_end) continue_beyond(path, *closed, at.after);
      take(surface, at, u_right > u_left);
    }
  }
}

/// Nodes between those that move, and the ends, move in proportion.
void spread(std::span<const double> mesh, std::span<const int> moves, std::span<double> shift) {
  std::size_t left = 0;
  for (std::size_t right = 1; right < shift.size(); ++right) {
    if (moves[right] == 0 && right + 1 < shift.size()) continue;
    for (std::size_t k = left + 1; k < right; ++k) {
      const double share = (mesh[k] - mesh[left]) / (mesh[right] - mesh[left]);
      shift[k] = shift[left] + share * (shift[right] - shift[left]);
    }
    left = right;
  }
}

}  // namespace

std::vector<Corner> corners_of(const Kinks& kinks, const Polynomials& path, const ClosingMap* closed) {
  std::vector<Corner> corners;
  const int n = path.coordinates;
  const double gap = SchemeTables::of_gauss(std::max(path.degree, 2)).node[0];
  Along along(path);
  for_crossed(kinks, path, closed, along, [&](const KinkSurface& surface, const Sides& at, bool rising) {
    if (surface.by_velocity) return;
    State here = at.after;
    here.q = at.before.q;
    for (int a = 0; a < n; ++a) here.v[a] = 0.5 * (at.before.v[a] + at.after.v[a]);
    Corner corner{.node = at.node,
                  .u = along.at(*surface.u, here),
                  .rate = along.at(*surface.u_by_time, here),
                  .normal = along.slope(*surface.u, here),
                  .sideways = std::vector<double>(n)};
    for (int a = 0; a < n; ++a) corner.rate += corner.normal[a] * here.v[a];
    // The path crosses the surface as the signs on both sides say, and not by a cusp.
    const bool crosses = (corner.rate > 0) == rising;
    if (!crosses || !(std::abs(corner.u) < gap * at.shorter * std::abs(corner.rate))) return;
    const double square = product(corner.normal, corner.normal);
    if (square > 0) {
      double change = at.shorter * std::abs(corner.rate), size = 0;
      for (int a = 0; a < n; ++a) size += std::abs(corner.normal[a] * here.q[a]);
      change = std::max(change, roundings * size / beside);
      move_along(here.q, corner.normal, farther * beside * change - corner.u);
      const double far = largest(along.slope(*surface.odd, here));
      move_along(here.q, corner.normal, (1 - farther) * beside * change);
      std::vector<double> jump = along.slope(*surface.odd, here);
      if (!(largest(jump) > falling * far)) std::ranges::fill(jump, 0.0);
      const double along_normal = product(jump, corner.normal) / square;
      corner.stiffness = along_normal / std::abs(corner.rate);
      for (int a = 0; a < n; ++a)
        corner.sideways[a] = (jump[a] - along_normal * corner.normal[a]) / std::abs(corner.rate);
    }
    corners.push_back(std::move(corner));
  });
  return corners;
}

std::vector<double> Switch::velocity_at(double u) const {
  std::vector<double> moved = v;
  move_along(moved, by_v, u);
  return moved;
}

std::vector<Switch> switches_of(const Kinks& kinks, const Polynomials& path, const ClosingMap* closed) {
  std::vector<Switch> switches;
  Along along(path);
  for_crossed(kinks, path, closed, along, [&](const KinkSurface& surface, const Sides& at, bool rising) {
    if (!surface.by_velocity) return;
    const PointValues slopes = along.gradient(*surface.u, at.before);
    if (!(product(slopes.dv, slopes.dv) > 0)) return;
    Switch found{.node = at.node,
                 .q = at.before.q,
                 .v = at.before.v,
                 .t = at.before.t,
                 .by_q = slopes.dq,
                 .by_v = slopes.dv,
                 .by_t = along.at(*surface.u_by_time, at.before),
                 .before = at.u_left};
    found.v = found.velocity_at(-slopes.value);
    State positive = at.before;
    positive.v = found.velocity_at(beside * std::abs(at.u_left));
    found.jump = along.slope(*surface.odd, positive);
    if (!rising)
      for (double& x : found.jump) x = -x;
    switches.push_back(std::move(found));
  });
  return switches;
}

namespace {

/// The points of a path between which surfaces that depend on velocities are crossed, also from one element
/// to the next and, if it is closed, beyond T.
std::vector<State> samples(const Problem& problem, const Polynomials& path) {
  std::vector<State> states;
  const int parts = 2 * path.degree;
  for (int k = 0; k < path.elements(); ++k)
    for (int i = 0; i <= parts; ++i) states.push_back(state_at(path, k, static_cast<double>(i) / parts));
  if (problem.periodic) {
    states.push_back(state_at(path, 0, 0));
    continue_beyond(path, closing_map(problem), states.back());
  }
  const int n = path.coordinates / 2;  // of one of two copies
  for (State& state : states)
    for (std::vector<double>* x : {&state.q, &state.v})
      for (int a = 0; problem.paired && a < n; ++a) (*x)[a] = (*x)[n + a] = 0.5 * ((*x)[a] + (*x)[n + a]);
  return states;
}

/// Between two states in which u has different signs: the one nearest to the surface with u >= 0.
State on_surface(const Lagrangian& u, State positive, State negative, Along& along) {
  for (int k = 0; k < most_halvings; ++k) {
    State middle = positive;
    for (std::size_t a = 0; a < middle.q.size(); ++a) {
      middle.q[a] = 0.5 * (positive.q[a] + negative.q[a]);
      middle.v[a] = 0.5 * (positive.v[a] + negative.v[a]);
    }
    middle.t = 0.5 * (positive.t + negative.t);
    (along.at(u, middle) < 0 ? negative : positive) = std::move(middle);
  }
  return positive;
}

}  // namespace

std::optional<MomentumJump> momentum_jump(const Problem& problem, const Polynomials& path) {
  const Kinks* const kinks = problem.lagrangian->kinks();
  std::optional<MomentumJump> first;
  if (!kinks) return first;
  std::vector<State> states;
  Along along(path);
  for (const KinkSurface& surface : kinks->surfaces()) {
    if (!surface.by_velocity) continue;
    if (states.empty()) states = samples(problem, path);
    double before = along.at(*surface.u, states[0]);
    for (std::size_t i = 1; i < states.size(); ++i) {
      const double u = along.at(*surface.u, states[i]);
      const bool rising = before < 0, crosses = rising != (u < 0);
      before = u;
      if (!crosses) continue;
      const State &positive = states[rising ? i : i - 1], &negative = states[rising ? i - 1 : i];
      const State at = on_surface(*surface.u, positive, negative, along);
      const double size = largest(along.gradient(*surface.odd, at).dv);
      if (!(size > jumping * largest(along.gradient(*surface.odd, positive).dv))) continue;
      if (!first || at.t < first->time) first = {at.t, size};
      break;
    }
  }
  return first;
}

std::optional<MomentumJump> momentum_jump(const Problem& problem, const Path& path) {
  if (!problem.lagrangian->kinks()) return std::nullopt;
  return momentum_jump(problem, Copy(path, path.duration()).pieces);
}

std::string describe(const MomentumJump& jump) {
  return fmt::format(
      "at t = {:.6g} a velocity crosses a kink of abs, min or max, where the momentum jumps by {:.3g}: there "
      "velocities of extremals stay for a while, or jump, which is not computed; write L with a smooth "
      "function, such as sqrt(u^2 + e^2) for abs(u)",
      jump.time, jump.size);
}

std::vector<Corner> corners_of(const Kinks& kinks, const Path& path, const ClosingMap* closed) {
  return corners_of(kinks, Copy(path, path.duration()).pieces, closed);
}

bool move_corners(Path& path, std::span<const Corner> corners, std::span<const double> node_step,
                  double factor) {
  if (corners.empty()) return true;
  if (!(path.duration() > 0)) return false;
  const std::size_t n = path.coordinates();
  std::vector<double> shift(path.elements() + 1);
  std::vector<int> surfaces(shift.size());
  for (const Corner& corner : corners) {
    if (corner.node == path.elements()) continue;
    double u = corner.u;
    for (std::size_t a = 0; a < n; ++a) u += corner.normal[a] * node_step[corner.node * n + a];
    shift[corner.node] -= factor * u / (corner.rate * path.duration());
    ++surfaces[corner.node];
  }
  for (std::size_t k = 0; k < shift.size(); ++k)
    if (surfaces[k] > 1) shift[k] /= surfaces[k];
  const auto far = [&](std::size_t k) {
    const std::span<const double> lengths = path.lengths();
    return k > 0 && k < lengths.size() && std::abs(shift[k]) > near * std::min(lengths[k - 1], lengths[k]);
  };
  bool any = false;
  for (std::size_t k = 0; k < shift.size(); ++k) any = any || far(k);
  if (any) spread(path.mesh(), surfaces, shift);
  return path.slide(shift, most_stretch, surfaces);
}

bool forces_jump(std::span<const Corner> corners) {
  return std::ranges::any_of(corners, [](const Corner& corner) {
    return corner.stiffness != 0 || std::ranges::any_of(corner.sideways, [](double b) { return b != 0; });
  });
}

void add_force(const Corner& corner, double u, double* gradient) {
  for (std::size_t a = 0; a < corner.normal.size(); ++a)
    gradient[a] += (corner.stiffness * corner.normal[a] + corner.sideways[a]) * u;
}

void add_stiffness(const Corner& corner, double* block) {
  const std::vector<double>&normal = corner.normal, &sideways = corner.sideways;
  const std::size_t n = normal.size();
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      block[a * n + b] +=
          corner.stiffness * normal[a] * normal[b] + sideways[a] * normal[b] + normal[a] * sideways[b];
}

std::vector<double> crossings(const Kinks& kinks, const Polynomials& path) {
  std::vector<double> times;
  Along along(path);
  for (int k = 0; k < path.elements(); ++k) along.find(kinks, k, times);
  std::sort(times.begin(), times.end());
  const double last = path.times.back(), close = same_time * last;
  std::vector<double> result;
  for (const double t : times)
    if (t > close && t < last - close && (result.empty() || t > result.back() + close)) result.push_back(t);
  return result;
}

std::vector<double> crossings(const Kinks& kinks, const Path& path) {
  std::vector<double> times = crossings(kinks, Copy(path, path.duration()).pieces);
  for (double& t : times) t /= path.duration();
  return times;
}

}  // namespace extremal
