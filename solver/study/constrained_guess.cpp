#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints.hpp"
#include "study/limits.hpp"

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
    if (!problem_.guess.given()) return project_default(ends);
    const Guess given = problem_.guess;
    const std::size_t failed = project(problem_.guess);
    if (failed == problem_.guess.tau.size()) return;
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

 private:
  double time(double tau) const { return tau * problem_.duration.value; }

  /// Number of the sample that cannot be moved onto the manifold; their count if all can.
  std::size_t project(Guess& guess) const {
    for (std::size_t k = 0; k < guess.tau.size(); ++k)
      if (!manifold_.project({guess.q.data() + k * n_, n_}, time(guess.tau[k]))) return k;
    return guess.tau.size();
  }

  /// The line between the ends, bent where it passes a point that is as near to one side of the manifold as
  /// to another.
  void project_default(const EndPoints& ends) {
    std::minstd_rand random{7};
    std::vector<double> aside(n_);
    for (double& x : aside) x = 2.0 * random() / std::minstd_rand::max() - 1;
    double size = 0;
    for (std::size_t a = 0; a < n_; ++a)
      size = std::max(
          {size, std::abs(ends.start[a]), std::abs(ends.end[a]), std::abs(ends.end[a] - ends.start[a])});
    for (const double bend : bends) {
      Guess line = bent(ends, aside, bend * (size > 0 ? size : 1));
      if (project(line) < line.tau.size() || jumps(line)) continue;
      problem_.guess = std::move(line);
      return;
    }
    throw SceneError(
        scene_.boundary.at,
        "the line between the ends cannot be moved onto the constraints; give a guess near them");
  }

  Guess bent(const EndPoints& ends, const std::vector<double>& aside, double size) const {
    Guess guess;
    for (int k = 0; k <= guess_steps; ++k) {
      const double tau = static_cast<double>(k) / guess_steps;
      guess.tau.push_back(tau);
      for (std::size_t a = 0; a < n_; ++a)
        guess.q.push_back(ends.start[a] + tau * (ends.end[a] - ends.start[a]) +
                          4 * tau * (1 - tau) * size * aside[a]);
    }
    return guess;
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

}  // namespace extremal
