#include "system/structure.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace extremal {

namespace {

constexpr std::initializer_list<Variable> moving = {Variable::coordinate, Variable::velocity, Variable::time};
constexpr std::initializer_list<Variable> varying = {Variable::coordinate, Variable::velocity, Variable::time,
                                                     Variable::parameter};

/// A power of sin or exp beyond may be a pulse.
constexpr double most_power = 8;

/// Whether a step of coordinates or velocities is part of the expression.
bool jumps(const Kernel& kernel, NodeId f) {
  const std::vector<bool> moves = dependents(kernel, {Variable::coordinate, Variable::velocity});
  const std::vector<NodeId> nodes = nodes_of(kernel.graph, f);
  return std::ranges::any_of(nodes, [&](NodeId id) { return kernel.graph[id].op == Op::step && moves[id]; });
}

/// A kernel of the same rows without expressions.
Kernel empty_like(const Kernel& kernel) {
  Kernel empty;
  empty.kinds = kernel.kinds;
  empty.table = kernel.table;
  empty.rows = kernel.rows;
  return empty;
}

std::vector<Triplet> merged(std::vector<Triplet> entries) {
  const auto order = [](const Triplet& a, const Triplet& b) {
    return std::pair(a.row, a.column) < std::pair(b.row, b.column);
  };
  std::stable_sort(entries.begin(), entries.end(), order);
  std::vector<Triplet> result;
  for (const Triplet& t : entries) {
    if (!result.empty() && result.back().row == t.row && result.back().column == t.column) {
      result.back().value += t.value;
    } else {
      result.push_back(t);
    }
  }
  std::erase_if(result, [](const Triplet& t) { return t.value == 0; });
  return result;
}

/// Rows of the remainder: all that some kernel contributes to.
void collect_rows(std::span<const std::shared_ptr<const Kernel>> kernels, Structure& s) {
  std::vector<std::pair<int, int>> entries;
  for (const auto& each : kernels) {
    const Kernel& kernel = *each;
    for (int r = 0; r < kernel.rows; ++r) {
      for (const Partial& p : kernel.gradient)
        s.gradient.push_back(state_index(kernel, r, p.input, s.coordinates));
      for (const SecondPartial& p : kernel.hessian) {
        const HessianEntry e = hessian_entry(kernel, r, p, s.coordinates);
        entries.emplace_back(e.row, e.column);
      }
    }
  }
  std::sort(s.gradient.begin(), s.gradient.end());
  s.gradient.erase(std::unique(s.gradient.begin(), s.gradient.end()), s.gradient.end());
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  for (const auto& [row, column] : entries) s.hessian.push_back({row, column});
}

}  // namespace

bool pulses(const Kernel& kernel, NodeId value) {
  Kernel slopes = empty_like(kernel);
  slopes.graph = kernel.graph;
  std::vector<std::uint32_t> inputs;
  for (std::uint32_t k = 0; k < kernel.kinds.size(); ++k)
    if (!kernel.is_uniform(k)) inputs.push_back(k);
  const auto linear = [&](NodeId argument) {
    const std::vector<NodeId> slope = gradient(slopes.graph, argument, inputs);
    const std::vector<bool> varies = dependents(slopes, moving);
    return std::ranges::none_of(slope, [&](NodeId id) { return varies[id]; });
  };
  const std::vector<bool> moves = dependents(kernel, moving);
  std::vector<bool> exponential(kernel.graph.size(), false), wave = exponential;
  for (const NodeId id : nodes_of(kernel.graph, value)) {
    if (!moves[id]) continue;
    const Node& node = kernel.graph[id];
    const NodeId a = node.a, b = arity(node.op) > 1 ? node.b : node.a;
    if (node.op == Op::tanh || (node.op == Op::exp && !linear(a))) return true;
    if (node.op == Op::div && exponential[b]) return true;
    if (node.op == Op::pow) {
      const Node& power = kernel.graph[b];
      const double p = power.op == Op::constant ? power.value : 1;
      if ((exponential[a] && p < 0) || ((exponential[a] || wave[a]) && std::abs(p) > most_power)) return true;
    }
    const bool function = arity(node.op) > 0;
    exponential[id] = node.op == Op::exp || node.op == Op::sinh || node.op == Op::cosh ||
                      (function && (exponential[a] || exponential[b]));
    wave[id] = node.op == Op::sin || node.op == Op::cos || (function && (wave[a] || wave[b]));
  }
  return false;
}

bool StructureNumbers::add_second(const std::shared_ptr<const Kernel>& kernel) {
  const std::vector<bool> varies = dependents(*kernel, varying);
  Expressions found{.kernel = kernel, .values = {}, .inputs = {}};
  for (const SecondPartial& p : kernel->hessian) {
    if (kernel->kinds[p.row] != Variable::velocity && kernel->kinds[p.column] != Variable::velocity) continue;
    if (varies[p.value.node]) return false;
    found.inputs.emplace_back(p.row, p.column);
    found.values.push_back(p.value);
  }
  second_.push_back(std::move(found));
  return true;
}

bool StructureNumbers::add_first(const Kernel& kernel) {
  const auto origin = std::make_shared<Kernel>(empty_like(kernel));
  Algebra algebra(origin->graph);
  std::vector<Scaled> replacement;
  for (std::uint32_t k = 0; k < kernel.kinds.size(); ++k) {
    const bool state = kernel.kinds[k] == Variable::coordinate || kernel.kinds[k] == Variable::velocity;
    replacement.push_back(state ? Scaled{} : algebra.input(k));
  }
  Expressions found{.kernel = origin, .values = {}, .inputs = {}};
  for (const Partial& p : kernel.gradient) {
    if (kernel.kinds[p.input] != Variable::velocity) continue;
    if (jumps(kernel, p.value.node)) return false;
    Scaled value = algebra.import(kernel.graph, p.value.node, replacement);
    value.factor *= p.value.factor;
    found.inputs.emplace_back(p.input, p.input);
    found.values.push_back(value);
  }
  const std::vector<bool> varies = dependents(*origin, varying);
  if (std::ranges::any_of(found.values, [&](const Scaled& a) { return varies[a.node]; })) return false;
  first_.push_back(std::move(found));
  return true;
}

bool StructureNumbers::add_frequencies(const Kernel& kernel) {
  const auto time = std::find(kernel.kinds.begin(), kernel.kinds.end(), Variable::time);
  const std::uint32_t t[] = {static_cast<std::uint32_t>(time - kernel.kinds.begin())};
  const auto slopes = std::make_shared<Kernel>(empty_like(kernel));
  slopes->graph = kernel.graph;
  Expressions found{.kernel = slopes, .values = {}, .inputs = {}};
  std::vector<bool> otherwise(kernel.graph.size(), false);
  const std::vector<bool> timed = dependents(kernel, {Variable::time});
  for (const NodeId id : nodes_of(kernel.graph, kernel.value.node)) {
    const Node& node = kernel.graph[id];
    if (!timed[id]) continue;
    if (node.op == Op::sin || node.op == Op::cos || node.op == Op::tan) {
      const NodeId slope = gradient(slopes->graph, node.a, t).front();
      const bool varies = dependents(*slopes, moving)[slope];
      if (!varies) found.values.push_back({1, slope});
      otherwise[id] = varies;
    } else {
      otherwise[id] = node.op == Op::input || (arity(node.op) > 0 && otherwise[node.a]) ||
                      (arity(node.op) > 1 && otherwise[node.b]);
    }
  }
  frequencies_.push_back(std::move(found));
  return !otherwise[kernel.value.node];
}

bool StructureNumbers::put(std::span<const double> uniforms, Structure& s) const {
  s.frequencies.clear();
  for (const Expressions& e : frequencies_)
    for (const double slope : row_numbers(*e.kernel, e.values, uniforms).values)
      s.frequencies.push_back(std::abs(slope));
  std::sort(s.frequencies.begin(), s.frequencies.end());
  s.frequencies.erase(std::unique(s.frequencies.begin(), s.frequencies.end()), s.frequencies.end());

  std::vector<Triplet> mass, gyroscopic;
  std::vector<double> linear(s.coordinates);
  bool finite = true;
  const auto each = [&](const std::vector<Expressions>& all, const auto& take) {
    for (const Expressions& e : all) {
      const RowNumbers numbers = row_numbers(*e.kernel, e.values, uniforms);
      for (int r = 0; r < e.kernel->rows; ++r)
        for (std::size_t k = 0; k < e.values.size(); ++k) {
          finite = finite && std::isfinite(numbers.row(r)[k]);
          take(*e.kernel, r, e.inputs[k], numbers.row(r)[k]);
        }
    }
  };
  each(second_, [&](const Kernel& kernel, int r, auto inputs, double value) {
    auto [row, column] = inputs;
    const bool row_moves = kernel.kinds[row] == Variable::velocity;
    if (!row_moves) std::swap(row, column);
    const int a = static_cast<int>(kernel.at(r, row)), b = static_cast<int>(kernel.at(r, column));
    if (kernel.kinds[column] != Variable::velocity) {
      gyroscopic.push_back({a, b, value});
    } else {
      mass.push_back({a, b, value});
      if (a != b) mass.push_back({b, a, value});
    }
  });
  each(first_, [&](const Kernel& kernel, int r, auto inputs, double value) {
    linear[kernel.at(r, inputs.first)] += value;
  });
  s.mass = finite ? merged(std::move(mass)) : std::vector<Triplet>();
  s.gyroscopic = finite ? merged(std::move(gyroscopic)) : std::vector<Triplet>();
  s.linear.clear();
  if (finite && std::ranges::any_of(linear, [](double a) { return a != 0; })) s.linear = std::move(linear);
  return finite;
}

Analysis analyse(const LagrangianGraph& l) {
  if (l.coordinates < 1)
    throw std::invalid_argument("coordinates = " + std::to_string(l.coordinates) + "; need at least 1");
  if (l.parameters < 0 || static_cast<std::size_t>(l.parameters) > l.uniforms.size())
    throw std::invalid_argument("parameters = " + std::to_string(l.parameters) + " of " +
                                std::to_string(l.uniforms.size()) + " uniforms");
  Analysis result;
  Structure& s = result.structure;
  s.coordinates = l.coordinates;
  s.parameters = l.replaceable ? 0 : l.parameters;
  s.first_order = l.first_order;

  const std::vector<Group> groups = group_terms(l);
  const auto kernels_of = [&](bool at_rest) {
    std::vector<std::shared_ptr<const Kernel>> kernels;
    for (const Group& group : groups)
      kernels.push_back(std::make_shared<const Kernel>(differentiate(l.graph, group, at_rest)));
    return kernels;
  };
  result.kernels = kernels_of(false);
  for (const auto& kernel : result.kernels) {
    s.pulses = s.pulses || pulses(*kernel, kernel->value.node);
    if (!dependents(*kernel, {Variable::time})[kernel->value.node]) continue;
    s.autonomous = false;
    if (!result.numbers.add_frequencies(*kernel)) s.harmonic = false;
  }
  s.quadratic = std::ranges::all_of(result.kernels, [&](const auto& kernel) {
    return result.numbers.add_second(kernel) && result.numbers.add_first(*kernel);
  });
  s.quadratic = s.quadratic && result.numbers.put(l.uniforms, s);
  if (s.quadratic) {
    result.kernels = kernels_of(true);
  } else {
    result.numbers.clear_form();
    result.numbers.put(l.uniforms, s);
  }
  std::erase_if(result.kernels, [](const auto& kernel) { return kernel->value.zero(); });
  s.velocity_free = std::ranges::none_of(result.kernels, [](const auto& kernel) -> bool {
    return dependents(*kernel, {Variable::velocity})[kernel->value.node];
  });
  collect_rows(result.kernels, s);
  return result;
}

}  // namespace extremal
