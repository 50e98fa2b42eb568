#include "solve/search/balance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solution/solution.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::balance;

namespace {

/// ½q'ᵀL_q'q'q', L_q'q' taken at the equilibrium.
struct Tail {
  double time = 0;   ///< where the speed is slow
  double speed = 0;  ///< there, in the norm of L_q'q'
  double rate = 0;
};

double form(std::span<const double> matrix, std::span<const double> x) {
  double sum = 0;
  for (std::size_t a = 0; a < x.size(); ++a)
    for (std::size_t b = 0; b < x.size(); ++b) sum += x[a] * matrix[a * x.size() + b] * x[b];
  return sum;
}

class Tails {
 public:
  Tails(const Problem& problem, const Path& path)
      : problem_(problem), path_(trajectory_of(path)), q_(path.coordinates()), v_(path.coordinates()) {
    for (std::size_t k = 0; k + 1 < path_.times.size(); ++k) {
      const double at[] = {path_.times[k], 0.5 * (path_.times[k] + path_.times[k + 1])};
      for (double t : at) fastest_ = std::max(fastest_, speed(t));
    }
  }

  /// At t = 0, or at T. Nothing if the path does not rest there.
  std::optional<Tail> at(bool end) {
    const double T = path_.duration(), limit = tail_speed * fastest_;
    const double far = end ? T : 0;
    if (!(speed(far) < rest_speed * fastest_)) return std::nullopt;
    const std::vector<double> equilibrium = q_, none(q_.size(), 0);
    // The first time from that end at which it is no longer slow, by elements, then by halving.
    const std::size_t count = path_.times.size();
    std::size_t k = 1;
    const auto time = [&](std::size_t j) { return path_.times[end ? count - 1 - j : j]; };
    while (k < count && speed(time(k)) < limit) ++k;
    if (k == count) return std::nullopt;
    double slower = time(k - 1), faster = time(k);
    for (int step = 0; step < halvings; ++step) {
      const double middle = 0.5 * (slower + faster);
      (speed(middle) < limit ? slower : faster) = middle;
    }
    speed(slower);
    const PointValues values =
        evaluate_at(*problem_.lagrangian, equilibrium, none, far, Order::hessian, scratch_);
    std::vector<double> away(q_.size());
    for (std::size_t a = 0; a < away.size(); ++a) away[a] = q_[a] - equilibrium[a];
    const double squared = form(values.qq, away) / form(values.vv, away), kinetic = form(values.vv, v_);
    if (!(squared > 0) || !(kinetic > 0)) return std::nullopt;
    return Tail{std::abs(slower - far), std::sqrt(kinetic), std::sqrt(squared)};
  }

 private:
  double speed(double t) {
    path_.at(t, q_, v_);
    double sum = 0;
    for (double v : v_) sum += v * v;
    return std::sqrt(sum);
  }

  const Problem& problem_;
  const Trajectory path_;
  std::vector<double> q_, v_;
  Scratch scratch_;
  double fastest_ = 0;
};

}  // namespace

std::optional<double> shift_to_balance(const Problem& problem, const Path& path) {
  if (problem.ends.free > 0 || !problem.lagrangian->structure().autonomous) return std::nullopt;
  Tails tails(problem, path);
  const std::optional<Tail> start = tails.at(false), end = tails.at(true);
  if (!start || !end) return std::nullopt;
  const double at_start = std::log(start->speed) - start->rate * start->time,
               at_end = std::log(end->speed) - end->rate * end->time;
  const double shift = (at_start - at_end) / (start->rate + end->rate);
  if (!(shift > -start->time) || !(shift < end->time)) return std::nullopt;
  return shift;
}

bool shift_in_time(const Problem& problem, double shift, Path& path) {
  Tails tails(problem, path);
  const std::optional<Tail> start = tails.at(false), end = tails.at(true);
  if (!start || !end) return false;
  const double T = path.duration(), from = start->time / T, to = 1 - end->time / T;
  std::vector<double> times(path.mesh().begin(), path.mesh().end());
  for (double& tau : times)
    tau = shift / T * (tau < from ? tau / from : tau > to ? (1 - tau) / (1 - to) : 1.0);
  if (!path.move_mesh(times, 1, shortest_element)) return false;
  path.load_ends();
  return true;
}

}  // namespace extremal
