#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "system/tape_select.hpp"

namespace extremal {

namespace {

constexpr unsigned none = std::numeric_limits<unsigned>::max();
/// Stands in a selection for the output that is added to.
constexpr NodeId the_output = std::numeric_limits<NodeId>::max();

/// Emits instructions root by root, arguments before users. Operands are numbered inputs, outputs, then
/// one for each value; the values are put into slots at the end.
class Lowering {
 public:
  Lowering(const Kernel& kernel, std::span<const Root> roots);
  Program run();

 private:
  bool placed(NodeId node) const { return operand_[node] != none; }
  unsigned new_value() { return values_++; }
  unsigned scalar(Scaled value);
  void demand(const Selection& selection);
  void place(NodeId node, unsigned destination);
  void emit(const Selection& selection, unsigned destination);
  void write(const Root& root, unsigned output);
  void add_to(const Root& root, unsigned output);
  NodeId partner(NodeId node) const;
  void allocate_slots();

  const Graph& graph_;
  std::span<const Root> roots_;
  Selector selector_;
  std::vector<unsigned> operand_;                         ///< by node
  std::map<NodeId, std::pair<NodeId, NodeId>> circular_;  ///< argument: sine and cosine where both are needed
  std::map<std::pair<double, NodeId>, unsigned> scalars_;
  unsigned values_;  ///< the next operand
  Program program_;
};

Lowering::Lowering(const Kernel& kernel, std::span<const Root> roots)
    : graph_(kernel.graph), roots_(roots), selector_(kernel, roots), operand_(kernel.graph.size(), none) {
  program_.inputs = kernel.inputs();
  program_.outputs = static_cast<int>(roots.size());
  values_ = static_cast<unsigned>(program_.inputs + program_.outputs);
  std::map<NodeId, NodeId> sines;
  for (NodeId id = 0; id < graph_.size(); ++id) {
    const Node& n = graph_[id];
    if (!selector_.needed(id) || selector_.uniform(id)) continue;
    if (n.op == Op::input) operand_[id] = n.index;
    if (n.op != Op::sin && n.op != Op::cos) continue;
    const auto [at, first] = sines.emplace(n.a, id);
    if (!first) circular_[n.a] = n.op == Op::cos ? std::pair(at->second, id) : std::pair(id, at->second);
  }
}

unsigned Lowering::scalar(Scaled value) {
  const auto next = static_cast<unsigned>(program_.scalars.size());
  const auto [at, added] = scalars_.emplace(std::pair(value.factor, value.node), next);
  if (added) program_.scalars.push_back(value);
  return at->second;
}

/// Places the arguments. Depth first with a stack of its own: expressions may be deep.
void Lowering::demand(const Selection& selection) {
  std::vector<NodeId> stack;
  const auto push_missing = [&](const Selection& s) {
    const std::size_t before = stack.size();
    for (int k = s.reads; k-- > 0;)
      if (s.arguments[k] != the_output && !placed(s.arguments[k])) stack.push_back(s.arguments[k]);
    return stack.size() > before;
  };
  push_missing(selection);
  while (!stack.empty()) {
    const NodeId node = stack.back();
    if (placed(node)) {
      stack.pop_back();
    } else if (!push_missing(selector_.select(node))) {
      stack.pop_back();
      place(node, new_value());
    }
  }
}

/// Emits a node whose arguments are placed.
void Lowering::place(NodeId node, unsigned destination) {
  operand_[node] = destination;
  const NodeId other = partner(node);
  if (other == node || placed(other)) return emit(selector_.select(node), destination);
  operand_[other] = new_value();
  const auto [sine, cosine] = circular_.at(graph_[node].a);
  program_.code.push_back({.code = Code::sine_cosine,
                           .d = operand_[sine],
                           .a = operand_[graph_[node].a],
                           .b = 0,
                           .c = operand_[cosine],
                           .s = 0});
}

/// The cosine for a sine and the reverse, if both are needed; otherwise the node itself.
NodeId Lowering::partner(NodeId node) const {
  const Op op = graph_[node].op;
  if (op != Op::sin && op != Op::cos) return node;
  const auto at = circular_.find(graph_[node].a);
  if (at == circular_.end()) return node;
  return op == Op::sin ? at->second.second : at->second.first;
}

void Lowering::emit(const Selection& selection, unsigned destination) {
  unsigned arguments[3] = {};
  for (int k = 0; k < selection.reads; ++k)
    arguments[k] = selection.arguments[k] == the_output ? destination : operand_[selection.arguments[k]];
  program_.code.push_back({.code = selection.code,
                           .d = destination,
                           .a = arguments[0],
                           .b = arguments[1],
                           .c = arguments[2],
                           .s = selection.has_scalar ? scalar(selection.scalar) : 0});
}

void Lowering::write(const Root& root, unsigned output) {
  const NodeId node = root.value.node;
  const bool negative = root.value.factor < 0;
  Selection selection = selector_.select(node);
  const bool own = !placed(node) && !selector_.uniform(node) && graph_[node].op != Op::input;
  if (own && !negative) {
    demand(selection);
    return place(node, output);
  }
  if (selector_.uniform(node) ||
      (own && selector_.used_once(node) && partner(node) == node && negate(selection))) {
    if (selector_.uniform(node)) selection.scalar.factor = root.value.factor;
    demand(selection);
    return emit(selection, output);
  }
  selection = {negative ? Code::negate : Code::copy, 1, {node}};
  demand(selection);
  emit(selection, output);
}

void Lowering::add_to(const Root& root, unsigned output) {
  const NodeId node = root.value.node;
  const double sign = root.value.factor;
  Selection selection;
  if (selector_.uniform(node)) {
    selection = {Code::add_scalar, 1, {the_output}, root.value, true};
  } else if (selector_.fusable(node)) {
    selection = selector_.accumulate(node, sign, the_output);
  } else {
    selection = {sign > 0 ? Code::add : Code::subtract, 2, {the_output, node}};
  }
  demand(selection);
  emit(selection, output);
}

/// Linear scan: a value gives its slot back after its last use, to be taken again first.
void Lowering::allocate_slots() {
  const auto first = static_cast<unsigned>(program_.inputs + program_.outputs);
  std::vector<std::size_t> last_use(values_ - first);
  const auto operands = [](Instruction& i) { return std::array<unsigned*, 3>{&i.a, &i.b, &i.c}; };
  for (std::size_t k = 0; k < program_.code.size(); ++k)
    for (int m = 0; m < reads(program_.code[k].code); ++m)
      if (const unsigned v = *operands(program_.code[k])[m]; v >= first) last_use[v - first] = k;

  std::vector<unsigned> slot(values_ - first, none), free;
  const auto take = [&](unsigned& value) {
    if (value < first) return;
    if (free.empty()) free.push_back(first + static_cast<unsigned>(program_.slots++));
    slot[value - first] = free.back();
    value = free.back();
    free.pop_back();
  };
  for (std::size_t k = 0; k < program_.code.size(); ++k) {
    Instruction& instruction = program_.code[k];
    std::vector<unsigned> finished;
    for (int m = 0; m < reads(instruction.code); ++m) {
      unsigned& operand = *operands(instruction)[m];
      if (operand < first) continue;
      const unsigned value = operand - first;
      operand = slot[value];
      if (last_use[value] == k && std::find(finished.begin(), finished.end(), operand) == finished.end())
        finished.push_back(operand);
    }
    free.insert(free.end(), finished.begin(), finished.end());
    take(instruction.d);
    if (instruction.code == Code::sine_cosine) take(instruction.c);
  }
}

Program Lowering::run() {
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    const auto output = static_cast<unsigned>(program_.inputs) + static_cast<unsigned>(k);
    if (roots_[k].direct) {
      write(roots_[k], output);
    } else {
      add_to(roots_[k], output);
    }
  }
  allocate_slots();
  return std::move(program_);
}

}  // namespace

Program lower(const Kernel& kernel, std::span<const Root> roots) { return Lowering(kernel, roots).run(); }

}  // namespace extremal
