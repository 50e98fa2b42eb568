#include "system/momentum_forms.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "system/merged_sets.hpp"

namespace extremal {

namespace {

PhaseInput kind_of(const LagrangianGraph& h, std::uint32_t global) {
  const auto n = static_cast<std::uint32_t>(h.coordinates);
  if (global < n) return PhaseInput::coordinate;
  if (global < 2 * n) return PhaseInput::momentum;
  if (global == 2 * n) return PhaseInput::time;
  return global < 2 * n + 1 + h.parameters ? PhaseInput::parameter : PhaseInput::uniform;
}

std::vector<PhaseRows> rows_by_kind(const LagrangianGraph& h) {
  std::vector<PhaseRows> result;
  for (const Term& term : h.terms) {
    std::map<std::vector<PhaseInput>, std::size_t> known;
    for (int r = 0; r < term.rows(); ++r) {
      const std::uint32_t* row = term.table.data() + static_cast<std::size_t>(r) * term.arity;
      std::vector<PhaseInput> kinds;
      for (int m = 0; m < term.arity; ++m) kinds.push_back(kind_of(h, row[m]));
      const auto [at, added] = known.emplace(kinds, result.size());
      if (added) result.push_back({term.body, term.arity, kinds, {}});
      std::vector<std::uint32_t>& table = result[at->second].table;
      table.insert(table.end(), row, row + term.arity);
    }
  }
  return result;
}

/// Takes the expression of some rows apart.
class RowsReader {
 public:
  RowsReader(Algebra& algebra, const std::vector<PhaseInput>& kinds) : algebra_(algebra) {
    for (const PhaseInput kind : kinds) momentum_.push_back(kind == PhaseInput::momentum);
  }

  /// False where a summand of f is neither a quadratic form nor a root of one.
  bool read(Scaled f) {
    std::vector<Summand> summands;
    cut(f, summands, rest);
    return std::ranges::all_of(summands, [&](const Summand& summand) { return take_apart(summand); });
  }

  std::vector<MomentumForm> forms;
  Scaled rest;  ///< what has no momenta

 private:
  /// factor · moving, where the factor has no momenta.
  struct Summand {
    Scaled moving, factor;
  };

  bool depends(NodeId node);
  void cut(Scaled f, std::vector<Summand>& summands, Scaled& rest);
  void cut_product(Scaled f, std::vector<Summand>& summands, Scaled& rest);
  Scaled at_rest(Scaled f);
  std::optional<MomentumForm> quadratic_form(Scaled f, MergedSets& together);
  bool take_apart(const Summand& summand);
  void keep(MomentumForm form);

  Algebra& algebra_;
  std::vector<bool> momentum_;                ///< by input
  std::unordered_map<NodeId, bool> depends_;  ///< on momenta
};

/// Whether an expression depends on momenta.
bool RowsReader::depends(NodeId node) {
  if (const auto at = depends_.find(node); at != depends_.end()) return at->second;
  for (const NodeId id : nodes_of(algebra_.graph(), node)) {
    const auto [at, added] = depends_.emplace(id, false);
    if (!added) continue;
    const Node& n = algebra_.graph()[id];
    at->second = n.op == Op::input
                     ? momentum_[n.index]
                     : (arity(n.op) > 0 && depends_.at(n.a)) || (arity(n.op) > 1 && depends_.at(n.b));
  }
  return depends_.at(node);
}

/// f as a sum: summands that depend on momenta, and the rest. Factors without momenta are distributed.
void RowsReader::cut(Scaled f, std::vector<Summand>& summands, Scaled& rest) {
  std::vector<Scaled> waiting{f};  // the next one last: sums may be long
  while (!waiting.empty()) {
    f = waiting.back();
    waiting.pop_back();
    if (f.zero()) continue;
    const Node n = algebra_.graph()[f.node];
    if (!depends(f.node)) {
      rest = algebra_.add(rest, f);
    } else if (n.op == Op::add || n.op == Op::sub) {
      waiting.push_back(algebra_.scaled(n.op == Op::add ? f.factor : -f.factor, n.b));
      waiting.push_back(algebra_.scaled(f.factor, n.a));
    } else {
      cut_product(f, summands, rest);
    }
  }
}

void RowsReader::cut_product(Scaled f, std::vector<Summand>& summands, Scaled& rest) {
  const Node n = algebra_.graph()[f.node];
  const bool product = n.op == Op::mul || n.op == Op::div;
  const bool first = product && depends(n.a), second = product && depends(n.b);
  if (first == second || (n.op == Op::div && second)) {
    summands.push_back({{1, f.node}, algebra_.constant(f.factor)});
    return;
  }
  const Scaled other = algebra_.scaled(1, first ? n.b : n.a);
  const Scaled factor = n.op == Op::div ? algebra_.reciprocal(other) : other;
  std::vector<Summand> parts;
  Scaled still;
  cut(algebra_.scaled(f.factor, first ? n.a : n.b), parts, still);
  for (const Summand& part : parts) summands.push_back({part.moving, algebra_.multiply(part.factor, factor)});
  rest = algebra_.add(rest, algebra_.multiply(still, factor));
}

/// f with all momenta zero.
Scaled RowsReader::at_rest(Scaled f) {
  if (f.zero()) return f;
  std::vector<Scaled> replacement;
  for (std::uint32_t k = 0; k < momentum_.size(); ++k)
    replacement.push_back(momentum_[k] ? Scaled{} : algebra_.input(k));
  Scaled value = algebra_.import(algebra_.graph(), f.node, replacement);
  value.factor *= f.factor;
  return value;
}

/// a, b, c of f; `together` joins inputs that f couples. Nothing where f is not quadratic.
std::optional<MomentumForm> RowsReader::quadratic_form(Scaled f, MergedSets& together) {
  MomentumForm form;
  for (const Partial& slope : differentiate(algebra_, f, momentum_)) {
    form.momenta.push_back(slope.input);
    for (const Partial& second : differentiate(algebra_, slope.value, momentum_)) {
      if (depends(second.value.node)) return std::nullopt;
      form.a.push_back({slope.input, second.input, second.value});
      together.merge(slope.input, second.input);
    }
    if (const Scaled b = at_rest(slope.value); !b.zero()) form.b.push_back({slope.input, b});
  }
  form.c = at_rest(f);
  return form;
}

void RowsReader::keep(MomentumForm form) {
  std::vector<Scaled> values{form.c, form.g};
  for (const MomentumForm::Second& second : form.a) values.push_back(second.value);
  for (const Partial& b : form.b) values.push_back(b.value);
  for (const Scaled value : values) {
    if (value.zero()) continue;
    const std::vector<std::uint32_t> inputs = inputs_of(algebra_.graph(), value.node);
    form.read.insert(form.read.end(), inputs.begin(), inputs.end());
  }
  std::ranges::sort(form.read);
  form.read.erase(std::unique(form.read.begin(), form.read.end()), form.read.end());
  forms.push_back(std::move(form));
}

/// A quadratic summand makes a form for each set of momenta that it couples, where c goes to the rest if
/// there are several; a root makes one. False where it is neither.
bool RowsReader::take_apart(const Summand& summand) {
  MergedSets together(momentum_.size());
  std::optional<MomentumForm> whole = quadratic_form(summand.moving, together);
  if (!whole) {
    const Node n = algebra_.graph()[summand.moving.node];
    if (n.op == Op::sqrt) whole = quadratic_form(algebra_.scaled(1, n.a), together);
    if (!whole) return false;
    whole->g = summand.factor;
    whole->root = true;
    keep(*std::move(whole));
    return true;
  }
  for (MomentumForm::Second& second : whole->a)
    second.value = algebra_.multiply(second.value, summand.factor);
  for (Partial& b : whole->b) b.value = algebra_.multiply(b.value, summand.factor);
  whole->c = algebra_.multiply(whole->c, summand.factor);
  std::map<std::uint32_t, MomentumForm> parts;
  for (const std::uint32_t m : whole->momenta) parts[together.find(m)].momenta.push_back(m);
  for (const MomentumForm::Second& second : whole->a) parts[together.find(second.row)].a.push_back(second);
  for (const Partial& b : whole->b) parts[together.find(b.input)].b.push_back(b);
  if (parts.size() == 1)
    parts.begin()->second.c = whole->c;
  else
    rest = algebra_.add(rest, whole->c);
  for (auto& [first, form] : parts) keep(std::move(form));
  return true;
}

}  // namespace

std::optional<MomentumForms> momentum_forms(const LagrangianGraph& hamiltonian, Algebra& algebra) {
  MomentumForms result;
  result.rows = rows_by_kind(hamiltonian);
  for (std::size_t r = 0; r < result.rows.size(); ++r) {
    RowsReader reader(algebra, result.rows[r].kinds);
    if (!reader.read(algebra.import(hamiltonian.graph, result.rows[r].body))) return std::nullopt;
    for (MomentumForm& form : reader.forms) {
      form.rows = r;
      result.forms.push_back(std::move(form));
    }
    if (!reader.rest.zero()) result.rest.push_back({r, reader.rest});
  }
  return result;
}

}  // namespace extremal
