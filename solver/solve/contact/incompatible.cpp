#include "solve/contact/incompatible.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>
#include <vector>

#include "linear/dense.hpp"
#include "problem/inequalities.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// By how much inequalities, and constraints of the system, are missed at a point, as distances to first
/// order: zero where one is kept.
struct Missed {
  VectorXd by;
  MatrixXd slopes;  ///< of what is missed: a step s changes it by −slopes s
};

Missed missed_at(const Problem& problem, const VectorXd& q, double t) {
  const std::span<const double> point(q.data(), static_cast<std::size_t>(q.size()));
  const ConstraintValues kept = problem.inequalities->all->at(point, t);
  const Index count = kept.g.size(), m = problem.manifold ? problem.manifold->constraints() : 0;
  Missed missed{VectorXd::Zero(count + m), MatrixXd::Zero(count + m, q.size())};
  const auto put = [&](Index row, double g, const VectorXd& slope) {
    missed.by[row] = -g / slope.norm();
    missed.slopes.row(row) = slope.transpose() / slope.norm();
  };
  for (Index k = 0; k < count; ++k)
    if (kept.g[k] < 0) put(k, kept.g[k], kept.slopes.row(k));
  if (m == 0) return missed;
  const ConstraintValues held = problem.manifold->at(point, t);
  for (Index k = 0; k < m; ++k)
    if (held.g[k] != 0) put(count + k, held.g[k], held.slopes.row(k));
  return missed;
}

/// What remains where |missed| is least, by steps of Gauss and Newton from q; nothing if none remains, or the
/// steps do not end.
std::optional<Missed> least_missed(const Problem& problem, VectorXd q, double t) {
  const double negligible = negligible_miss * (q.norm() > 0 ? q.norm() : 1);
  Missed missed = missed_at(problem, q, t);
  for (int step = 0; step < most_approaches; ++step) {
    if (!(missed.by.norm() > negligible)) return std::nullopt;
    const VectorXd whole = least_norm(missed.slopes, missed.by);
    if (!whole.allFinite()) return std::nullopt;
    const double before = missed.by.norm();
    double part = 1;
    for (; part >= least_approach; part /= 2) {
      Missed there = missed_at(problem, q + part * whole, t);
      if (!(there.by.norm() < (1 - negligible_miss) * before)) continue;
      q += part * whole;
      missed = std::move(there);
      break;
    }
    if (part < least_approach) return missed;
  }
  return std::nullopt;
}

}  // namespace

std::string incompatible_inequalities(const Problem& problem, const Guess& guess) {
  if (problem.extension && problem.extension->constants() > 0) return {};
  const Index n = problem.coordinates();
  std::optional<Missed> worst;
  double when = 0;
  VectorXd near(n);
  for (int place = 0; place <= compared_times; ++place) {
    const double tau = static_cast<double>(place) / compared_times, t = tau * problem.duration.value;
    guess.at(tau, {near.data(), static_cast<std::size_t>(n)});
    const double size = near.norm() > 0 ? near.norm() : 1;
    std::optional<Missed> least;
    for (int start = 0; start < compared_starts; ++start) {
      VectorXd q = near;
      for (Index a = 0; a < n; ++a) q[a] += start * size * std::cos(1.0 + double(a) + 2.4 * start);
      std::optional<Missed> found = least_missed(problem, q, t);
      const bool nearer = !least || (found && found->by.norm() < least->by.norm());
      if (!found || nearer) least = std::move(found);
      if (!least) break;
    }
    if (!least || (worst && !(least->by.norm() > worst->by.norm()))) continue;
    worst = std::move(least);
    when = t;
  }
  if (!worst) return {};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < problem.inequalities->texts.size(); ++k)
    if (worst->by[static_cast<Index>(k)] != 0)
      names.push_back(fmt::format("'{}'", problem.inequalities->texts[k]));
  return fmt::format(
      "no point near the guess keeps {} at t = {:.6g}: {} missed there by {:.3g} at the least; "
      "correct {}, or give a guess near points that are allowed",
      fmt::join(names, " and "), when, names.size() > 1 ? "one of them is" : "it is",
      worst->by.lpNorm<Eigen::Infinity>(), names.size() > 1 ? "them" : "it");
}

}  // namespace extremal
