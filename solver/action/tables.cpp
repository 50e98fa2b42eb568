#include "action/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "action/by_degree.hpp"
#include "system/open_ends.hpp"

namespace extremal {

namespace {

/// Basis (φ_1 … φ_{s−1}, 1 − τ, τ) or its derivative, points × (s + 1), from the Lagrange basis at all nodes.
std::vector<double> element_basis(const std::vector<double>& lagrange, const std::vector<double>& points,
                                  int degree, bool derivative) {
  const int count = degree + 1;
  std::vector<double> basis(points.size() * count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double* row = basis.data() + i * count;
    for (int j = 1; j < degree; ++j) row[j - 1] = lagrange[i * count + j];
    row[degree - 1] = derivative ? -1 : 1 - points[i];
    row[degree] = derivative ? 1 : points[i];
  }
  return basis;
}

/// Σ b_i f_J(c_i) g_K(c_i) for the pairs (J, K): all, or K <= J.
PointTable products(const std::vector<double>& f, const std::vector<double>& g,
                    const std::vector<double>& weight, int count, bool all) {
  PointTable table;
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < (all ? count : j + 1); ++k) {
      for (std::size_t i = 0; i < weight.size(); ++i)
        table.add(static_cast<int>(i), weight[i] * f[i * count + j] * g[i * count + k]);
      table.close();
    }
  return table;
}

PointTable singles(const std::vector<double>& f, const std::vector<double>& weight, int count) {
  PointTable table;
  for (int j = 0; j < count; ++j) {
    for (std::size_t i = 0; i < weight.size(); ++i)
      table.add(static_cast<int>(i), weight[i] * f[i * count + j]);
    table.close();
  }
  return table;
}

/// Σ b_i f_J g_K, full; `exact_zero` where ∫ φ_j' = 0 makes the entry vanish.
std::vector<double> dense(const std::vector<double>& f, const std::vector<double>& g,
                          const std::vector<double>& weight, int count) {
  std::vector<double> matrix(static_cast<std::size_t>(count) * count);
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < count; ++k) {
      long double sum = 0;
      for (std::size_t i = 0; i < weight.size(); ++i)
        sum += static_cast<long double>(weight[i]) * f[i * count + j] * g[i * count + k];
      matrix[j * count + k] = static_cast<double>(sum);
    }
  return matrix;
}

/// Stiffness by a rule that is exact for it, so that it is that of every scheme but those that
/// integrate the kinetic energy themselves (all do, to roundoff): inner and end functions decouple.
std::vector<double> stiffness_of(int degree) {
  const Rule rule = gauss_rule(degree);
  const Basis basis = lobatto_basis(degree, rule.nodes);
  const int count = degree + 1;
  const std::vector<double> slope = element_basis(basis.derivative, rule.nodes, degree, true);
  std::vector<double> k = dense(slope, slope, rule.weights, count);
  for (int j = 0; j < degree - 1; ++j)
    for (int e : {degree - 1, degree}) k[j * count + e] = k[e * count + j] = 0;
  k[(degree - 1) * count + degree - 1] = k[degree * count + degree] = 1;
  k[(degree - 1) * count + degree] = k[degree * count + degree - 1] = -1;
  return k;
}

SchemeTables tables_of_lobatto(int degree) { return SchemeTables(lobatto(degree)); }
SchemeTables tables_of_gauss(int degree) { return SchemeTables(gauss(degree)); }

}  // namespace

void PointTable::add(int at_point, double value) {
  if (value == 0) return;
  point.push_back(at_point);
  coefficient.push_back(value);
}

SchemeTables::SchemeTables(const Scheme& given, int exact_points) : scheme(given), degree(given.degree) {
  const Rule rule = rule_of(scheme, exact_points);
  functions = degree + 1;
  points = static_cast<int>(rule.nodes.size());
  node = rule.nodes;
  weight = rule.weights;
  lobatto = lobatto_barycentric(degree).nodes;
  nodal = node == lobatto;
  end_derivative = lobatto_basis(degree, std::array{0.0, 1.0}).derivative;
  const Basis basis = lobatto_basis(degree, node);
  value = element_basis(basis.value, node, degree, false);
  slope = element_basis(basis.derivative, node, degree, true);
  stiffness = stiffness_of(degree);
  gyration = dense(slope, value, weight, functions);
  value_sum = singles(value, weight, functions);
  slope_sum = singles(slope, weight, functions);
  value_value = products(value, value, weight, functions, false);
  slope_value = products(slope, value, weight, functions, true);
  slope_slope = products(slope, slope, weight, functions, false);

  // Nodal values of the basis are (0, …, 1, …, 0) for φ_j, and the chord's for 1 − τ and τ.
  const std::vector<double> nodal_legendre = legendre_matrix(degree);
  legendre.assign(static_cast<std::size_t>(functions) * functions, 0);
  for (int k = 0; k < functions; ++k) {
    for (int j = 1; j < degree; ++j) legendre[k * functions + j - 1] = nodal_legendre[k * functions + j];
    if (k < 2) {
      legendre[k * functions + degree - 1] = k == 0 ? 0.5 : -0.5;
      legendre[k * functions + degree] = 0.5;
    }
  }
}

const SchemeTables& SchemeTables::of_lobatto(int degree) {
  static ByDegree<SchemeTables> all(tables_of_lobatto);
  return all.at(degree);
}

const SchemeTables& SchemeTables::of_gauss(int degree) {
  static ByDegree<SchemeTables> all(tables_of_gauss);
  return all.at(degree);
}

bool uses_gauss(const Lagrangian& lagrangian) {
  return lagrangian.kinks() != nullptr || lagrangian.structure().first_order ||
         dynamic_cast<const OpenEnds*>(&lagrangian) != nullptr;
}

const SchemeTables& SchemeTables::of_order(int degree, const Lagrangian& lagrangian) {
  return uses_gauss(lagrangian) ? of_gauss(degree) : of_lobatto(degree);
}

void ElementTables::bind(const SchemeTables& scheme, const Lagrangian& lagrangian) {
  const Structure& s = lagrangian.structure();
  scheme_ = &scheme;
  kinks_ = nullptr;
  mass_.clear();
  gyroscopic_.clear();
  hessian_.clear();
  for (const Triplet& e : s.mass) mass_.push_back({e.row, e.column, e.value});
  for (const Triplet& e : s.gyroscopic) gyroscopic_.push_back({e.row, e.column, e.value});
  for (const HessianEntry& e : s.hessian) hessian_.push_back({e.row, e.column, 0});
  linear_ = s.linear;
  shape_ = {.n = s.coordinates,
            .functions = scheme.functions,
            .points = scheme.points,
            .node = scheme.node.data(),
            .weight = scheme.weight.data(),
            .value = scheme.value.data(),
            .slope = scheme.slope.data(),
            .stiffness = scheme.stiffness.data(),
            .gyration = scheme.gyration.data(),
            .value_sum = scheme.value_sum.view(),
            .slope_sum = scheme.slope_sum.view(),
            .value_value = scheme.value_value.view(),
            .slope_value = scheme.slope_value.view(),
            .slope_slope = scheme.slope_slope.view(),
            .nodal = scheme.nodal,
            .mass_count = static_cast<int>(mass_.size()),
            .gyroscopic_count = static_cast<int>(gyroscopic_.size()),
            .linear_count = static_cast<int>(linear_.size()),
            .mass = mass_.data(),
            .gyroscopic = gyroscopic_.data(),
            .linear = linear_.data(),
            .velocity_free = s.velocity_free,
            .gradient_count = static_cast<int>(s.gradient.size()),
            .hessian_count = static_cast<int>(s.hessian.size()),
            .gradient = s.gradient.data(),
            .hessian = hessian_.data()};
  list_places();
}

/// In the order in which the kernel `hessian` makes its contributions.
void ElementTables::list_places() {
  const int n = shape_.n, count = shape_.functions;
  places_.clear();
  const auto add = [&](int row, int column, bool mirrored) {
    places_.push_back({std::max(row, column), std::min(row, column), mirrored && row == column});
  };
  for (const EntryView& e : mass_) {
    if (e.column > e.row) continue;
    for (int j = 0; j < count; ++j)
      for (int k = 0; k <= j; ++k) {
        if (shape_.stiffness[j * count + k] == 0) continue;
        add(j * n + e.row, k * n + e.column, false);
        if (e.row != e.column && j != k) add(j * n + e.column, k * n + e.row, false);
      }
  }
  for (const EntryView& e : gyroscopic_)
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < count; ++k) add(j * n + e.row, k * n + e.column, true);
  for (const EntryView& e : hessian_) {
    const bool mixed = e.row >= n && e.column < n;
    const PointSums& table = mixed           ? shape_.slope_value
                             : e.column >= n ? shape_.slope_slope
                                             : shape_.value_value;
    const int a = e.row >= n ? e.row - n : e.row, b = e.column >= n ? e.column - n : e.column;
    int pair = 0;
    for (int j = 0; j < count; ++j)
      for (int k = 0; k <= (mixed ? count - 1 : j); ++k, ++pair) {
        if (table.start[pair] == table.start[pair + 1]) continue;
        add(j * n + a, k * n + b, mixed);
        if (!mixed && a != b && j != k) add(j * n + b, k * n + a, false);
      }
  }
  entries_ = {};
  condensation_.reset();
}

const ElementTables::Condensation& ElementTables::condensation() const {
  if (condensation_) return *condensation_;
  condensation_ = Condensation{Fronts(shape_), {}};
  for (const Place& p : places_) {
    const int at = condensation_->fronts.place(p.row, p.column);
    condensation_->slots.push_back(p.twice ? ~at : at);
  }
  return *condensation_;
}

const ElementTables::Entries& ElementTables::entries() const {
  if (!entries_.slots.empty()) return entries_;
  std::vector<int> order(places_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int k) { return std::pair(places_[k].row, places_[k].column); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  entries_.slots.resize(places_.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Place& p = places_[order[k]];
    if (k == 0 || key(order[k]) != key(order[k - 1])) {
      entries_.row.push_back(p.row);
      entries_.column.push_back(p.column);
    }
    const int at = static_cast<int>(entries_.row.size()) - 1;
    entries_.slots[order[k]] = p.twice ? ~at : at;
  }
  return entries_;
}

}  // namespace extremal
