#include "action/recovery.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "action/by_degree.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Of Newton's method for velocities; the next step after one this much smaller than the first is roundoff.
constexpr int most_steps = 6;
constexpr double step_left = 1e-6;

/// B_{s−1}, B_s and B_{s+1} at the inner Lobatto nodes of some degree.
using Shapes = std::vector<std::array<double, 3>>;

/// B_k = (L_{k+1} − L_{k−1})/(2k + 1).
std::array<double, 3> integrals(int s, double xi) {
  double before = 1, now = xi;  // L_{k−1}, L_k
  std::array<double, 3> result{};
  for (int k = 1; k <= s + 1; ++k) {
    const double after = ((2 * k + 1) * xi * now - k * before) / (k + 1);
    if (k >= s - 1) result[k - s + 1] = (after - before) / (2 * k + 1);
    before = now;
    now = after;
  }
  return result;
}

Shapes shapes_at(int s, int degree) {
  Shapes shapes;
  const std::vector<double>& nodes = lobatto_barycentric(degree).nodes;
  for (int j = 1; j < degree; ++j) shapes.push_back(integrals(s, 2 * nodes[j] - 1));
  return shapes;
}

const Shapes& own_shapes(int degree) {
  static ByDegree<Shapes> shapes([](int s) { return shapes_at(s, s); });
  return shapes.at(degree);
}

const Shapes& raised_shapes(int degree) {
  static ByDegree<Shapes> shapes([](int s) { return shapes_at(s, s + Recovery::raised_by); });
  return shapes.at(degree);
}

}  // namespace

bool Recovery::suits(const SchemeTables& scheme) { return scheme.degree + raised_by <= max_degree; }

bool Recovery::measure(const Lagrangian& lagrangian, DiscreteAction& action, const Path& path) {
  action.evaluate_plain(path);
  if (!action.finite()) return false;
  const Structure& structure = lagrangian.structure();
  n_ = path.coordinates();
  for (AlignedDoubles* x : {&q_, &v_, &defects_}) x->resize(static_cast<std::size_t>(n_) * both_);
  t_.resize(both_);
  if (!structure.quadratic) rows_.resize(static_cast<std::size_t>(lagrangian.rows(Order::hessian)) * both_);
  coefficients_.resize(static_cast<std::size_t>(path.batches()) * n_ * 3 * lanes_);
  singular_ = false;
  mass_.setZero(n_, n_);
  for (const Triplet& m : structure.mass) mass_(m.row, m.column) += m.value;
  diagonal_ = structure.quadratic && mass_.isDiagonal(0);
  if (structure.quadratic && !diagonal_) factors_.compute(mass_);
  for (int b = 0; b < path.batches(); ++b) {
    find_slopes(action.tables().scheme(), path, b);
    find_defects(lagrangian, action.end_gradients(b));
    structure.quadratic ? solve_with_mass(defects_) : find_velocities(lagrangian, action.end_gradients(b));
    keep(structure, action.tables().scheme(), path, b);
  }
  return !singular_ &&
         std::all_of(coefficients_.begin(), coefficients_.end(), [](double x) { return std::isfinite(x); });
}

/// q, q' and t at the ends of the elements of a batch.
void Recovery::find_slopes(const SchemeTables& scheme, const Path& path, int b) {
  const int s = scheme.degree;
  const double* x = path.x(b);
  for (int a = 0; a < n_; ++a) {
    const double *start = x + ((s - 1) * n_ + a) * lanes_, *delta = start + n_ * lanes_;
    for (int e = 0; e < 2; ++e) {
      double *q = q_.data() + a * both_ + e * lanes_, *v = v_.data() + a * both_ + e * lanes_;
      for (int lane = 0; lane < lanes_; ++lane) {
        q[lane] = start[lane] + e * delta[lane];
        v[lane] = delta[lane];
      }
      for (int j = 1; j < s; ++j) {
        const double slope = scheme.end_derivative[e * (s + 1) + j], *inner = x + ((j - 1) * n_ + a) * lanes_;
        for (int lane = 0; lane < lanes_; ++lane) v[lane] += slope * inner[lane];
      }
      for (int lane = 0; lane < lanes_; ++lane) v[lane] /= path.h(b)[lane];
    }
  }
  for (int k = 0; k < both_; ++k) t_[k] = path.start(b)[k % lanes_] + (k / lanes_) * path.h(b)[k % lanes_];
}

/// The momenta of S_h, −∂S/∂q_a and ∂S/∂q_b, less ∂L/∂q' = M q' + C q + a + ∂R/∂q'.
void Recovery::find_defects(const Lagrangian& lagrangian, const double* gradient) {
  const Structure& s = lagrangian.structure();
  for (int a = 0; a < n_; ++a)
    for (int lane = 0; lane < lanes_; ++lane) {
      defects_[a * both_ + lane] = -gradient[a * lanes_ + lane];
      defects_[a * both_ + lanes_ + lane] = gradient[(n_ + a) * lanes_ + lane];
    }
  const auto take = [&](int to, double factor, const double* from) {
    for (int k = 0; k < both_; ++k) defects_[to * both_ + k] -= factor * from[k];
  };
  for (const Triplet& m : s.mass) take(m.row, m.value, v_.data() + m.column * both_);
  for (const Triplet& c : s.gyroscopic) take(c.row, c.value, q_.data() + c.column * both_);
  for (std::size_t a = 0; a < s.linear.size(); ++a)
    for (int k = 0; k < both_; ++k) defects_[a * both_ + k] -= s.linear[a];
  if (s.quadratic) return;
  lagrangian.evaluate({both_, both_, q_.data(), v_.data(), t_.data()}, Order::hessian, rows_.data(),
                      scratch_);
  for (std::size_t g = 0; g < s.gradient.size(); ++g)
    if (s.gradient[g] >= n_) take(s.gradient[g] - n_, 1, rows_.data() + (1 + g) * both_);
}

/// Of a constant mass.
void Recovery::solve_with_mass(AlignedDoubles& x) {
  if (diagonal_) {
    for (int k = 0; k < n_ * both_; ++k) x[k] /= mass_(k / both_, k / both_);
    return;
  }
  for (int k = 0; k < both_; ++k) solve_column(k, x);
}

void Recovery::solve_column(int k, AlignedDoubles& x) {
  column_.resize(n_);
  for (int a = 0; a < n_; ++a) column_[a] = x[a * both_ + k];
  column_ = factors_.solve(column_);
  for (int a = 0; a < n_; ++a) x[a * both_ + k] = column_[a];
}

/// Newton's method for the velocities that momenta have, where ∂L/∂q' is not linear in them; `defects_`
/// becomes by how much they exceed the slopes. One step leaves the square of the defect, which is all of the
/// energy's digits near a bound of the velocities.
void Recovery::find_velocities(const Lagrangian& lagrangian, const double* gradient) {
  slopes_ = v_;
  double first = 0;
  for (int k = 0; k < most_steps; ++k) {
    divide(lagrangian);
    double largest = 0;
    for (std::size_t i = 0; i < v_.size(); ++i) {
      v_[i] += defects_[i];
      largest = std::max(largest, std::abs(defects_[i]));
    }
    if (k == 0) first = largest;
    if (!(largest > step_left * first) || !std::isfinite(largest)) break;
    if (k + 1 < most_steps) find_defects(lagrangian, gradient);
  }
  for (std::size_t i = 0; i < v_.size(); ++i) defects_[i] = v_[i] - slopes_[i];
}

/// Defects of momenta to those of velocities, where the mass is another at each node.
void Recovery::divide(const Lagrangian& lagrangian) {
  const Structure& s = lagrangian.structure();
  for (int k = 0; k < both_; ++k) {
    mass_.setZero(n_, n_);
    for (std::size_t e = 0; e < s.hessian.size(); ++e) {
      const int row = s.hessian[e].row - n_, column = s.hessian[e].column - n_;
      if (row < 0 || column < 0) continue;
      mass_(row, column) = mass_(column, row) = rows_[(1 + s.gradient.size() + e) * both_ + k];
    }
    factors_.compute(mass_);
    // Velocities there have no momentum, and what is left of it is roundoff or nothing.
    singular_ = singular_ || (factors_.matrixLU().diagonal().array() == 0).any();
    solve_column(k, defects_);
  }
}

void Recovery::keep(const Structure& structure, const SchemeTables& scheme, const Path& path, int b) {
  const int s = path.degree();
  const double sign = s % 2 == 0 ? 1 : -1;
  const double* const h = path.h(b);
  for (int a = 0; a < n_; ++a) {
    const double *first = defects_.data() + a * both_, *last = first + lanes_;
    double* to = coefficients(b, a);
    for (int lane = 0; lane < lanes_; ++lane) {
      to[lane] = 0.25 * h[lane] * (last[lane] + sign * first[lane]);
      to[lanes_ + lane] = 0.25 * h[lane] * (last[lane] - sign * first[lane]);
    }
  }
  turned_.assign(static_cast<std::size_t>(n_) * both_, 0);
  for (const Triplet& c : structure.gyroscopic)
    for (int lane = 0; lane < lanes_; ++lane) {
      turned_[c.column * both_ + lane] += c.value * coefficients(b, c.row)[lane];
      turned_[c.row * both_ + lane] -= c.value * coefficients(b, c.column)[lane];
    }
  if (!structure.gyroscopic.empty()) solve_with_mass(turned_);
  // With degree 1 there is no d_0 to be missed, and other rules do not misplace d_{s+1}.
  const double misplaced = scheme.nodal && s > 1 ? (s + 1.0) / s : 0;
  for (int a = 0; a < n_; ++a) {
    double *sum = coefficients(b, a) + lanes_, *missed = sum + lanes_;
    for (int lane = 0; lane < lanes_; ++lane) {
      const double turned = s > 1 ? 0.5 * h[lane] * turned_[a * both_ + lane] / (2 * s + 1) : 0;
      const double further = (sum[lane] + turned) / (1 + misplaced);
      missed[lane] = sum[lane] - further;
      sum[lane] = further;
    }
  }
}

void Recovery::raise(const Path& path, const ElementTables& raised, std::span<const double> matrix,
                     Path& to) const {
  const Shapes& shapes = raised_shapes(path.degree());
  to.interpolate_from(path, raised, matrix);
  for (int b = 0; b < path.batches(); ++b)
    for (int a = 0; a < n_; ++a) {
      const double *d = coefficients(b, a), *further = d + lanes_, *missed = further + lanes_;
      for (std::size_t j = 0; j < shapes.size(); ++j) {
        double* x = to.x(b) + (j * n_ + a) * lanes_;
        const auto [before, at, after] = shapes[j];
        for (int lane = 0; lane < lanes_; ++lane)
          x[lane] += at * d[lane] + after * further[lane] + before * missed[lane];
      }
    }
}

void Recovery::misplaced(const Path& path, AlignedDoubles& to) const {
  const Shapes& shapes = own_shapes(path.degree());
  const std::size_t unknowns = static_cast<std::size_t>(path.degree() + 1) * n_ * lanes_;
  to.assign(path.batches() * unknowns, 0);
  for (int b = 0; b < path.batches(); ++b)
    for (int a = 0; a < n_; ++a) {
      const double* missed = coefficients(b, a) + 2 * lanes_;
      for (std::size_t j = 0; j < shapes.size(); ++j)
        for (int lane = 0; lane < lanes_; ++lane)
          to[b * unknowns + (j * n_ + a) * lanes_ + lane] = shapes[j][0] * missed[lane];
    }
}

}  // namespace extremal
