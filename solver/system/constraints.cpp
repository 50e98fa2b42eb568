#include "system/constraints.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "system/copies.hpp"
#include "system/moved_ends.hpp"

namespace extremal {

namespace {

using Symbols = std::vector<Symbol>;

/// Steps onto the manifold after the first. One is enough for the second variation; with another L̃ has other
/// extremals beside the manifold only farther away.
constexpr int further_steps = 2;
/// Of forces, which have the derivatives of P to second order.
constexpr int further_steps_of_power = 1;

/// A vector that depends on (x, t), and its rate along x(t).
struct Moving {
  Symbols value, rate;
};

/// P, its rate and c, on the graph of a system. The rates are those along a motion, whose velocities are
/// inputs, or along a displacement at one time.
class Projector {
 public:
  Projector(ConstrainedGraph& system, const NormalMotion& normal)
      : Projector(system, normal, system.coordinates, true) {}
  /// Along the displacement that inputs from `displacement` on are.
  Projector(ConstrainedGraph& system, const NormalMotion& normal, int displacement)
      : Projector(system, normal, displacement, false) {}

  NodeId run() {
    const Moving q = point();
    Symbol sum(&graph_, substitute(graph_, system_.lagrangian, inputs(q)));
    const double square = normal_.rate * normal_.rate;
    for (int k = 0; k < m_; ++k) {
      const Symbol size = sqrt(a_[k * m_ + k]), c = g_.value[k] / size;
      const Symbol rate = (g_.rate[k] - 0.5 * c / size * a_rate_[k * m_ + k]) / size;
      sum += 0.5 * (rate * rate + square * c * c);
    }
    return sum.node(graph_);
  }

  /// P alone.
  std::vector<NodeId> position() {
    std::vector<NodeId> nodes;
    for (const Symbol& s : point().value) nodes.push_back(s.node(graph_));
    return nodes;
  }

  /// F(P, dP/dt, t)·(rate of P along the displacement of another).
  NodeId power(Projector& displaced) {
    const Moving q = point(further_steps_of_power), moving = displaced.point(further_steps_of_power);
    const std::vector<NodeId> there = inputs(q);
    Symbol sum = symbol(graph_.constant(0));
    for (int a = 0; a < n_; ++a) sum += symbol(substitute(graph_, system_.forces[a], there)) * moving.rate[a];
    return sum.node(graph_);
  }

 private:
  Projector(ConstrainedGraph& system, const NormalMotion& normal, int rates, bool timed)
      : system_(system),
        graph_(system.graph),
        normal_(normal),
        n_(system.coordinates),
        m_(static_cast<int>(system.constraints.size())),
        timed_(timed) {
    for (int a = 0; a < n_; ++a) {
      x_.value.push_back(input(a));
      x_.rate.push_back(a < n_ - normal.constants ? input(rates + a) : symbol(graph_.constant(0)));
    }
    differentiate();
    factor();
  }

  /// P.
  Moving point(int most_further = further_steps) {
    Moving q = moved(x_, g_);
    for (int further = 0; further < most_further && curved(); ++further) q = moved(q, constraints_at(q));
    return q;
  }

  Symbol input(int index) { return {&graph_, graph_.input(static_cast<std::uint32_t>(index))}; }
  Symbol symbol(NodeId id) { return {&graph_, id}; }
  bool zero(const Symbol& s) { return graph_.is_constant(s.node(graph_), 0); }

  /// ∂f/∂(x, t).
  std::vector<NodeId> slopes_of(NodeId f) {
    std::vector<std::uint32_t> by(n_);
    std::iota(by.begin(), by.end(), 0u);
    by.push_back(2 * n_);
    return gradient(graph_, f, by);
  }

  Symbol rate_of(std::span<const NodeId> slopes, const Symbols& velocity) {
    Symbol rate = symbol(timed_ ? slopes[n_] : graph_.constant(0));
    for (int a = 0; a < n_; ++a) rate += symbol(slopes[a]) * velocity[a];
    return rate;
  }

  void differentiate() {
    for (const NodeId g : system_.constraints) {
      slopes_.push_back(slopes_of(g));
      g_.value.push_back(symbol(g));
      g_.rate.push_back(rate_of(slopes_.back(), x_.rate));
      for (int a = 0; a < n_; ++a) {
        const NodeId slope = slopes_.back()[a];
        g_q_.push_back(symbol(slope));
        g_q_rate_.push_back(rate_of(slopes_of(slope), x_.rate));
      }
    }
  }

  /// W v.
  Symbols weighted(const Symbols& v) {
    Symbols result(n_, symbol(graph_.constant(0)));
    for (const Triplet& w : normal_.metric) result[w.row] += w.value * v[w.column];
    return result;
  }

  Symbols row(const Symbols& matrix, int k) {
    return {matrix.begin() + k * n_, matrix.begin() + (k + 1) * n_};
  }

  /// A, its rate, and A = L D Lᵀ; L over D in one matrix.
  void factor() {
    a_.assign(m_ * m_, symbol(graph_.constant(0)));
    a_rate_ = a_;
    for (int l = 0; l < m_; ++l) {
      const Symbols w = weighted(row(g_q_, l)), w_rate = weighted(row(g_q_rate_, l));
      for (int k = l; k < m_; ++k) {
        Symbol sum = symbol(graph_.constant(0)), rate = sum;
        for (int a = 0; a < n_; ++a) {
          sum += g_q_[k * n_ + a] * w[a];
          rate += g_q_rate_[k * n_ + a] * w[a] + g_q_[k * n_ + a] * w_rate[a];
        }
        a_[k * m_ + l] = a_[l * m_ + k] = sum;
        a_rate_[k * m_ + l] = a_rate_[l * m_ + k] = rate;
      }
    }
    factors_ = a_;
    for (int j = 0; j < m_; ++j) {
      inverse_.push_back(1 / factors_[j * m_ + j]);
      for (int i = j + 1; i < m_; ++i) {
        const Symbol below = factors_[i * m_ + j];
        if (zero(below)) continue;
        const Symbol ratio = below * inverse_[j];
        for (int k = i; k < m_; ++k) factors_[k * m_ + i] -= factors_[k * m_ + j] * ratio;
      }
      for (int i = j + 1; i < m_; ++i) factors_[i * m_ + j] *= inverse_[j];
    }
  }

  /// A⁻¹ r.
  Symbols solved(Symbols r) {
    for (int j = 0; j < m_; ++j)
      for (int i = j + 1; i < m_; ++i) r[i] -= factors_[i * m_ + j] * r[j];
    for (int j = 0; j < m_; ++j) r[j] *= inverse_[j];
    for (int j = m_ - 1; j >= 0; --j)
      for (int i = j + 1; i < m_; ++i) r[j] -= factors_[i * m_ + j] * r[i];
    return r;
  }

  /// Gᵀ y.
  Symbols across(const Symbols& matrix, const Symbols& y) {
    Symbols result(n_, symbol(graph_.constant(0)));
    for (int k = 0; k < m_; ++k)
      for (int a = 0; a < n_; ++a) result[a] += matrix[k * n_ + a] * y[k];
    return result;
  }

  /// q − W Gᵀ A⁻¹ r.
  Moving moved(const Moving& q, const Moving& r) {
    const Symbols y = solved(r.value);
    Symbols right = r.rate;
    for (int k = 0; k < m_; ++k)
      for (int l = 0; l < m_; ++l) right[k] -= a_rate_[k * m_ + l] * y[l];
    const Symbols y_rate = solved(std::move(right));
    Symbols direction = across(g_q_rate_, y);
    const Symbols direct = across(g_q_, y_rate);
    for (int a = 0; a < n_; ++a) direction[a] += direct[a];
    const Symbols step = weighted(across(g_q_, y)), step_rate = weighted(direction);
    Moving result = q;
    for (int a = 0; a < n_; ++a) {
      result.value[a] -= step[a];
      result.rate[a] -= step_rate[a];
    }
    return result;
  }

  /// Inputs with another point in their place.
  std::vector<NodeId> inputs(const Moving& q) {
    std::vector<NodeId> nodes;
    for (const Symbols* part : {&q.value, &q.rate})
      for (const Symbol& s : *part) nodes.push_back(s.node(graph_));
    for (std::size_t k = 0; k <= system_.parameters.size(); ++k)
      nodes.push_back(graph_.input(static_cast<std::uint32_t>(2 * n_ + k)));
    return nodes;
  }

  Moving constraints_at(const Moving& q) {
    const std::vector<NodeId> there = inputs(q);
    Moving result;
    for (int k = 0; k < m_; ++k) {
      result.value.push_back(symbol(substitute(graph_, system_.constraints[k], there)));
      std::vector<NodeId> slopes;
      for (const NodeId slope : slopes_[k]) slopes.push_back(substitute(graph_, slope, there));
      result.rate.push_back(rate_of(slopes, q.rate));
    }
    return result;
  }

  /// Whether ∂g/∂q depends on q: else the first step leads onto the manifold.
  bool curved() {
    return std::ranges::any_of(g_q_, [&](const Symbol& s) {
      const std::vector<std::uint32_t> read = inputs_of(graph_, s.node(graph_));
      return !read.empty() && read.front() < static_cast<std::uint32_t>(n_);
    });
  }

  ConstrainedGraph& system_;
  Graph& graph_;
  const NormalMotion& normal_;
  const int n_, m_;
  const bool timed_;
  Moving x_, g_;
  std::vector<std::vector<NodeId>> slopes_;  ///< of each g_k by (x, t)
  Symbols g_q_, g_q_rate_;                   ///< G and its rate, m × n
  Symbols a_, a_rate_, factors_, inverse_;   ///< m × m, and 1/D
};

/// The one summand `body` of inputs numbered as in Term.
LagrangianGraph whole(int coordinates, Graph graph, NodeId body, std::vector<double> parameters) {
  LagrangianGraph result;
  result.coordinates = coordinates;
  result.parameters = static_cast<int>(parameters.size());
  result.uniforms = std::move(parameters);
  std::vector<std::uint32_t> table(2 * coordinates + 1 + result.uniforms.size());
  std::iota(table.begin(), table.end(), 0u);
  const int arity = static_cast<int>(table.size());
  result.graph = std::move(graph);
  result.terms.push_back({body, arity, std::move(table)});
  return result;
}

/// Inputs q, q', t and parameters of n coordinates as those of `n + more`, t the first of these.
std::vector<NodeId> renumbered(const ConstrainedGraph& system, int more, Graph& graph) {
  const int n = system.coordinates, all = n + more;
  std::vector<NodeId> nodes;
  const auto put = [&](int index) { nodes.push_back(graph.input(static_cast<std::uint32_t>(index))); };
  for (int a = 0; a < n; ++a) put(a);
  for (int a = 0; a < n; ++a) put(all + a);
  put(n);
  for (std::size_t k = 0; k < system.parameters.size(); ++k) put(2 * all + 1 + static_cast<int>(k));
  return nodes;
}

}  // namespace

NodeId flattened(const LagrangianGraph& lagrangian, Graph& target) {
  const auto active = static_cast<std::uint32_t>(2 * lagrangian.coordinates + 1 + lagrangian.parameters);
  NodeId sum = target.constant(0);
  for (const Term& term : lagrangian.terms) {
    const std::vector<NodeId> nodes = nodes_of(lagrangian.graph, term.body);
    for (int row = 0; row < term.rows(); ++row) {
      std::unordered_map<NodeId, NodeId> image;
      for (const NodeId id : nodes) {
        const Node node = lagrangian.graph[id];
        if (node.op == Op::input) {
          const std::uint32_t global = term.table[row * term.arity + node.index];
          image[id] = global < active
                          ? target.input(global)
                          : target.constant(lagrangian.uniforms[global - active + lagrangian.parameters]);
        } else {
          image[id] = node.op == Op::constant ? target.constant(node.value)
                      : arity(node.op) == 1   ? target.unary(node.op, image[node.a])
                                              : target.binary(node.op, image[node.a], image[node.b]);
        }
      }
      sum = target.add(sum, image[term.body]);
    }
  }
  return sum;
}

bool has_kinks(const Graph& graph, NodeId f) {
  return std::ranges::any_of(nodes_of(graph, f), [&](NodeId id) {
    const Op op = graph[id].op;
    return op == Op::abs || op == Op::min || op == Op::max || op == Op::step;
  });
}

LagrangianGraph projected(ConstrainedGraph system, const NormalMotion& normal) {
  const NodeId body = Projector(system, normal).run();
  return whole(system.coordinates, std::move(system.graph), body, std::move(system.parameters));
}

LagrangianGraph projected_power(ConstrainedGraph system, const NormalMotion& normal) {
  const int n = system.coordinates, active = static_cast<int>(system.parameters.size());
  const int first = 2 * n + 1 + active;  // of the displacement, behind all inputs of the system
  Projector moving(system, normal), displaced(system, normal, first);
  const NodeId body = moving.power(displaced);
  // Of (x, λ): x, λ, x', λ', t, parameters.
  std::vector<NodeId> inputs;
  const auto put = [&](int index, int count) {
    for (int a = 0; a < count; ++a)
      inputs.push_back(system.graph.input(static_cast<std::uint32_t>(index + a)));
  };
  put(0, n);
  put(2 * n, n);
  put(4 * n, 1 + active);
  put(n, n);
  const NodeId power = substitute(system.graph, body, inputs);
  return whole(2 * n, std::move(system.graph), power, std::move(system.parameters));
}

std::vector<NodeId> forces_of_power(const LagrangianGraph& power, Graph& target) {
  const int n = power.coordinates / 2;
  Graph graph;
  const NodeId body = flattened(power, graph);
  std::vector<std::uint32_t> multipliers(n);
  std::iota(multipliers.begin(), multipliers.end(), static_cast<std::uint32_t>(n));
  const std::vector<NodeId> slopes = gradient(graph, body, multipliers);
  // q, λ, q', λ', t, parameters; λ does not occur any more.
  std::vector<NodeId> inputs, forces;
  const auto put = [&](int number) { inputs.push_back(target.input(static_cast<std::uint32_t>(number))); };
  for (int a = 0; a < 4 * n; ++a) put(a < n ? a : a >= 2 * n && a < 3 * n ? a - n : 0);
  for (int k = 0; k <= power.parameters; ++k) put(2 * n + k);
  for (const NodeId slope : slopes) forces.push_back(copied(graph, slope, inputs, target));
  return forces;
}

MovedEnds moved_ends(ConstrainedGraph system, const NormalMotion& normal, double duration) {
  const int n = system.coordinates;
  const std::vector<NodeId> point = Projector(system, normal).position();
  MovedEnds ends;
  for (const int end : {0, 1}) {
    std::vector<NodeId> inputs;
    for (int a = 0; a < n; ++a) inputs.push_back(ends.graph.input(static_cast<std::uint32_t>(end * n + a)));
    inputs.resize(2 * static_cast<std::size_t>(n), ends.graph.constant(0));
    inputs.push_back(ends.graph.constant(end ? duration : 0));
    for (const double parameter : system.parameters) inputs.push_back(ends.graph.constant(parameter));
    for (const NodeId node : point) ends.values.push_back(copied(system.graph, node, inputs, ends.graph));
  }
  return ends;
}

LagrangianGraph with_time_as_coordinate(const ConstrainedGraph& system) {
  Graph graph = system.graph;
  const NodeId body = substitute(graph, system.lagrangian, renumbered(system, 1, graph));
  return whole(system.coordinates + 1, std::move(graph), body, system.parameters);
}

LagrangianGraph multiplier_form(const ConstrainedGraph& system) {
  Graph graph = system.graph;
  const int m = static_cast<int>(system.constraints.size()), first = system.coordinates + 1;
  const std::vector<NodeId> inputs = renumbered(system, 1 + m, graph);
  NodeId sum = graph.constant(0);
  for (int k = 0; k < m; ++k)
    sum = graph.add(sum, graph.mul(graph.input(static_cast<std::uint32_t>(first + k)),
                                   substitute(graph, system.constraints[k], inputs)));
  return whole(first + m, std::move(graph), sum, system.parameters);
}

}  // namespace extremal
