#include "solve/periodic/orbit_index.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/node_form.hpp"
#include "solve/periodic/limits.hpp"
#include "solve/periodic/moving_symmetries.hpp"

namespace extremal {

using namespace limits::orbit_index;

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Both ends by the numbers that the relation leaves free.
MatrixXd ends_of(const Problem& problem) {
  MatrixXd ends = MatrixXd::Zero(2 * problem.coordinates(), problem.ends.free);
  for (const Triplet& z : problem.ends.z) ends(z.row, z.column) = z.value;
  return ends;
}

/// The field of the shift in time, if L does not depend on t, and those of symmetries that move the path.
std::vector<NodeValues> known_null_fields(const Problem& problem, const SecondVariation& variation,
                                          const Trajectory& path) {
  const int n = problem.coordinates(), nodes = variation.count() + 1;
  std::vector<NodeValues> fields;
  MatrixXd q(n, nodes), v(n, nodes);
  for (int k = 0; k < nodes; ++k) {
    const double t = k > 0 ? variation.end(k - 1) : 0;
    path.at(t, {&q(0, k), &q(0, k) + n}, {&v(0, k), &v(0, k) + n});
  }
  if (problem.shifts_in_time()) fields.push_back(v);
  for (const Generator& symmetry : problem.symmetries) {
    const Eigen::Map<const MatrixXd> transposed(symmetry.matrix.data(), n, n);
    const Eigen::Map<const VectorXd> shift(symmetry.shift.data(), n);
    const NodeValues field = (transposed.transpose() * q).colwise() + shift;
    const double terms =
        (transposed.transpose().cwiseAbs() * q.cwiseAbs()).maxCoeff() + shift.cwiseAbs().maxCoeff();
    if (field.cwiseAbs().maxCoeff() > least_move * terms) fields.push_back(field);
  }
  return fields;
}

/// Eigenvalues of at most `zero` are zero, those above `not_zero` are not.
struct Levels {
  double zero = 0, not_zero = 0;
};

/// The error of the path changes the form by as much as forces change, relative, and an eigenvalue by no
/// more. It changes those of families of extremals by far less: as the squares of fields that are known to be
/// null tell by how much they differ from zero.
Levels levels(const NodeForm& form, const std::vector<NodeValues>& null_fields, double error) {
  double zero = roundoff;
  for (const NodeValues& field : null_fields)
    zero = std::max(zero, most_squares * form.square(field).value_or(0));
  const double change = std::min(change_of_forces * error * form.stiffness(), largest_change);
  return {zero, std::max({zero, change, NodeForm::roundoff})};
}

/// Eigenvalues below −level, and those within it.
std::optional<OrbitIndex> count(const NodeForm& form, double level) {
  const std::optional<int> negative = form.below(-level), not_positive = form.below(level);
  if (!negative || !not_positive) return std::nullopt;
  return OrbitIndex{*negative, *not_positive - *negative};
}

bool moves(const Trajectory& path) {
  return std::ranges::any_of(path.slopes, [](double v) { return v != 0; });
}

}  // namespace

/// Null directions that are all known need no second look. More are null if others are not near them.
std::optional<OrbitIndex> orbit_index(const Problem& problem, SecondVariation& variation,
                                      const Trajectory& path, double error) {
  const NodeForm form(variation, ends_of(problem));
  const Levels level = levels(form, known_null_fields(problem, variation, path), error);
  const std::optional<OrbitIndex> found = count(form, level.not_zero);
  const bool shifts = problem.shifts_in_time() && moves(path);
  const int known = shifts + moving_symmetries(problem.symmetries, path, shifts);
  if (!found || found->null == known) return found;
  if (found->null < known) return std::nullopt;
  const auto as_many = [&](double at) {
    const std::optional<OrbitIndex> counted = count(form, at);
    return counted && counted->null == found->null;
  };
  return as_many(std::max(level.zero, NodeForm::roundoff)) && as_many(apart * level.not_zero) ? found
                                                                                              : std::nullopt;
}

void tell_index(const std::optional<OrbitIndex>& found, Solution& solution) {
  solution.morse_index = solution.nullity = std::nullopt;
  if (found) {
    solution.morse_index = found->negative;
    solution.nullity = found->null;
  } else {
    solution.message +=
        "; no index is told: an eigenvalue of its second variation is zero or not, within the error of the "
        "path";
  }
  solution.minimizing = solution.morse_index == 0;
}

void read_index(const Problem& problem, SecondVariation& variation, double error, Solution& solution) {
  tell_index(orbit_index(problem, variation, solution.trajectory, error), solution);
}

/// The ends are those of the orbit, one of them turned.
std::optional<int> doubling_index(const Problem& problem, SecondVariation& variation) {
  if (problem.paired || problem.phase || variation.count() == 0) return std::nullopt;
  MatrixXd ends = ends_of(problem);
  ends.bottomRows(problem.coordinates()) *= -1;
  return NodeForm(variation, ends).below(0);
}

}  // namespace extremal
