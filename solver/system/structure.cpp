#include "system/structure.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace extremal {

namespace {

constexpr std::initializer_list<Variable> varying = {Variable::coordinate, Variable::velocity, Variable::time,
                                                     Variable::parameter};

/// The constant coefficients of ½ q'ᵀ M q' + q'ᵀ C q + aᵀ q', summed over kernels.
class QuadraticForm {
 public:
  QuadraticForm(const LagrangianGraph& l, Structure& s) : l_(l), structure_(s), linear_(l.coordinates) {}

  /// False if some second derivative with a velocity, or the term linear in it, is not constant, or a
  /// momentum jumps: then second derivatives do not tell the first ones.
  bool add(const Kernel& kernel);
  void finish();

 private:
  bool add_hessian(const Kernel& kernel);
  bool add_linear(const Kernel& kernel);
  static std::vector<Triplet> merged(std::vector<Triplet> entries);

  const LagrangianGraph& l_;
  Structure& structure_;
  std::vector<Triplet> mass_, gyroscopic_;
  std::vector<double> linear_;
};

bool QuadraticForm::add(const Kernel& kernel) { return add_hessian(kernel) && add_linear(kernel); }

bool QuadraticForm::add_hessian(const Kernel& kernel) {
  std::vector<SecondPartial> entries;
  std::vector<Scaled> values;
  const std::vector<bool> varies = dependents(kernel, varying);
  for (const SecondPartial& p : kernel.hessian) {
    if (kernel.kinds[p.row] != Variable::velocity && kernel.kinds[p.column] != Variable::velocity) continue;
    if (varies[p.value.node]) return false;
    entries.push_back(p);
    values.push_back(p.value);
  }
  const RowNumbers numbers = row_numbers(kernel, values, l_.uniforms);
  for (int r = 0; r < kernel.rows; ++r) {
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const double value = numbers.row(r)[k];
      if (!std::isfinite(value)) return false;
      int a = static_cast<int>(kernel.at(r, entries[k].row)),
          b = static_cast<int>(kernel.at(r, entries[k].column));
      const bool row_moves = kernel.kinds[entries[k].row] == Variable::velocity;
      if (row_moves && kernel.kinds[entries[k].column] == Variable::velocity) {
        mass_.push_back({a, b, value});
        if (a != b) mass_.push_back({b, a, value});
      } else {
        if (!row_moves) std::swap(a, b);
        gyroscopic_.push_back({a, b, value});
      }
    }
  }
  return true;
}

/// Whether a step of coordinates or velocities is part of the expression.
bool jumps(const Kernel& kernel, NodeId f) {
  const std::vector<bool> moves = dependents(kernel, {Variable::coordinate, Variable::velocity});
  const std::vector<NodeId> nodes = nodes_of(kernel.graph, f);
  return std::ranges::any_of(nodes, [&](NodeId id) { return kernel.graph[id].op == Op::step && moves[id]; });
}

/// a = ∂L/∂q' where q = q' = 0.
bool QuadraticForm::add_linear(const Kernel& kernel) {
  Kernel origin;
  origin.kinds = kernel.kinds;
  origin.table = kernel.table;
  origin.rows = kernel.rows;
  Algebra algebra(origin.graph);
  std::vector<Scaled> replacement;
  for (std::uint32_t k = 0; k < kernel.kinds.size(); ++k) {
    const bool state = kernel.kinds[k] == Variable::coordinate || kernel.kinds[k] == Variable::velocity;
    replacement.push_back(state ? Scaled{} : algebra.input(k));
  }
  std::vector<std::uint32_t> velocities;
  std::vector<Scaled> values;
  for (const Partial& p : kernel.gradient) {
    if (kernel.kinds[p.input] != Variable::velocity) continue;
    if (jumps(kernel, p.value.node)) return false;
    Scaled value = algebra.import(kernel.graph, p.value.node, replacement);
    value.factor *= p.value.factor;
    velocities.push_back(p.input);
    values.push_back(value);
  }
  const std::vector<bool> varies = dependents(origin, varying);
  if (std::any_of(values.begin(), values.end(), [&](const Scaled& a) { return varies[a.node]; }))
    return false;
  const RowNumbers numbers = row_numbers(origin, values, l_.uniforms);
  for (int r = 0; r < kernel.rows; ++r) {
    for (std::size_t k = 0; k < velocities.size(); ++k) {
      if (!std::isfinite(numbers.row(r)[k])) return false;
      linear_[kernel.at(r, velocities[k])] += numbers.row(r)[k];
    }
  }
  return true;
}

std::vector<Triplet> QuadraticForm::merged(std::vector<Triplet> entries) {
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

void QuadraticForm::finish() {
  structure_.quadratic = true;
  structure_.mass = merged(std::move(mass_));
  structure_.gyroscopic = merged(std::move(gyroscopic_));
  if (std::any_of(linear_.begin(), linear_.end(), [](double a) { return a != 0; }))
    structure_.linear = std::move(linear_);
}

/// How t enters a kernel: frequencies of sin, cos and tan, and whether it stands elsewhere.
void add_frequencies(const Kernel& kernel, std::span<const double> uniforms, Structure& s) {
  const auto time = std::find(kernel.kinds.begin(), kernel.kinds.end(), Variable::time);
  const std::uint32_t t[] = {static_cast<std::uint32_t>(time - kernel.kinds.begin())};
  Kernel slopes;
  slopes.graph = kernel.graph;
  slopes.kinds = kernel.kinds;
  slopes.table = kernel.table;
  slopes.rows = kernel.rows;
  std::vector<Scaled> found;
  std::vector<bool> otherwise(kernel.graph.size(), false);
  const std::vector<bool> timed = dependents(kernel, {Variable::time});
  for (const NodeId id : nodes_of(kernel.graph, kernel.value.node)) {
    const Node& node = kernel.graph[id];
    if (!timed[id]) continue;
    if (node.op == Op::sin || node.op == Op::cos || node.op == Op::tan) {
      const NodeId slope = gradient(slopes.graph, node.a, t).front();
      const bool varies =
          dependents(slopes, {Variable::coordinate, Variable::velocity, Variable::time})[slope];
      if (!varies) found.push_back({1, slope});
      otherwise[id] = varies;
    } else {
      otherwise[id] = node.op == Op::input || (arity(node.op) > 0 && otherwise[node.a]) ||
                      (arity(node.op) > 1 && otherwise[node.b]);
    }
  }
  s.harmonic = s.harmonic && !otherwise[kernel.value.node];
  const RowNumbers numbers = row_numbers(slopes, found, uniforms);
  for (const double slope : numbers.values) s.frequencies.push_back(std::abs(slope));
}

/// Rows of the remainder: all that some kernel contributes to.
void collect_rows(const std::vector<Kernel>& kernels, Structure& s) {
  std::vector<std::pair<int, int>> entries;
  for (const Kernel& kernel : kernels) {
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

Analysis analyse(const LagrangianGraph& l) {
  if (l.coordinates < 1)
    throw std::invalid_argument("coordinates = " + std::to_string(l.coordinates) + "; need at least 1");
  if (l.parameters < 0 || static_cast<std::size_t>(l.parameters) > l.uniforms.size())
    throw std::invalid_argument("parameters = " + std::to_string(l.parameters) + " of " +
                                std::to_string(l.uniforms.size()) + " uniforms");
  Analysis result;
  Structure& s = result.structure;
  s.coordinates = l.coordinates;
  s.parameters = l.parameters;
  s.first_order = l.first_order;

  const std::vector<Group> groups = group_terms(l);
  for (const Group& group : groups) result.kernels.push_back(differentiate(l.graph, group, false));
  for (const Kernel& kernel : result.kernels) {
    if (!dependents(kernel, {Variable::time})[kernel.value.node]) continue;
    s.autonomous = false;
    add_frequencies(kernel, l.uniforms, s);
  }
  std::sort(s.frequencies.begin(), s.frequencies.end());
  s.frequencies.erase(std::unique(s.frequencies.begin(), s.frequencies.end()), s.frequencies.end());

  QuadraticForm form(l, s);
  if (std::all_of(result.kernels.begin(), result.kernels.end(),
                  [&](const Kernel& k) { return form.add(k); })) {
    form.finish();
    result.kernels.clear();
    for (const Group& group : groups) result.kernels.push_back(differentiate(l.graph, group, true));
  }
  std::erase_if(result.kernels, [](const Kernel& kernel) { return kernel.value.zero(); });
  s.velocity_free =
      std::none_of(result.kernels.begin(), result.kernels.end(), [](const Kernel& kernel) -> bool {
        return dependents(kernel, {Variable::velocity})[kernel.value.node];
      });
  collect_rows(result.kernels, s);
  return result;
}

}  // namespace extremal
