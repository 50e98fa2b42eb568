#include "solve/bordered/dependence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "solve/bordered/limits.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

/// Their derivatives, a column for each; columns of length one, or zero where terms cancel.
Eigen::MatrixXd derivatives(const BorderedEquations& equations, int first, int count) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(equations.of_path(), count), terms = columns;
  for (const auto& e : equations.entries()) {
    const int j = e.col() - first;
    if (e.row() >= equations.of_path() || j < 0 || j >= count) continue;
    columns(e.row(), j) += e.value();
    terms(e.row(), j) += std::abs(e.value());
  }
  for (int j = 0; j < count; ++j) {
    const double length = columns.col(j).norm();
    if (length > dependent * terms.col(j).norm())
      columns.col(j) /= length;
    else
      columns.col(j).setZero();
  }
  return columns;
}

}  // namespace

std::string dependence(const BorderedEquations& equations) {
  const Extension& extension = equations.extension();
  const int integrals = extension.multipliers(), count = integrals + equations.conditions();
  if (count == 0) return {};
  const auto name = [&](int j) {
    return j < integrals ? fmt::format("integral {}", j + 1) : fmt::format("condition {}", j - integrals + 1);
  };
  const Eigen::MatrixXd columns =
      derivatives(equations, equations.first_constant() + extension.unknowns(), count);
  for (int j = 0; j < count; ++j)
    if (columns.col(j).isZero(0))
      return fmt::format(
          "{} does not change with the path, to first order: it is at an extremum, or the ends "
          "determine it; leave it out, or change its value",
          name(j));
  if (columns.rows() < count)
    return fmt::format(
        "{} integrals and conditions are more than the {} unknowns of the path; take more elements", count,
        columns.rows());
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(columns, Eigen::ComputeThinV);
  if (svd.singularValues()[count - 1] > dependent) return {};
  std::vector<std::string> names;
  for (int j = 0; j < count; ++j)
    if (std::abs(svd.matrixV()(j, count - 1)) > takes_part) names.push_back(name(j));
  return fmt::format("{} depend on each other along the path found: leave one of them out",
                     fmt::join(names, ", "));
}

}  // namespace extremal
