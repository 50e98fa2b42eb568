#include "solve/bordered/dependence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "linear/dense.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

/// Integrals and conditions at a path.
struct Targets {
  Eigen::MatrixXd columns;  ///< their derivatives, of length one, or zero where terms cancel
  Eigen::VectorXd missed;   ///< what they are missed by, over the lengths of their derivatives
  Eigen::VectorXd unknown;  ///< roundoff of their terms, likewise
};

Targets targets_at(const BorderedEquations& equations, int first, int count) {
  Targets at{Eigen::MatrixXd::Zero(equations.of_path(), count), equations.values().segment(first, count),
             Eigen::VectorXd::Zero(count)};
  Eigen::MatrixXd terms = at.columns;
  for (const auto& e : equations.entries()) {
    const int j = e.col() - first;
    if (e.row() >= equations.of_path() || j < 0 || j >= count) continue;
    at.columns(e.row(), j) += e.value();
    terms(e.row(), j) += std::abs(e.value());
  }
  for (int j = 0; j < count; ++j) {
    const double length = at.columns.col(j).norm();
    if (length > dependent * terms.col(j).norm()) {
      at.columns.col(j) /= length;
      at.missed[j] /= length;
      at.unknown[j] = unit_roundoff * equations.target_sizes()[j] / length;
    } else {
      at.columns.col(j).setZero();
    }
  }
  return at;
}

/// By how much the first `count` targets are missed, by their terms.
double missed_by(const BorderedEquations& equations, int first, int count) {
  double most = 0;
  for (int j = 0; j < count; ++j)
    most = std::max(most, std::abs(equations.values()[first + j]) / equations.target_sizes()[j]);
  return most;
}

/// Whether roundoff moves the root of a condition as far as to where its derivative vanishes: r = r'' d²/2
/// beside it, of terms as large as over the path.
bool has_double_root(const EndCondition& condition, const BorderedState& state, int coordinates) {
  const Path& path = state.path;
  const std::size_t all = path.coordinates();
  const std::span<const double> start{path.node(0), all}, end{path.node(path.elements()), all};
  Eigen::VectorXd slope(2 * all);
  Eigen::MatrixXd second(2 * all, 2 * all);
  condition.function(start, end, {slope.data(), 2 * all}, {second.data(), 4 * all * all});
  double size = path_size(state, coordinates).value;
  for (const std::span<const double> point : {start, end})
    for (const double x : point) size = std::max(size, std::abs(x));
  return slope.norm() <= std::sqrt(met) * second.norm() * size;
}

/// What is wrong with a condition that has one; empty: nothing.
std::string double_root(const Extension& extension, const BorderedState& state, int coordinates) {
  const auto among = [&](const std::vector<EndCondition>& conditions, const char* name) -> std::string {
    for (std::size_t i = 0; i < conditions.size(); ++i)
      if (has_double_root(conditions[i], state, coordinates))
        return fmt::format(
            "the derivative of {} {} vanishes where it holds, as of a square, so that its root is "
            "known to half of the digits; write it without the square: \"x(T) = 1\", not \"x(T)^2 - 2*x(T) + "
            "1 = 0\"",
            name, i + 1);
    return {};
  };
  std::string fault = among(extension.conditions, "condition");
  return fault.empty() ? among(extension.where, "'where' condition") : fault;
}

}  // namespace

std::string dependence(BorderedEquations& equations, const BorderedState& state, double accuracy) {
  const Extension& extension = equations.extension();
  if (std::string fault = double_root(extension, state, equations.coordinates()); !fault.empty())
    return fault;
  const int integrals = extension.multipliers(), count = integrals + equations.conditions();
  if (count == 0) return {};
  const auto name = [&](int j) {
    return j < integrals ? fmt::format("integral {}", j + 1) : fmt::format("condition {}", j - integrals + 1);
  };
  const int first = equations.first_constant() + extension.unknowns();
  const Targets at = targets_at(equations, first, count);
  for (int j = 0; j < count; ++j)
    if (at.columns.col(j).isZero(0))
      return fmt::format(
          "{} does not change with the path, to first order: it is at an extremum, or the ends "
          "determine it; leave it out, or change its value",
          name(j));
  if (at.columns.rows() < count)
    return fmt::format(
        "{} integrals and conditions are more than the {} unknowns of the path; take more elements", count,
        at.columns.rows());
  const auto [u, sizes, v] = singular_value_decomposition(at.columns);
  std::vector<std::string> names;
  for (int j = 0; j < count; ++j)
    if (std::abs(v(j, count - 1)) > takes_part) names.push_back(name(j));
  if (!(sizes[count - 1] > dependent))
    return fmt::format("{} depend on each other along the path found: leave one of them out",
                       fmt::join(names, ", "));
  // The shortest step that meets them all, to first order: Cᵀ d = −missed.
  Eigen::VectorXd step = Eigen::VectorXd::Zero(equations.unknowns());
  step.head(at.columns.rows()) = -u * sizes.cwiseInverse().asDiagonal() * v.transpose() * at.missed;
  const double missed = missed_by(equations, first, count), distance = step.lpNorm<Eigen::Infinity>();
  // A target at its extremum is met to the last digit beside it, by whatever path.
  const double undetermined = (u * sizes.cwiseInverse().asDiagonal() * v.transpose().cwiseAbs() * at.unknown)
                                  .lpNorm<Eigen::Infinity>();
  const auto is_met = [&] {
    BorderedState moved = state;
    return equations.apply(moved, step, 1) && equations.evaluate(moved, false) &&
           missed_by(equations, first, count) <= std::max(met, corrected * missed);
  };
  const double size = path_size(state, equations.coordinates()).value;
  const bool shortest = distance <= unit_roundoff * shortest_step * size;
  if (undetermined <= determined * size && distance <= accuracy && (shortest || missed <= met || is_met()))
    return {};
  return fmt::format(
      "the path runs into a point at which {} to first order, and is {:.1e} away from meeting {}: "
      "multipliers grow without bound there, and it is no extremal; try another guess, or conditions whose "
      "derivatives "
      "are independent",
      names.size() > 1 ? fmt::format("{} depend on each other", fmt::join(names, ", "))
                       : fmt::format("{} does not change with the path", names[0]),
      std::max(distance, undetermined), names.size() > 1 ? "them" : "it");
}

}  // namespace extremal
