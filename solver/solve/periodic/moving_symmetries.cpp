#include "solve/periodic/moving_symmetries.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"

namespace extremal {
namespace {

/// Columns: the generators about `centre`, in units of `size`, G by columns and then c, orthonormal.
Eigen::MatrixXd generators(std::span<const Generator> symmetries, const Eigen::VectorXd& centre,
                           double size) {
  const auto n = centre.size();
  Eigen::MatrixXd columns(n * n + n, std::ssize(symmetries));
  for (Eigen::Index s = 0; s < columns.cols(); ++s) {
    const Generator& symmetry = symmetries[s];
    const Eigen::Map<const Eigen::MatrixXd> transposed(symmetry.matrix.data(), n, n);
    const Eigen::MatrixXd g = transposed.transpose();
    columns.col(s) << size * g.reshaped(),
        g * centre + Eigen::Map<const Eigen::VectorXd>(symmetry.shift.data(), n);
  }
  return orthonormal(columns);
}

}  // namespace

/// One that moves nothing, as a rotation of a centre of mass that rests at the origin, does not count.
int moving_symmetries(std::span<const Generator> symmetries, const Trajectory& path, bool but_along_itself) {
  constexpr double dependent = 1e-8, at_rest = 1e-9;  // the square of a sine; of the distance from the origin
  const Eigen::Index n = path.coordinates, points = std::ssize(path.times), count = std::ssize(symmetries);
  if (count == 0) return 0;
  Eigen::MatrixXd q(n, points), fields(points * n, count + 1);
  for (Eigen::Index p = 0; p < points; ++p)
    path.at(path.times[p], {&q(0, p), &q(0, p) + n}, {&fields(p * n, count), &fields(p * n, count) + n});
  const Eigen::VectorXd centre = q.rowwise().mean();
  q.colwise() -= centre;
  const double extent = std::max(q.cwiseAbs().maxCoeff(), at_rest * centre.norm()),
               size = extent > 0 ? extent : 1;
  const Eigen::MatrixXd columns = generators(symmetries, centre, size);
  for (Eigen::Index s = 0; s < count; ++s)
    fields.col(s).reshaped(n, points) =
        ((columns.col(s).head(n * n).reshaped(n, n) * q / size).colwise() + columns.col(s).tail(n)) /
        std::sqrt(points);
  fields.col(count).normalize();
  if (!but_along_itself) fields.col(count).setZero();
  const bool shifts = fields.col(count).norm() > 0;
  const Eigen::VectorXd squares = symmetric_eigenvalues(fields.transpose() * fields);
  return static_cast<int>((squares.array() > dependent).count()) - shifts;
}

}  // namespace extremal
