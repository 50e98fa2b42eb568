#include "problem/reduction.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace extremal {

namespace {

/// Root mean square over the orbit of what a symmetry leaves, of the range of each coordinate.
constexpr double nearly = 0.02;
/// A range this much smaller than the largest is none.
constexpr double none = 1e-10;
/// Differences of ∂L at a point and its image, relative.
constexpr double roundoff = 1e-12;
constexpr int samples = 48, points = 16, most_coordinates = 64;
/// Free ends that any solve may have.
constexpr int cheap_ends = 16;

using Values = std::vector<double>;

/// The guess as an orbit, t in units of T.
class Orbit {
 public:
  Orbit(const Guess& guess, SignedPermutation closing)
      : guess_(guess), closing_(std::move(closing)), opening_(closing_.inverse()), n_(closing_.size()) {
    ranges_.resize(n_);
    const Values q = sampled([&](int k, double* to) { at(time(k), to); });
    for (int a = 0; a < n_; ++a) {
      const auto [low, high] = std::minmax_element(&q[a * samples], &q[a * samples] + samples);
      ranges_[a] = *high - *low;
    }
    extent_ = *std::max_element(ranges_.begin(), ranges_.end());
  }
  static double time(int k) { return (k + 0.5) / samples; }
  double extent() const { return extent_; }

  /// At −1 < t < 2.
  void at(double t, double* to) const {
    const double whole = std::floor(t);
    if (whole == 0) return guess_.at(t, {to, std::size_t(n_)});
    Values q(n_);
    guess_.at(t - whole, q);
    (whole > 0 ? closing_ : opening_).apply(q.data(), to);
  }

  /// P with q(time(t)) = P q(t).
  template <class Time>
  std::optional<SignedPermutation> match(const Time& image) const {
    const Values q = sampled([&](int k, double* to) { at(time(k), to); });
    const Values moved = sampled([&](int k, double* to) { at(image(time(k)), to); });
    SignedPermutation result = SignedPermutation::identity(n_);
    std::vector<char> taken(n_, 0);
    for (int a = 0; a < n_; ++a) {
      double least = INFINITY;
      const auto consider = [&](int b, double sign) {
        double sum = 0;
        for (int k = 0; k < samples; ++k) sum += square(moved[a * samples + k] - sign * q[b * samples + k]);
        if (!(sum < least)) return;
        least = sum;
        result.from[a] = b;
        result.sign[a] = sign;
      };
      const double enough =
          samples * square(nearly * (ranges_[a] > none * extent_ ? ranges_[a] : none * extent_));
      consider(a, 1);
      consider(a, -1);
      for (int b = 0; b < n_ && least > enough; ++b)
        for (const double sign : {1.0, -1.0}) consider(b, sign);
      if (least > enough || std::exchange(taken[result.from[a]], 1)) return std::nullopt;
    }
    return result;
  }

 private:
  static double square(double x) { return x * x; }
  /// Coordinate after coordinate.
  template <class Fill>
  Values sampled(const Fill& fill) const {
    Values q(n_), result(n_ * samples);
    for (int k = 0; k < samples; ++k) {
      fill(k, q.data());
      for (int a = 0; a < n_; ++a) result[a * samples + k] = q[a];
    }
    return result;
  }

  const Guess& guess_;
  SignedPermutation closing_, opening_;
  int n_;
  Values ranges_;
  double extent_ = 0;
};

/// L(P q, ±P q') = L(q, q') about the guess; `direction` is ±1.
bool leaves_unchanged(const Problem& problem, const Orbit& orbit, const SignedPermutation& p,
                      double direction) {
  const int n = p.size();
  Values q(n), v(n), image_q(n), image_v(n), expected(n);
  std::minstd_rand random{11};
  const auto number = [&] { return 2.0 * random() / std::minstd_rand::max() - 1; };
  const auto same = [&](std::span<const double> found, const Values& wanted) {
    double size = 0;
    for (const double x : wanted) size = std::max(size, std::abs(x));
    for (int a = 0; a < n; ++a)
      if (!(std::abs(found[a] - wanted[a]) <= roundoff * size)) return false;
    return true;
  };
  Scratch scratch, image_scratch;
  for (int k = 0; k < points; ++k) {
    orbit.at((k + 0.5) / points, q.data());
    for (int a = 0; a < n; ++a) {
      q[a] += 0.1 * orbit.extent() * number();
      v[a] = 2 * orbit.extent() / problem.duration.value * number();
    }
    p.apply(q.data(), image_q.data());
    p.apply(v.data(), image_v.data());
    for (double& x : image_v) x *= direction;
    const PointValues at = evaluate_at(*problem.lagrangian, q, v, 0, Order::gradient, scratch);
    const PointValues image =
        evaluate_at(*problem.lagrangian, image_q, image_v, 0, Order::gradient, image_scratch);
    p.apply(at.dq.data(), expected.data());
    if (!same(image.dq, expected)) return false;
    p.apply(at.dv.data(), expected.data());
    for (double& x : expected) x *= direction;
    if (!same(image.dv, expected)) return false;
  }
  return true;
}

/// M for the most turns.
void find_turn(const Problem& problem, const Orbit& orbit, const SignedPermutation& closing,
               Reduction& reduction) {
  const int n = closing.size();
  for (int turns = std::max(4, n); turns > 1; --turns) {
    const auto turn = orbit.match([&](double t) { return t + 1.0 / turns; });
    if (!turn) continue;
    SignedPermutation all = *turn;
    for (int k = 1; k < turns; ++k) all = all * *turn;
    if (all != closing || !leaves_unchanged(problem, orbit, *turn, 1)) continue;
    reduction.turns = turns;
    reduction.turn = *turn;
    return;
  }
  reduction.turn = closing;
}

/// Dimension of { q = P q }, P² = 1.
int invariant(const SignedPermutation& p) {
  int twice = p.size();
  for (int a = 0; a < p.size(); ++a)
    if (p.from[a] == a) twice += p.sign[a] > 0 ? 1 : -1;
  return twice / 2;
}

/// Unless ends that the mirror leaves free cost more than half of the path saves.
void find_mirror(const Problem& problem, const Orbit& orbit, Reduction& reduction) {
  const auto mirror = orbit.match([](double t) { return -t; });
  if (!mirror) return;
  const SignedPermutation about_end = reduction.turn * *mirror;
  if (*mirror == mirror->inverse() && about_end == about_end.inverse() &&
      invariant(*mirror) + invariant(about_end) <= std::max(mirror->size(), cheap_ends) &&
      leaves_unchanged(problem, orbit, *mirror, -1))
    reduction.mirror = about_end;
}

/// q = P q at an end, P² = 1, as independent rows.
void hold(const SignedPermutation& p, bool at_end, BoundaryRelation& boundary) {
  const int n = p.size(), end = at_end ? n : 0;
  for (int a = 0; a < n; ++a) {
    if (p.from[a] == a && p.sign[a] < 0) boundary.fix(a, at_end, 0);
    if (p.from[a] <= a) continue;
    const int row = boundary.add_row(0);
    boundary.add(row, end + a, 1);
    boundary.add(row, end + p.from[a], -p.sign[a]);
  }
}

/// q(0) and q(T) = R q(0) as a function of q(0).
EndFunction at_start(EndFunction where, const SignedPermutation& closing) {
  return [where = std::move(where), closing](std::span<const double> start, std::span<const double>,
                                             std::span<double> gradient) {
    const std::size_t n = start.size();
    Values end(n);
    closing.apply(start.data(), end.data());
    const double value = where(start, end, gradient);
    for (std::size_t a = 0; a < n; ++a) gradient[closing.from[a]] += closing.sign[a] * gradient[n + a];
    std::fill(gradient.begin() + static_cast<std::ptrdiff_t>(n), gradient.end(), 0.0);
    return value;
  };
}

/// The part of the guess, mean of all its images unless it is a motion.
Guess part_of(const Orbit& orbit, const Guess& guess, const Reduction& reduction) {
  const int n = reduction.turn.size(), parts = guess.motion() ? 1 : reduction.parts();
  const double length = 1.0 / reduction.parts();
  Guess result;
  result.samples_a_step = guess.samples_a_step;
  for (const double tau : guess.tau)
    if (tau < length * (1 - none)) result.tau.push_back(tau);
  result.tau.push_back(length);
  result.q.assign(result.tau.size() * n, 0);
  const SignedPermutation back = reduction.turn.inverse();
  Values q(n), image(n);
  SignedPermutation undo = SignedPermutation::identity(n);
  for (int i = 0; i < parts; ++i) {
    // q(k T/turns + t) = M^k q(t), and q((k + 1) T/turns − t) = M^k M S q(t).
    const bool mirrored = reduction.mirror && i % 2 == 1;
    const SignedPermutation map = mirrored ? *reduction.mirror * undo : undo;
    for (std::size_t k = 0; k < result.tau.size(); ++k) {
      orbit.at(mirrored ? (i + 1) * length - result.tau[k] : i * length + result.tau[k], q.data());
      map.apply(q.data(), image.data());
      for (int a = 0; a < n; ++a) result.q[k * n + a] += image[a] / parts;
    }
    if (mirrored || !reduction.mirror) undo = undo * back;
  }
  for (double& tau : result.tau) tau /= length;
  result.tau.back() = 1;
  return result;
}

Problem part_of(const Problem& problem, const Orbit& orbit, const SignedPermutation& closing,
                const Reduction& reduction) {
  const int n = problem.coordinates();
  Problem part = problem;
  part.boundary = {.coordinates = n, .rows = 0, .matrix = {}, .value = {}, .momenta = {}, .costs = {}};
  if (reduction.mirror) {
    part.periodic = false;
    hold(reduction.turn.inverse() * *reduction.mirror, false, part.boundary);
    hold(*reduction.mirror, true, part.boundary);
  } else {
    for (int a = 0; a < n; ++a) {
      const int row = part.boundary.add_row(0);
      part.boundary.add(row, n + a, 1);
      part.boundary.add(row, reduction.turn.from[a], -reduction.turn.sign[a]);
    }
  }
  part.duration.value /= reduction.parts();
  if (part.duration.where) part.duration.where = at_start(std::move(part.duration.where), closing);
  part.guess = part_of(orbit, problem.guess, reduction);
  part.ends = solve_relation(part.boundary);
  part.symmetries = continuous_symmetries(part);
  return part;
}

}  // namespace

std::shared_ptr<const Reduction> reduction_of(const Problem& problem) {
  const bool searched = problem.periodic && problem.guess.given() &&
                        problem.coordinates() <= most_coordinates &&
                        problem.lagrangian->structure().autonomous;
  const auto closing = searched ? SignedPermutation::of(closing_map(problem)) : std::nullopt;
  if (!closing) return nullptr;
  const Orbit orbit(problem.guess, *closing);
  if (!(orbit.extent() > 0)) return nullptr;
  Reduction reduction;
  find_turn(problem, orbit, *closing, reduction);
  find_mirror(problem, orbit, reduction);
  if (reduction.parts() == 1) return nullptr;
  reduction.part = part_of(problem, orbit, *closing, reduction);
  return std::make_shared<const Reduction>(std::move(reduction));
}

}  // namespace extremal
