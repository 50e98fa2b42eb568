#include "solve/branch/bifurcation_equations.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "linear/dense.hpp"
#include "solve/branch/limits.hpp"

namespace extremal {

using namespace limits::bifurcation_equations;

namespace {

/// All products of so many components, those of one entry or more: b_i b_j … with i ≤ j ≤ …
Eigen::VectorXd monomials(const Eigen::VectorXd& b, int degree) {
  std::vector<double> products;
  const auto extend = [&](const auto& self, Eigen::Index first, int left, double product) -> void {
    if (left == 0) return products.push_back(product);
    for (Eigen::Index i = first; i < b.size(); ++i) self(self, i, left - 1, product * b[i]);
  };
  extend(extend, 0, degree, 1);
  return Eigen::Map<Eigen::VectorXd>(products.data(), std::ssize(products));
}

/// Unit vectors along the points of the integer lattice with entries up to `most`, of b and −b one.
std::vector<Eigen::VectorXd> lattice_directions(int count, int most) {
  std::vector<Eigen::VectorXd> found;
  Eigen::VectorXi point = Eigen::VectorXi::Constant(count, -most);
  for (;;) {
    const auto first = std::ranges::find_if(point, [](int x) { return x != 0; });
    const int common =
        std::accumulate(point.begin(), point.end(), 0, [](int a, int b) { return std::gcd(a, b); });
    if (first != point.end() && *first > 0 && common == 1) found.push_back(point.cast<double>().normalized());
    const auto next = std::ranges::find_if(point, [&](int x) { return x < most; });
    if (next == point.end()) return found;
    std::fill(point.begin(), next, -most);
    ++*next;
  }
}

/// The coefficients of monomials, of which each row of `values` is the sum at one direction.
Eigen::MatrixXd fitted(const std::vector<Eigen::VectorXd>& directions, int degree,
                       const Eigen::MatrixXd& values) {
  Eigen::MatrixXd basis(std::ssize(directions), monomials(directions.front(), degree).size());
  for (Eigen::Index k = 0; k < basis.rows(); ++k) basis.row(k) = monomials(directions[k], degree).transpose();
  return least_norm(basis, values).transpose();
}

}  // namespace

/// Even and odd parts of f along b give B and C; A is the mixed difference in a and b, a of the order that
/// it has on branches of even symmetry.
std::optional<BifurcationEquations> BifurcationEquations::measure(int count, double size,
                                                                  const Forces& forces) {
  bool known = true;
  const auto at = [&](double along, const Eigen::VectorXd& across) -> Eigen::VectorXd {
    std::optional<Eigen::VectorXd> found;
    if (known) found = forces({along * size * size, across * size});
    known = found.has_value() && found->allFinite();
    return known ? *found : Eigen::VectorXd(Eigen::VectorXd::Zero(count));
  };
  const std::vector<Eigen::VectorXd> directions = lattice_directions(count, 1);
  Eigen::MatrixXd even(std::ssize(directions), count), odd = even;
  for (Eigen::Index k = 0; k < even.rows(); ++k) {
    const Eigen::VectorXd onward = at(0, directions[k]), back = at(0, -directions[k]);
    even.row(k) = (onward + back).transpose() / (2 * size * size);
    odd.row(k) = (onward - back).transpose() / (2 * size * size * size);
  }
  BifurcationEquations found;
  found.size_ = size;
  found.quadratic_ = fitted(directions, 2, even);
  found.cubic_ = fitted(directions, 3, odd);
  found.linear_.resize(count, count);
  for (int j = 0; j < count; ++j) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(count, j);
    found.linear_.col(j) =
        (at(1, unit) + at(-1, -unit) - at(1, -unit) - at(-1, unit)) / (4 * size * size * size);
  }
  return known ? std::optional(std::move(found)) : std::nullopt;
}

double BifurcationEquations::potential(const Departure& at) const {
  const Eigen::VectorXd forces = at.along / 2 * (linear_ * at.across) +
                                 quadratic_ * monomials(at.across, 2) / 3 +
                                 cubic_ * monomials(at.across, 3) / 4;
  return at.across.dot(forces);
}

/// (B(b, b) + C(b, b, b)) / size², b of that size.
Eigen::VectorXd BifurcationEquations::curved(const Eigen::VectorXd& direction) const {
  return quadratic_ * monomials(direction, 2) + size_ * (cubic_ * monomials(direction, 3));
}

/// The a, by the size, that leaves least of the forces.
double BifurcationEquations::along(const Eigen::VectorXd& direction) const {
  const Eigen::VectorXd linear = linear_ * direction;
  return -linear.dot(curved(direction)) / linear.squaredNorm();
}

/// What it leaves.
Eigen::VectorXd BifurcationEquations::missed(const Eigen::VectorXd& direction) const {
  const Eigen::VectorXd unit = direction.normalized();
  return curved(unit) + along(unit) * (linear_ * unit);
}

/// Levenberg-Marquardt on the sphere.
Eigen::VectorXd BifurcationEquations::descend(Eigen::VectorXd direction, double goal) const {
  const Eigen::Index count = direction.size();
  Eigen::VectorXd left = missed(direction);
  double damping = first_damping;
  for (int k = 0; k < most_descents && left.norm() > goal; ++k) {
    Eigen::MatrixXd slopes(count, count);
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::VectorXd by = Eigen::VectorXd::Unit(count, j) * difference;
      slopes.col(j) = (missed(direction + by) - missed(direction - by)) / (2 * difference);
    }
    Eigen::MatrixXd normal = slopes.transpose() * slopes;
    normal.diagonal().array() += damping * normal.trace();
    const Eigen::VectorXd next = (direction - solved(normal, slopes.transpose() * left)).normalized();
    const Eigen::VectorXd after = missed(next);
    const bool better = after.norm() < left.norm();
    damping = std::max(damping * (better ? 0.1 : 10), least_damping);
    if (better) {
      direction = next;
      left = after;
    }
  }
  return direction;
}

std::vector<Departure> BifurcationEquations::solutions() const {
  const int count = static_cast<int>(linear_.rows());
  const std::vector<Eigen::VectorXd> starts = lattice_directions(count, lattice);
  double largest = 0;
  for (const Eigen::VectorXd& start : starts) largest = std::max(largest, curved(start).norm());
  std::vector<Departure> found;
  for (const Eigen::VectorXd& start : starts) {
    const Eigen::VectorXd onward = descend(start, enough * largest);
    for (const Eigen::VectorXd& direction : {onward, descend(-onward, enough * largest)}) {
      const bool solved = missed(direction).norm() <= size_ * size_ * largest;
      const bool other = std::ranges::none_of(found, [&](const Departure& known) {
        return (known.across / size_ - direction).norm() <= same_direction;
      });
      if (solved && other) found.push_back({along(direction) * size_, direction * size_});
    }
  }
  return found;
}

}  // namespace extremal
