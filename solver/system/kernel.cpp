#include "system/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "system/expression_evaluate.hpp"

namespace extremal {

namespace {

/// Partial derivatives by the inputs of one kind; the kernel's graph is the algebra's.
std::vector<bool> state_inputs(const Kernel& kernel) {
  std::vector<bool> result;
  for (const Variable kind : kernel.kinds)
    result.push_back(kind == Variable::coordinate || kind == Variable::velocity);
  return result;
}

Scaled sum_of_parts(Algebra& algebra, const Graph& source, const Group& group, bool at_rest) {
  Scaled sum;
  for (const Part& part : group.parts) {
    std::vector<Scaled> replacement;
    for (const Binding& b : part.inputs) {
      const bool still = !b.number && at_rest && group.kinds[b.input] == Variable::velocity;
      replacement.push_back(still ? Scaled{} : b.number ? algebra.constant(b.value) : algebra.input(b.input));
    }
    sum = algebra.add(sum, algebra.import(source, part.body, replacement));
  }
  return sum;
}

/// ± one node, so that only a sign is left for the instruction that puts it out.
void absorb_factors(Algebra& algebra, Scaled& value) {
  if (!value.zero())
    value = {value.factor < 0 ? -1.0 : 1.0, algebra.node({std::abs(value.factor), value.node})};
}

void absorb_factors(Algebra& algebra, Kernel& kernel) {
  absorb_factors(algebra, kernel.value);
  for (Partial& p : kernel.gradient) absorb_factors(algebra, p.value);
  for (SecondPartial& p : kernel.hessian) absorb_factors(algebra, p.value);
  for (Kernel::Sensitivity& s : kernel.sensitivities) {
    absorb_factors(algebra, s.value);
    for (Partial& p : s.gradient) absorb_factors(algebra, p.value);
  }
}

}  // namespace

Kernel differentiate(const Graph& source, const Group& group, bool at_rest) {
  Kernel kernel;
  kernel.kinds = group.kinds;
  kernel.table = group.table;
  kernel.rows = group.rows;
  std::vector<bool> uniform;
  for (std::uint32_t k = 0; k < group.kinds.size(); ++k) uniform.push_back(kernel.is_uniform(k));
  Algebra algebra(kernel.graph, uniform);

  kernel.value = sum_of_parts(algebra, source, group, at_rest);
  const std::vector<bool> state = state_inputs(kernel);
  kernel.gradient = differentiate(algebra, kernel.value, state);
  std::vector<bool> lower(state.size());
  std::uint32_t marked = 0;
  for (const Partial& row : kernel.gradient) {
    for (; marked <= row.input; ++marked) lower[marked] = state[marked];
    for (const Partial& p : differentiate(algebra, row.value, lower))
      kernel.hessian.push_back({row.input, p.input, p.value});
  }
  for (std::uint32_t k = 0; k < kernel.kinds.size(); ++k) {
    if (kernel.kinds[k] != Variable::parameter) continue;
    std::vector<bool> parameter(kernel.kinds.size());
    parameter[k] = true;
    const std::vector<Partial> slope = differentiate(algebra, kernel.value, parameter);
    if (slope.empty()) continue;
    kernel.sensitivities.push_back(
        {kernel.at(0, k), slope[0].value, differentiate(algebra, slope[0].value, state)});
  }
  absorb_factors(algebra, kernel);
  return kernel;
}

std::vector<bool> dependents(const Kernel& kernel, std::initializer_list<Variable> kinds) {
  std::vector<bool> result(kernel.graph.size());
  for (NodeId id = 0; id < result.size(); ++id) {
    const Node& n = kernel.graph[id];
    result[id] = n.op == Op::input
                     ? std::find(kinds.begin(), kinds.end(), kernel.kinds[n.index]) != kinds.end()
                     : (arity(n.op) > 0 && result[n.a]) || (arity(n.op) > 1 && result[n.b]);
  }
  return result;
}

RowNumbers row_numbers(const Kernel& kernel, std::span<const Scaled> expressions,
                       std::span<const double> uniforms) {
  std::vector<NodeId> nodes;
  for (const Scaled& e : expressions) {
    const std::vector<NodeId> more = nodes_of(kernel.graph, e.node);
    nodes.insert(nodes.end(), more.begin(), more.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());

  bool varies = false;
  std::unordered_map<NodeId, std::size_t> position;
  for (const NodeId id : nodes) {
    position.emplace(id, position.size());
    const Node& n = kernel.graph[id];
    varies = varies || (n.op == Op::input && kernel.kinds[n.index] == Variable::uniform);
  }
  RowNumbers numbers{varies ? static_cast<int>(expressions.size()) : 0, {}};
  std::vector<double> values(nodes.size());
  for (int r = 0; r < (varies ? kernel.rows : 1); ++r) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Node& n = kernel.graph[nodes[k]];
      if (n.op == Op::constant) {
        values[k] = n.value;
      } else if (n.op == Op::input) {
        values[k] = uniforms[kernel.at(r, n.index)];
      } else {
        values[k] = scalar::apply(n.op, values[position[n.a]], arity(n.op) > 1 ? values[position[n.b]] : 0.0);
      }
    }
    for (const Scaled& e : expressions) numbers.values.push_back(e.factor * values[position[e.node]]);
  }
  return numbers;
}

}  // namespace extremal
