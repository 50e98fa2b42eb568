#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints/constraints.hpp"
#include "study/constraints/contradiction.hpp"
#include "study/constraints/limits.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;
using Eigen::Index;
using Eigen::VectorXd;

/// The guess of a constrained problem on its manifold.
class ConstrainedGuess {
 public:
  ConstrainedGuess(const Scene& scene, Problem& problem)
      : scene_(scene), problem_(problem), manifold_(*problem.manifold), n_(problem.coordinates()) {}

  void project(const EndPoints& ends) {
    if (problem_.initial) return;
    if (!problem_.guess.given()) return project_lines(line(ends), {});
    const Guess given = problem_.guess;
    const std::size_t failed = project(problem_.guess);
    if (failed == problem_.guess.tau.size()) return;
    check_contradictions(scene_, problem_, given.q);
    const double t = time(given.tau[failed]);
    const VectorXd g = manifold_.at({given.q.data() + failed * n_, n_}, t).g;
    Index worst = 0;
    g.cwiseAbs().maxCoeff(&worst);
    throw SceneError(
        scene_.guess.at,
        fmt::format("the guess at t = {:.6g} cannot be moved onto the constraints: there '{}' has "
                    "left − right = {:.6g}; give one that satisfies them",
                    t, scene_.system.constraints[worst].value, g[worst]));
  }

  /// Bent where they pass a point that is as near to one side of the manifold as to another.
  void project_lines(const Guess& lines, const std::vector<double>& waypoints) {
    std::minstd_rand random{7};
    std::vector<double> aside(n_), scaled(n_);
    for (double& x : aside) x = 2.0 * random() / std::minstd_rand::max() - 1;
    const double size = size_of(lines);
    for (const double bend : bends) {
      for (std::size_t a = 0; a < n_; ++a) scaled[a] = bend * (size > 0 ? size : 1) * aside[a];
      Guess guess = bent(lines, waypoints, scaled);
      if (project(guess) < guess.tau.size() || jumps(guess)) continue;
      problem_.guess = std::move(guess);
      return;
    }
    check_contradictions(scene_, problem_, lines.q);
    throw SceneError(
        scene_.boundary.at,
        waypoints.empty()
            ? "the line between the ends cannot be moved onto the constraints; give a guess near "
              "them"
            : "the lines between ends and waypoints cannot be moved onto the constraints; give a "
              "guess near them");
  }

 private:
  /// The largest coordinate or range of one.
  double size_of(const Guess& guess) const {
    double size = 0;
    for (std::size_t a = 0; a < n_; ++a) {
      double low = guess.q[a], high = low;
      for (std::size_t k = a; k < guess.q.size(); k += n_) {
        low = std::min(low, guess.q[k]);
        high = std::max(high, guess.q[k]);
      }
      size = std::max({size, std::abs(low), std::abs(high), high - low});
    }
    return size;
  }

  double time(double tau) const { return tau * problem_.duration.value; }

  /// Number of the sample that cannot be moved onto the manifold; their count if all can.
  std::size_t project(Guess& guess) const {
    for (std::size_t k = 0; k < guess.tau.size(); ++k)
      if (!manifold_.project({guess.q.data() + k * n_, n_}, time(guess.tau[k]))) return k;
    return guess.tau.size();
  }

  Guess line(const EndPoints& ends) const {
    Guess guess;
    for (int k = 0; k <= guess_steps; ++k) {
      const double tau = static_cast<double>(k) / guess_steps;
      guess.tau.push_back(tau);
      for (std::size_t a = 0; a < n_; ++a)
        guess.q.push_back(ends.start[a] + tau * (ends.end[a] - ends.start[a]));
    }
    return guess;
  }

  /// With 4 τ (1 − τ) `aside` added to each line, τ in [0, 1] along it.
  Guess bent(Guess lines, std::vector<double> waypoints, const std::vector<double>& aside) const {
    waypoints.insert(waypoints.begin(), 0);
    waypoints.push_back(1);
    auto to = waypoints.begin() + 1;
    for (std::size_t k = 0; k < lines.tau.size(); ++k) {
      while (to + 1 != waypoints.end() && lines.tau[k] > *to) ++to;
      const double tau = (lines.tau[k] - *(to - 1)) / (*to - *(to - 1));
      for (std::size_t a = 0; a < n_; ++a) lines.q[k * n_ + a] += 4 * tau * (1 - tau) * aside[a];
    }
    return lines;
  }

  bool jumps(const Guess& guess) const {
    double length = 0, longest = 0;
    for (std::size_t k = n_; k < guess.q.size(); k += n_) {
      double step = 0;
      for (std::size_t a = 0; a < n_; ++a) step += std::pow(guess.q[k + a] - guess.q[k + a - n_], 2);
      length += std::sqrt(step);
      longest = std::max(longest, std::sqrt(step));
    }
    return longest > jump * length && length > 0;
  }

  const Scene& scene_;
  Problem& problem_;
  const Manifold& manifold_;
  std::size_t n_;
};

}  // namespace

void project_guess(const Scene& scene, const EndPoints& ends, Problem& problem) {
  ConstrainedGuess(scene, problem).project(ends);
}

void project_lines(const Scene& scene, const std::vector<double>& waypoints, Problem& problem) {
  const Guess lines = problem.guess;
  ConstrainedGuess(scene, problem).project_lines(lines, waypoints);
}

}  // namespace extremal
