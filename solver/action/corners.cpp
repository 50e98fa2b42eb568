#include "action/corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "action/rule.hpp"
#include "action/tables.hpp"
#include "machine/aligned.hpp"
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

State state_at(const Polynomials& path, int element, double tau) {
  const int n = path.coordinates, count = path.degree + 1;
  const double start = path.times[element], h = path.times[element + 1] - start;
  std::array<double, max_degree + 1> value, derivative;
  lobatto_basis_at(path.degree, tau, value.data(), derivative.data());
  State state{std::vector<double>(n), std::vector<double>(n), start + tau * h};
  const double* nodes = path.nodes.data() + static_cast<std::size_t>(element) * count * n;
  for (int j = 0; j < count; ++j)
    for (int a = 0; a < n; ++a) {
      state.q[a] += value[j] * nodes[j * n + a];
      // Differences from the first node keep the digits of small ones.
      state.v[a] += derivative[j] / h * (nodes[j * n + a] - nodes[a]);
    }
  return state;
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
  explicit Along(const Polynomials& path) : path_(path) {}

  double at(const Lagrangian& f, const State& s) {
    return evaluate_at(f, s.q, s.v, s.t, Order::value, scratch_).value;
  }
  double at(const Lagrangian& f, int element, double tau) { return at(f, state_at(path_, element, tau)); }
  std::vector<double> slope(const Lagrangian& f, const State& s) {
    return evaluate_at(f, s.q, s.v, s.t, Order::gradient, scratch_).dq;
  }

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
  const int parts = 2 * path_.degree;
  std::vector<State> states;
  for (int i = 0; i <= parts; ++i) states.push_back(state_at(path_, element, static_cast<double>(i) / parts));
  std::vector<double> value(states.size());
  const auto interval = [&](int from, int to) {
    return Interval{static_cast<double>(from) / parts, static_cast<double>(to) / parts, value[from],
                    value[to]};
  };
  for (const KinkSurface& surface : kinks.surfaces()) {
    const Lagrangian& u = *surface.u;
    for (int i = 0; i <= parts; ++i) value[i] = at(u, states[i]);
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
  const int s = path.degree, n = path.coordinates, elements = path.elements();
  if (s < 2) return corners;
  const std::vector<double>& lobatto = lobatto_barycentric(s).nodes;
  const double gap = SchemeTables::of_gauss(s).node[0];
  Along along(path);
  for (int k = 1; k < elements + (closed != nullptr); ++k) {
    const bool at_end = k == elements;
    const State left = state_at(path, k - 1, lobatto[s - 1]), before = state_at(path, k - 1, 1);
    State right = state_at(path, at_end ? 0 : k, lobatto[1]), here = state_at(path, at_end ? 0 : k, 0);
    if (at_end)
      for (State* state : {&right, &here}) continue_beyond(path, *closed, *state);
    here.q = before.q;
    for (int a = 0; a < n; ++a) here.v[a] = 0.5 * (here.v[a] + before.v[a]);
    const double shorter = std::min(path.times[k] - path.times[k - 1],
                                    at_end ? path.times[1] : path.times[k + 1] - path.times[k]);
    for (const KinkSurface& surface : kinks.surfaces()) {
      if (surface.by_velocity) continue;
      const double u_left = along.at(*surface.u, left), u_right = along.at(*surface.u, right);
      if ((u_left < 0) == (u_right < 0)) continue;
      Corner corner{.node = k,
                    .u = along.at(*surface.u, here),
                    .rate = along.at(*surface.u_by_time, here),
                    .normal = along.slope(*surface.u, here)};
      for (int a = 0; a < n; ++a) corner.rate += corner.normal[a] * here.v[a];
      // The path crosses the surface as the signs on both sides say, and not by a cusp.
      const bool crosses = (corner.rate > 0) == (u_right > u_left);
      if (!crosses || !(std::abs(corner.u) < gap * shorter * std::abs(corner.rate))) continue;
      corner.stiffness = 2 * along.at(*surface.weight, here) / std::abs(corner.rate);
      corners.push_back(std::move(corner));
    }
  }
  return corners;
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
  return path.slide(shift, most_stretch);
}

void add_stiffness(const Corner& corner, double* block) {
  const std::size_t n = corner.normal.size();
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      block[a * n + b] += corner.stiffness * corner.normal[a] * corner.normal[b];
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
