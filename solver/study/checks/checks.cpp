#include "study/checks/checks.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>

#include "linear/dense.hpp"
#include "machine/simd.hpp"
#include "problem/manifold.hpp"
#include "problem/nearby.hpp"
#include "problem/point_text.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/guess/starting_ends.hpp"

namespace extremal {
namespace {

/// Of the chord through the neighbours of sample k of the guess.
double velocity_at(const Problem& problem, int k, int a) {
  const Guess& guess = problem.guess;
  const std::size_t n = problem.coordinates();
  const int before = std::max(k - 1, 0), after = std::min(k + 1, static_cast<int>(guess.tau.size()) - 1);
  const double span = (guess.tau[after] - guess.tau[before]) * problem.duration.value;
  return (guess.q[after * n + a] - guess.q[before * n + a]) / span;
}

/// Samples of the guess in batches, as structure of arrays, and the value of L's remainder there.
class GuessValues {
 public:
  explicit GuessValues(const Problem& problem) : problem_(problem), n_(problem.coordinates()) {
    stride_ = 8 * most_lanes;
    rows_ = inputs_.reserve(std::size_t(2 * n_ + 2) * stride_);
  }

  /// The first sample from `first` on where L is not finite, or -1.
  int first_not_finite(int first, int count) {
    for (int begin = first; begin < first + count; begin += stride_) {
      const int used = std::min<int>(stride_, first + count - begin);
      for (int i = 0; i < stride_; ++i) load(begin + std::min(i, used - 1), i);
      double* value = rows_ + (2 * n_ + 1) * stride_;
      const Points points{static_cast<int>(stride_), stride_, rows_, rows_ + n_ * stride_,
                          rows_ + 2 * n_ * stride_};
      problem_.lagrangian->evaluate(points, Order::value, value, scratch_);
      for (int i = 0; i < used; ++i)
        if (!std::isfinite(value[i])) return begin + i;
    }
    return -1;
  }

 private:
  /// Sample k into lane i.
  void load(int k, int i) {
    const Guess& guess = problem_.guess;
    for (int a = 0; a < n_; ++a) {
      rows_[a * stride_ + i] = guess.q[std::size_t(k) * n_ + a];
      rows_[(n_ + a) * stride_ + i] = velocity_at(problem_, k, a);
    }
    rows_[2 * n_ * stride_ + i] = guess.tau[k] * problem_.duration.value;
  }

  const Problem& problem_;
  int n_;
  std::ptrdiff_t stride_;
  Scratch inputs_, scratch_;
  double* rows_;
};

/// The first sample of the guess where L is not finite, or -1.
int first_not_finite(const Problem& problem) {
  const Guess& guess = problem.guess;
  const int first = problem.ends.fixes(false),
            after = static_cast<int>(guess.tau.size()) - problem.ends.fixes(true);
  return GuessValues(problem).first_not_finite(first, after - first);
}

/// With the guess as a path begins from it: moved linearly in t onto the ends.
Problem with_guess_at_ends(const Problem& problem) {
  Problem moved = problem;
  const std::size_t n = problem.coordinates();
  const std::vector<double> ends = starting_ends(problem);
  std::vector<double> shift(2 * n);
  problem.guess.at(0, {shift.data(), n});
  problem.guess.at(1, {shift.data() + n, n});
  for (std::size_t e = 0; e < 2 * n; ++e) shift[e] = ends[e] - shift[e];
  Guess& guess = moved.guess;
  for (std::size_t k = 0; k < guess.tau.size(); ++k)
    for (std::size_t a = 0; a < n; ++a)
      guess.q[k * n + a] += (1 - guess.tau[k]) * shift[a] + guess.tau[k] * shift[n + a];
  return moved;
}

}  // namespace

bool is_finite_on_guess(const Problem& problem) {
  return !problem.guess.given() || first_not_finite(with_guess_at_ends(problem)) < 0;
}

void check_guess_finite(const Problem& given, const Location& at, bool by_momenta) {
  if (!given.guess.given()) return;
  const Problem problem = with_guess_at_ends(given);
  const Guess& guess = problem.guess;
  const int k = first_not_finite(problem);
  if (k < 0) return;
  const std::size_t n = problem.coordinates();
  const std::span<const double> q(guess.q.data() + k * n, n);
  const double t = guess.tau[k] * problem.duration.value;
  if (problem.manifold && !problem.manifold->regular(q, t))
    throw SceneError(at,
                     fmt::format("the gradients of the constraints vanish, or depend on each other, on the "
                                 "guess at t = {:.6g}: {}; give one that goes past",
                                 t, point_text(problem.names, q)));
  // The Lagrangian of a Hamiltonian has the velocities in the range of H_p alone.
  std::string velocities;
  if (by_momenta)
    for (int a = 0; a < problem.coordinates(); ++a)
      velocities += fmt::format(", {}' = {:.6g}", problem.names[a], velocity_at(problem, k, a));
  throw SceneError(
      at,
      fmt::format("L is not finite on the guess at t = {:.6g}: {}{}{}", t, point_text(problem.names, q),
                  velocities, velocities.empty() ? "" : "; momenta may not reach these velocities, ∂H/∂p"));
}

void check_energy_at_ends(const Problem& problem, const Location& at) {
  constexpr double roundoff = 1e-9;
  if (!problem.duration.energy) return;
  const std::size_t n = problem.coordinates();
  const double energy = *problem.duration.energy;
  Scratch scratch;
  std::vector<double> unused, v, rest(n, 0);
  for (const bool end : {false, true}) {
    if (!problem.ends.fixes(end)) continue;
    const double* q = problem.ends.offset.data() + (end ? n : 0);
    NearbyPoints points(problem);
    const auto convex = [&](const std::vector<double>& velocity) {
      const PointValues values =
          evaluate_at(*problem.lagrangian, {q, n}, velocity, 0, Order::hessian, scratch);
      const Eigen::Map<const Eigen::MatrixXd> mass(values.vv.data(), n, n);
      return positive_definite(mass);
    };
    bool bounded = convex(rest);
    for (int k = 0; k < 8 && bounded; ++k) {
      points.next(unused, v);
      bounded = convex(v);
    }
    const double least = -evaluate_at(*problem.lagrangian, {q, n}, rest, 0, Order::value, scratch).value;
    if (bounded && energy < least - roundoff * std::max(std::abs(energy), std::abs(least)))
      throw SceneError(
          at, fmt::format(
                  "energy = {}, but at the {} ({}) it is at least {:.6g}, its value at rest; raise it, or "
                  "move this end",
                  energy, end ? "end" : "start", point_text(problem.names, {q, n}), least));
  }
}

bool where_determines(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  const std::vector<double> first = starting_ends(problem);
  std::vector<double> gradient(2 * n);
  unsigned seed = 0;
  int known = 0;
  for (const double distance : limits::bordered::state_distances) {
    const std::vector<double> ends = moved_ends(problem, first, distance, seed++);
    const double value = problem.duration.where({ends.data(), n}, {ends.data() + n, n}, gradient);
    if (!std::isfinite(value)) continue;
    ++known;
    std::vector<double> change(problem.ends.free, 0), terms(problem.ends.free, 0);
    for (const Triplet& z : problem.ends.z) {
      change[z.column] += z.value * gradient[z.row];
      terms[z.column] += std::abs(z.value * gradient[z.row]);
    }
    for (std::size_t j = 0; j < change.size(); ++j)
      if (!(std::abs(change[j]) <= limits::bordered::structural * terms[j])) return true;
  }
  return known < 2;
}

void check_free_steps(const Problem& problem, const Location& at) {
  if (problem.phase)
    throw SceneError(at,
                     "free steps need a Hamiltonian whose second derivative by the momenta is regular; leave "
                     "'steps' out");
  if (!problem.lagrangian->structure().autonomous)
    throw SceneError(at,
                     "free steps give all elements the same energy, which is not conserved where L depends "
                     "on t; leave 'steps' out");
  if (problem.copies)
    throw SceneError(at,
                     "free steps give all elements the same energy, which forces change; leave 'steps' out");
  if (problem.initial)
    throw SceneError(at,
                     "free steps need ends: from initial data each element follows the one before; leave "
                     "'steps' out");
  if (problem.periodic)
    throw SceneError(at,
                     "free steps need ends: the nodes of a closed orbit can all be shifted along it; leave "
                     "'steps' out, or give start and end");
  if (problem.duration.where)
    throw SceneError(at, "with free steps a free duration is closed by 'energy', not by 'where'");
  if (problem.lagrangian->kinks())
    throw SceneError(at, "free steps need a smooth L, without abs, min, max and step; leave 'steps' out");
}

}  // namespace extremal
