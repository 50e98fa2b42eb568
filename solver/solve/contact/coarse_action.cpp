#include "solve/contact/coarse_action.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Square = Eigen::Map<const RowMajor>;

/// The second derivatives of h L by the ends of an element: (a, a), (b, a) and (b, b).
struct ElementHessian {
  MatrixXd aa, ba, bb;
};

ElementHessian element_hessian(const PointValues& l, double h, int n, double kinetic_only) {
  const Square qq(l.qq.data(), n, n), vq(l.vq.data(), n, n), vv(l.vv.data(), n, n);
  const MatrixXd mass = (1 + kinetic_only) / h * vv, mixed = 0.5 * vq, rest = 0.25 * h * qq;
  return {rest - mixed - mixed.transpose() + mass, rest - mixed.transpose() + mixed - mass,
          rest + mixed + mixed.transpose() + mass};
}

}  // namespace

CoarseAction::CoarseAction(const Problem& problem, int elements)
    : problem_(problem),
      inequalities_(*problem.inequalities),
      n_(problem.coordinates()),
      elements_(elements),
      h_(problem.duration.value / elements) {
  for (int k = 0; k <= elements_; ++k)
    for (int c = 0; c < inequalities_.count() && !fixed(k); ++c) places_.push_back({k, c});
}

double CoarseAction::time(int node) const { return node == elements_ ? problem_.duration.value : node * h_; }

bool CoarseAction::fixed(int node) const {
  if (node != 0 && node != elements_) return false;
  const auto begin = problem_.ends.fixed.begin() + (node == 0 ? 0 : n_);
  return std::all_of(begin, begin + n_, [](char f) { return f; });
}

void CoarseAction::midpoint(std::span<const double> z, int k, Point& point) const {
  const double *a = z.data() + k * n_, *b = a + n_;
  point.q.resize(n_);
  point.v.resize(n_);
  for (int i = 0; i < n_; ++i) {
    point.q[i] = 0.5 * (a[i] + b[i]);
    point.v[i] = (b[i] - a[i]) / h_;
  }
}

PointValues CoarseAction::values(std::span<const double> z, int k, Order order) const {
  Point point;
  Scratch scratch;
  midpoint(z, k, point);
  return evaluate_at(*problem_.lagrangian, point.q, point.v, (k + 0.5) * h_, order, scratch);
}

MatrixXd CoarseAction::curvature(std::span<const double> z, int node,
                                 std::span<const double> multipliers) const {
  const int m = inequalities_.count(), all = n_ + 1 + m;
  std::vector<double> point(z.begin() + node * n_, z.begin() + (node + 1) * n_), rest(all);
  point.push_back(time(node));
  point.insert(point.end(), multipliers.begin(), multipliers.end());
  Scratch scratch;
  const PointValues form =
      evaluate_at(*inequalities_.all->parts().forms, point, rest, 0, Order::hessian, scratch);
  return Square(form.qq.data(), all, all).topLeftCorner(n_, n_);
}

bool CoarseAction::hessian(std::span<const double> z, double factor, std::span<const double> multipliers,
                           std::span<double> entries) const {
  std::size_t at = 0;
  const auto put_lower = [&](const MatrixXd& block) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) entries[at++] = block(i, j);
  };
  for (int k = 0; k < elements_; ++k) {
    const ElementHessian element = element_hessian(values(z, k, Order::hessian), h_, n_, 0);
    put_lower(factor * element.aa);
    put_lower(factor * element.bb);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) entries[at++] = factor * element.ba(i, j);
  }
  const std::size_t m = inequalities_.count();
  for (std::size_t place = 0; place < places_.size(); place += m)
    put_lower(curvature(z, places_[place].node, multipliers.subspan(place, m)));
  return std::ranges::all_of(entries, [](double x) { return std::isfinite(x); });
}

InequalityMinimum CoarseAction::minimum() const {
  InequalityMinimum minimum;
  const std::vector<Triplet>& relation = problem_.boundary.matrix;
  const int rows = static_cast<int>(places_.size());
  minimum.variables = (elements_ + 1) * n_;
  minimum.inequalities = rows;
  minimum.equations = problem_.boundary.rows;
  const auto variable = [this](int e) { return e < n_ ? e : elements_ * n_ + e - n_; };
  for (int i = 0; i < rows; ++i)
    for (int a = 0; a < n_; ++a) minimum.slopes.push_back({i, places_[i].node * n_ + a});
  for (const Triplet& b : relation) minimum.slopes.push_back({rows + b.row, variable(b.column)});
  const auto lower = [&](int node) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) minimum.curvature.push_back({node * n_ + i, node * n_ + j});
  };
  for (int k = 0; k < elements_; ++k) {
    lower(k);
    lower(k + 1);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) minimum.curvature.push_back({(k + 1) * n_ + i, k * n_ + j});
  }
  for (std::size_t place = 0; place < places_.size(); place += inequalities_.count())
    lower(places_[place].node);

  const std::vector<double>& momenta = problem_.boundary.momenta;
  minimum.value = [=, this, &momenta](std::span<const double> z, double& f) {
    f = 0;
    for (int k = 0; k < elements_; ++k) f += h_ * values(z, k, Order::value).value;
    for (std::size_t e = 0; e < momenta.size(); ++e)
      f += (e < std::size_t(n_) ? 1 : -1) * momenta[e] * z[variable(static_cast<int>(e))];
    return std::isfinite(f);
  };
  minimum.gradient = [=, this, &momenta](std::span<const double> z, std::span<double> f_z) {
    std::ranges::fill(f_z, 0.0);
    for (int k = 0; k < elements_; ++k) {
      const PointValues l = values(z, k, Order::gradient);
      for (int i = 0; i < n_; ++i) {
        f_z[k * n_ + i] += 0.5 * h_ * l.dq[i] - l.dv[i];
        f_z[(k + 1) * n_ + i] += 0.5 * h_ * l.dq[i] + l.dv[i];
      }
    }
    for (std::size_t e = 0; e < momenta.size(); ++e)
      f_z[variable(static_cast<int>(e))] += (e < std::size_t(n_) ? 1 : -1) * momenta[e];
    return std::ranges::all_of(f_z, [](double x) { return std::isfinite(x); });
  };
  const int m = inequalities_.count();
  const auto at = [this](std::span<const double> z, int node) {
    return inequalities_.all->at(z.subspan(node * n_, n_), time(node));
  };
  minimum.constraints = [=, this, &relation](std::span<const double> z, std::span<double> a) {
    for (int i = 0; i < rows; i += m) {
      const ConstraintValues found = at(z, places_[i].node);
      for (int c = 0; c < m; ++c) a[i + c] = found.g[c];
    }
    for (int r = 0; r < problem_.boundary.rows; ++r) a[rows + r] = -problem_.boundary.value[r];
    for (const Triplet& b : relation) a[rows + b.row] += b.value * z[variable(b.column)];
    return std::ranges::all_of(a, [](double x) { return std::isfinite(x); });
  };
  minimum.constraint_slopes = [=, this, &relation](std::span<const double> z, std::span<double> a_z) {
    std::size_t next = 0;
    for (int i = 0; i < rows; i += m) {
      const ConstraintValues found = at(z, places_[i].node);
      for (int c = 0; c < m; ++c)
        for (int a = 0; a < n_; ++a) a_z[next++] = found.slopes(c, a);
    }
    for (const Triplet& b : relation) a_z[next++] = b.value;
    return std::ranges::all_of(a_z, [](double x) { return std::isfinite(x); });
  };
  minimum.hessian = [this](std::span<const double> z, double factor, std::span<const double> multipliers,
                           std::span<double> entries) { return hessian(z, factor, multipliers, entries); };
  return minimum;
}

double CoarseAction::force(std::span<const double> z) const {
  double largest = 0;
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    for (int a = 0; a < n_; ++a)
      largest = std::max({largest, std::abs(l.dq[a]), std::abs(l.dv[a]) / problem_.duration.value});
  }
  return largest;
}

bool CoarseAction::positive(std::span<const double> z, const std::vector<std::vector<int>>& held,
                            const std::vector<std::vector<double>>& forces) const {
  // Displacements of each node, with columns that keep what is held; those of ends that are fixed: none.
  std::vector<MatrixXd> free(elements_ + 1);
  std::vector<Index> first(elements_ + 2, 0);
  for (int k = 0; k <= elements_; ++k) {
    MatrixXd basis = MatrixXd::Identity(n_, n_);
    if (k == 0 || k == elements_) {
      Index columns = 0;
      for (int a = 0; a < n_; ++a)
        if (!problem_.ends.fixed[(k == 0 ? 0 : n_) + a])
          basis.col(columns++) = MatrixXd::Identity(n_, n_).col(a);
      basis.conservativeResize(Eigen::NoChange, columns);
    } else if (!held[k].empty()) {
      const ConstraintValues found = inequalities_.all->at(z.subspan(k * n_, n_), time(k));
      MatrixXd normals(n_, held[k].size());
      for (std::size_t i = 0; i < held[k].size(); ++i) normals.col(i) = found.slopes.row(held[k][i]);
      basis = held[k].size() < std::size_t(n_) ? complement(normals) : MatrixXd(n_, 0);
    }
    free[k] = std::move(basis);
    first[k + 1] = first[k] + free[k].cols();
  }
  if (first.back() == 0) return true;
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, const MatrixXd& block) {
    const MatrixXd reduced = free[row].transpose() * block * free[column];
    for (Index i = 0; i < reduced.rows(); ++i)
      for (Index j = 0; j < (row == column ? i + 1 : reduced.cols()); ++j)
        entries.emplace_back(first[row] + i, first[column] + j, reduced(i, j));
  };
  for (int k = 0; k < elements_; ++k) {
    const ElementHessian element =
        element_hessian(values(z, k, Order::hessian), h_, n_, limits::contact::shift);
    add(k, k, element.aa);
    add(k + 1, k + 1, element.bb);
    add(k + 1, k, element.ba);
  }
  for (int k = 1; k < elements_; ++k)
    if (!held[k].empty()) add(k, k, -h_ * curvature(z, k, forces[k]));
  Eigen::SparseMatrix<double> matrix(first.back(), first.back());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors(
      matrix);
  return factors.info() == Eigen::Success && (factors.vectorD().array() > 0).all();
}

}  // namespace extremal
