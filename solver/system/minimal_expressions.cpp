#include "system/minimal_expressions.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "system/in_all_coordinates.hpp"

namespace extremal {

namespace {

using expression_matrix::add_product;
using expression_matrix::Factors;
using expression_matrix::Matrix;
using expression_matrix::negative;
using expression_matrix::Row;

/// A constraint, at most quadratic in one coordinate of w, that gives this one after others before it.
struct Quadratic {
  int constraint, dependent;  ///< numbers among g and w
  Scaled second;              ///< ∂²g/∂w², free of w; zero: g is linear in w
  bool rising;                ///< ∂g/∂w > 0 in the chart
};

/// Constraints that give w one after another, as far as they go.
class Sequence {
 public:
  Sequence(InAllCoordinates& system, const Chart& chart) : s_(system), chart_(chart), known_(system.m) {}

  std::vector<Quadratic> run() {
    std::vector<Quadratic> found;
    std::vector<char> used(s_.m);
    for (bool more = true; more;) {
      more = false;
      for (int k = 0; k < s_.m; ++k) {
        if (used[k]) continue;
        const int l = the_unknown(s_.g[k]);
        if (l < 0) continue;
        const Scaled second = s_.slopes(s_.g_y[k][s_.d + l], s_.d + l, 1)[0];
        if (!second.zero() && std::ranges::binary_search(inputs_of(s_.graph, second.node),
                                                         static_cast<std::uint32_t>(s_.d + l)))
          continue;
        found.push_back({k, l, second, at_point(s_.g_y[k][s_.d + l]) > 0});
        used[k] = known_[l] = 1;
        more = true;
      }
    }
    return found;
  }

 private:
  /// The one coordinate of w that g reads and that is not known; -1 where it is not one.
  int the_unknown(Scaled g) const {
    int found = -1;
    for (const std::uint32_t input : inputs_of(s_.graph, g.node)) {
      const int l = static_cast<int>(input) - s_.d;
      if (l < 0 || l >= s_.m || known_[l]) continue;
      if (found >= 0) return -1;
      found = l;
    }
    return found;
  }

  double at_point(Scaled f) const {
    std::vector<double> inputs = chart_.point;
    inputs.resize(2 * s_.n, 0.0);
    inputs.push_back(chart_.time);
    return f.factor * evaluate<double>(s_.graph, f.node, inputs);
  }

  InAllCoordinates& s_;
  const Chart& chart_;
  std::vector<char> known_;
};

/// The same as functions of u, w, u', t.
class Reduced {
 public:
  Reduced(InAllCoordinates& system, const Chart& chart)
      : s_(system), chart_(chart), n_(s_.n), d_(s_.d), m_(s_.m), algebra_(result_.kernel.graph) {
    for (int b = 0; b < n_ + d_; ++b) inputs_.push_back(algebra_.input(b));
    inputs_.resize(2 * n_ + 1);  // w' follows
    inputs_[2 * n_] = algebra_.input(n_ + d_);
    Matrix a(m_);
    for (int k = 0; k < m_; ++k)
      for (int l = 0; l < m_; ++l) a[k].push_back(here(s_.g_y[k][d_ + l]));
    factors_.emplace(algebra_, std::move(a));
    for (int k = 0; k < m_; ++k)
      result_.pivots.push_back({chart.signs[k] * factors_->pivot(k).factor, factors_->pivot(k).node});
  }

  MinimalExpressions run() {
    result_.autonomous = !s_.timed();
    find_start();
    result_.steps = factors_->solve(here(s_.g));
    find_rates();
    find_multipliers(false);
    result_.value = here(s_.lagrangian);
    for (int j = 0; j < 2 * d_; ++j)
      if (const Scaled f = here(s_.first[state(j)]); !f.zero())
        result_.gradient.push_back({static_cast<std::uint32_t>(j), f});
    z_ = directions();
    find_hessian();
    if (!s_.force.empty()) find_copies();
    absorb_factors();
    return std::move(result_);
  }

 private:
  /// Index in (y, y') of the index j in (u, u').
  int state(int j) const { return j < d_ ? j : n_ + j - d_; }

  Scaled here(Scaled f) {
    if (f.zero()) return {};
    const Scaled found = algebra_.import(s_.graph, f.node, inputs_);
    return {f.factor * found.factor, found.node};
  }
  Row here(const Row& row) {
    Row result;
    for (const Scaled& f : row) result.push_back(here(f));
    return result;
  }
  /// With a w² + b w + c the value of g, 2 a w + b = ±√(b² − 4 a c) at the solution.
  void find_start() {
    const std::vector<Scaled> inputs = inputs_;
    for (int l = 0; l < m_; ++l)
      result_.start.push_back(chart_.start.empty() ? algebra_.constant(chart_.point[d_ + l]) : fitted(l));
    for (const Quadratic& q : Sequence(s_, chart_).run()) {
      inputs_[d_ + q.dependent] = {};
      const Scaled c = here(s_.g[q.constraint]), b = here(s_.g_y[q.constraint][d_ + q.dependent]);
      Scaled& w = result_.start[q.dependent];
      if (q.second.zero()) {
        w = algebra_.multiply(-c, algebra_.reciprocal(b));
      } else {
        const Scaled a = here(q.second);  // twice the coefficient
        const Scaled discriminant =
            algebra_.subtract(algebra_.multiply(b, b), algebra_.multiply({2 * a.factor, a.node}, c));
        const Scaled root = algebra_.unary(Op::sqrt, discriminant);
        w = algebra_.multiply(algebra_.subtract(q.rising ? root : -root, b), algebra_.reciprocal(a));
      }
      inputs_[d_ + q.dependent] = w;
    }
    inputs_ = inputs;
  }

  /// A row of Chart::start.
  Scaled fitted(int l) {
    Row features{algebra_.constant(1)};
    for (int j = 0; j < d_; ++j) features.push_back(algebra_.input(j));
    for (const Polar& p : chart_.polar) {
      if (p.angle >= d_) continue;
      const Scaled angle = algebra_.multiply(algebra_.constant(1 / p.unit), algebra_.input(p.angle));
      features.push_back(algebra_.unary(Op::cos, angle));
      features.push_back(algebra_.unary(Op::sin, angle));
    }
    Scaled sum;
    for (std::size_t i = 0; i < features.size(); ++i)
      if (const double factor = chart_.start[l * features.size() + i]; factor != 0)
        add_product(algebra_, sum, algebra_.constant(factor), features[i]);
    return sum;
  }

  /// w' and ∂w/∂u.
  void find_rates() {
    for (int j = 0; j < d_; ++j) {
      Row column;
      for (int k = 0; k < m_; ++k) column.push_back(here(s_.g_y[k][j]));
      by_u_.push_back(negative(factors_->solve(std::move(column))));
    }
    Row rates;
    for (int k = 0; k < m_; ++k) {
      Scaled sum = here(s_.g_t[k]);
      for (int j = 0; j < d_; ++j) add_product(algebra_, sum, here(s_.g_y[k][j]), algebra_.input(n_ + j));
      rates.push_back(sum);
    }
    result_.rates = negative(factors_->solve(std::move(rates)));
    std::ranges::copy(result_.rates, inputs_.begin() + n_ + d_);
    for (int l = 0; l < m_; ++l)
      for (int j = 0; j < d_; ++j) result_.slopes.push_back(by_u_[j][l]);
  }

  /// μ and ν; of a motion `forced` they balance the forces too.
  void find_multipliers(bool forced) {
    Row by_rate, by_value;
    for (int l = 0; l < m_; ++l) by_rate.push_back(here(s_.lagrangian_z[n_ + d_ + l]));
    const Row nu = negative(factors_->solve_transposed(std::move(by_rate)));
    for (int l = 0; l < m_; ++l) {
      Scaled sum = here(s_.lagrangian_z[d_ + l]);
      if (forced) sum = algebra_.add(sum, here(s_.force[d_ + l]));
      for (int k = 0; k < m_; ++k) add_product(algebra_, sum, here(s_.rate_y[k][d_ + l]), nu[k]);
      by_value.push_back(sum);
    }
    const Row mu = negative(factors_->solve_transposed(std::move(by_value)));
    inputs_.resize(2 * n_ + 1);
    inputs_.insert(inputs_.end(), mu.begin(), mu.end());
    inputs_.insert(inputs_.end(), nu.begin(), nu.end());
  }

  /// ∂(y, y') by each of (u, u').
  Matrix directions() {
    Matrix result(2 * d_, Row(2 * n_));
    for (int j = 0; j < d_; ++j) {
      result[j][j] = result[d_ + j][n_ + j] = algebra_.constant(1);
      Row right;
      for (int k = 0; k < m_; ++k) {
        Scaled sum = here(s_.rate_y[k][j]);
        for (int l = 0; l < m_; ++l) add_product(algebra_, sum, here(s_.rate_y[k][d_ + l]), by_u_[j][l]);
        right.push_back(sum);
      }
      const Row rates_by_u = negative(factors_->solve(std::move(right)));
      for (int l = 0; l < m_; ++l) {
        result[j][d_ + l] = result[d_ + j][n_ + d_ + l] = by_u_[j][l];
        result[j][n_ + d_ + l] = rates_by_u[l];
      }
    }
    return result;
  }

  /// Zᵀ ∂²F Z; both triangles.
  Matrix second_derivatives() {
    Matrix f(2 * n_, Row(2 * n_)), result(2 * d_, Row(2 * d_));
    for (int a = 0; a < 2 * n_; ++a)
      for (int b = 0; b <= a; ++b) f[a][b] = f[b][a] = here(s_.second[a][b]);
    for (int column = 0; column < 2 * d_; ++column) {
      const Row along = product(f, z_[column]);
      for (int row = column; row < 2 * d_; ++row)
        result[row][column] = result[column][row] = product(z_[row], along);
    }
    return result;
  }

  void find_hessian() {
    const Matrix second = second_derivatives();
    for (int row = 0; row < 2 * d_; ++row)
      for (int column = 0; column <= row; ++column)
        if (const Scaled value = second[row][column]; !value.zero())
          result_.hessian.push_back({row, column, value});
  }

  /// ∂Q by (u, u'), but for what multipliers contribute; rows of u' vanish.
  Matrix slopes_of_forces() {
    Matrix f, result(2 * d_, Row(2 * d_));
    for (const Row& row : s_.force_z) f.push_back(here(row));
    for (int column = 0; column < 2 * d_; ++column) {
      const Row along = product(f, z_[column]);
      for (int row = 0; row < d_; ++row) {
        const Row displaced(z_[row].begin(), z_[row].begin() + n_);
        result[row][column] = product(displaced, along);
      }
    }
    return result;
  }

  /// Of two copies: with ∂/∂q₁ = ½ ∂/∂u + ∂/∂λ, ∂/∂q₂ = ½ ∂/∂u − ∂/∂λ.
  void find_copies() {
    find_multipliers(true);
    for (int j = 0; j < 2 * d_; ++j) {
      const Scaled value = here(s_.first[state(j)]);
      result_.motion.push_back(j < d_ ? algebra_.add(value, here(s_.force[j])) : value);
    }
    const Matrix second = second_derivatives(), forces = slopes_of_forces();
    for (int row = 0; row < 4 * d_; ++row)
      for (int column = 0; column <= row; ++column) {
        const int a = in_copy(row), b = in_copy(column);
        const double sign_a = sign_of_copy(row), sign_b = sign_of_copy(column);
        Scaled value = sign_a == sign_b ? times(sign_a, second[a][b]) : Scaled{};
        value = algebra_.add(value, times(sign_a / 2, forces[a][b]));
        value = algebra_.add(value, times(sign_b / 2, forces[b][a]));
        if (!value.zero()) result_.copies_hessian.push_back({row, column, value});
      }
    result_.autonomous_forces = !s_.timed_forces();
  }

  /// Index in (u, u') of the index in (q₁, q₂, q₁', q₂').
  int in_copy(int z) const { return z / (2 * d_) * d_ + z % d_; }
  double sign_of_copy(int z) const { return z / d_ % 2 == 0 ? 1 : -1; }
  static Scaled times(double factor, Scaled a) { return {factor * a.factor, a.node}; }

  Scaled product(const Row& a, const Row& b) {
    Scaled sum;
    for (std::size_t k = 0; k < a.size(); ++k) add_product(algebra_, sum, a[k], b[k]);
    return sum;
  }
  Row product(const Matrix& a, const Row& b) {
    Row result;
    for (const Row& row : a) result.push_back(product(row, b));
    return result;
  }

  /// Of each expression only a sign is left beside its node.
  void absorb_factors() {
    const auto absorb = [&](Scaled& value) {
      if (!value.zero())
        value = {value.factor < 0 ? -1.0 : 1.0, algebra_.node({std::abs(value.factor), value.node})};
    };
    absorb(result_.value);
    for (Partial& p : result_.gradient) absorb(p.value);
    for (auto* entries : {&result_.hessian, &result_.copies_hessian})
      for (auto& p : *entries) absorb(p.value);
    for (Row* row :
         {&result_.start, &result_.steps, &result_.pivots, &result_.rates, &result_.slopes, &result_.motion})
      for (Scaled& value : *row) absorb(value);
    Kernel& kernel = result_.kernel;
    const auto put = [&](Variable kind, int count) {
      for (int k = 0; k < count; ++k) {
        kernel.kinds.push_back(kind);
        kernel.table.push_back(static_cast<std::uint32_t>(k));
      }
    };
    put(Variable::coordinate, n_);
    put(Variable::velocity, d_);
    put(Variable::time, 1);
  }

  InAllCoordinates& s_;
  const Chart& chart_;
  const int n_, d_, m_;
  MinimalExpressions result_;
  Algebra algebra_;             ///< of the kernel's graph
  std::vector<Scaled> inputs_;  ///< of the system's graph, as they are known
  std::optional<Factors> factors_;
  Matrix by_u_;  ///< ∂w/∂u, a row for each of u
  Matrix z_;     ///< Zᵀ
};

}  // namespace

MinimalExpressions minimal_expressions(const ConstrainedGraph& system, const Chart& chart) {
  InAllCoordinates expressions(system, chart);
  return Reduced(expressions, chart).run();
}

}  // namespace extremal
