#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "system/formula_names.hpp"

namespace extremal::formula {

namespace {

/// Levels that evaluation descends, through definitions too: the stack must hold them.
constexpr int deepest_tree = 1000;

const char* kind_of(Meaning meaning) {
  switch (meaning) {
    case Meaning::coordinate:
      return "a coordinate";
    case Meaning::definition:
      return "a definition";
    case Meaning::index:
      return "an index";
    default:
      return "a parameter";
  }
}

/// Gives meaning to one formula whose definitions have theirs.
class Resolver {
 public:
  Resolver(Formula& formula, const Names& names)
      : formula_(formula), names_(names), indices_(names.indices) {}

  void visit(std::uint32_t id) {
    Syntax& node = formula_.nodes[id];
    if (node.form == Form::series) {
      series(node);
    } else if (node.form == Form::call && find_function(formula_.name(node)) == nullptr) {
      end_value(node);
    } else {
      for (const Link link : formula_.children(node)) visit(link.node);
      if (node.form == Form::reference) reference(node);
      if (node.form == Form::call) call(node);
    }
    summarise(node);
  }

 private:
  [[noreturn]] void stop(const Syntax& node, std::string message) const {
    fail(formula_, node.offset, std::move(message));
  }

  const Syntax& child(const Syntax& node, std::size_t k) const {
    return formula_.nodes[formula_.children(node)[k].node];
  }

  void series(Syntax& node) {
    const std::string name(formula_.name(node));
    const Known* known = names_.find(name);
    if (known != nullptr || std::find(indices_.begin(), indices_.end(), name) != indices_.end())
      stop(node, fmt::format("the index '{}' is {} already; choose another name for it", name,
                             kind_of(known != nullptr ? known->meaning : Meaning::index)));
    if (name == "sum" || name == "t" || name == "T" || name == "pi" || find_function(name) != nullptr)
      stop(node, fmt::format("'{}' is a word of the language; choose another name for the index", name));
    const auto links = formula_.children(node);
    for (int bound = 0; bound < 2; ++bound) {
      visit(links[bound].node);
      require_numeric(child(node, bound), "a bound of a sum");
    }
    node.id = static_cast<int>(indices_.size());
    indices_.push_back(name);
    visit(links[2].node);
    indices_.pop_back();
  }

  void require_numeric(const Syntax& node, const char* what) const {
    if (!node.numeric) stop(node, fmt::format("{} is made of numbers, parameters and indices only", what));
  }

  void reference(Syntax& node) {
    const std::string name(formula_.name(node));
    const auto index = std::find(indices_.begin(), indices_.end(), name);
    if (index != indices_.end()) {
      node.meaning = Meaning::index;
      node.id = static_cast<int>(index - indices_.begin());
    } else if (const Known* known = names_.find(name)) {
      declared(node, name, *known);
      return;
    } else if (name == "pi") {
      node.meaning = Meaning::pi;
    } else if (name == "t" && (names_.kind == Kind::guess || names_.kind == Kind::lagrangian)) {
      node.meaning = Meaning::time;
    } else if (name == "T" && names_.kind == Kind::guess) {
      node.meaning = Meaning::duration;
    } else {
      unknown(node, name);
    }
    if (node.indexed) stop(node, fmt::format("'{}' is one number and takes no index", name));
    if (node.velocity) stop(node, fmt::format("'{}' has no velocity; only coordinates have", name));
  }

  void declared(Syntax& node, const std::string& name, const Known& known) const {
    node.meaning = known.meaning;
    node.id = known.id;
    if (known.meaning == Meaning::coordinate) {
      if (names_.kind == Kind::condition)
        stop(node, fmt::format("write {0}(0) or {0}(T): a condition holds between end values",
                               spelled(name, known)));
      if (names_.kind == Kind::number || names_.kind == Kind::guess)
        stop(node, fmt::format("'{}' is a coordinate; only parameters can stand here", name));
      if (node.velocity && names_.kind == Kind::map)
        stop(node, fmt::format("\"{}'\" is a velocity; a map is made of coordinates", name));
    } else if (node.velocity) {
      stop(node, fmt::format("'{}' is {} and has no velocity; only coordinates have", name,
                             kind_of(known.meaning)));
    }
    check_index(node, name, known);
  }

  static std::string spelled(const std::string& name, const Known& known) {
    return known.array ? name + "[1]" : name;
  }

  void check_index(const Syntax& node, const std::string& name, const Known& known) const {
    if (known.array && !node.indexed)
      stop(node, fmt::format("'{0}' has {1} elements; write {0}[1] … {0}[{1}]", name, known.count));
    if (!known.array && node.indexed)
      stop(node, fmt::format("'{0}' is {1} without elements; write {0}", name, kind_of(known.meaning)));
    if (node.indexed) require_numeric(child(node, 0), "an index");
  }

  void call(Syntax& node) const {
    const Function& function = *find_function(formula_.name(node));
    if (node.indexed || node.velocity)
      stop(node, fmt::format("'{0}' is a function; write {0}(…)", function.name));
    const int wanted = function.arguments();
    if (node.count != static_cast<std::uint32_t>(wanted))
      stop(node, fmt::format("{} takes {} argument{}, here are {}", function.name, wanted,
                             wanted == 1 ? "" : "s", node.count));
    if (function.op == Op::step && child(node, 0).moving)
      stop(
          node,
          "step(u) jumps where u passes 0, and a Lagrangian must not jump along a motion: u is made of t and "
          "parameters only; max(0, u) has the slope step(u)");
    node.op = function.op;
  }

  /// x(0), x[2](T).
  void end_value(Syntax& node) {
    const std::string name(formula_.name(node));
    const Known* known = names_.find(name);
    const bool index = std::find(indices_.begin(), indices_.end(), name) != indices_.end();
    if (known == nullptr && !index) unknown(node, name);
    if (index || known->meaning != Meaning::coordinate || names_.kind != Kind::condition)
      stop(node, fmt::format("'{}' is {}, not a function; write {}*(…) to multiply", name,
                             kind_of(index ? Meaning::index : known->meaning),
                             index ? name : spelled(name, *known)));
    if (node.velocity)
      stop(node, fmt::format("\"{}'\" is a velocity; conditions hold between coordinates", name));
    if (node.indexed) visit(formula_.children(node)[0].node);
    check_index(node, name, *known);
    const Syntax& when = child(node, node.indexed);
    const bool start = when.form == Form::number && when.value == 0;
    const bool end = when.form == Form::reference && !when.indexed && formula_.name(when) == "T";
    if (node.count != 1u + node.indexed || (!start && !end))
      stop(node, fmt::format("write {0}(0) or {0}(T) for the value at an end", spelled(name, *known)));
    node.meaning = start ? Meaning::start : Meaning::end;
    node.id = known->id;
  }

  [[noreturn]] void unknown(const Syntax& node, const std::string& name) const {
    const bool call = node.form == Form::call;
    if (!call && find_function(name) != nullptr)
      stop(node, fmt::format("'{}' is a function; write {}(…)", name, name));
    std::vector<std::string> known;
    if (!call) known = indices_;
    for (const auto& [other, meaning] : names_.table)
      if (!call || names_.kind == Kind::condition) known.push_back(other);
    for (const Function& function : functions()) known.emplace_back(function.name);
    known.insert(known.end(), {"sum", "pi"});
    const std::string nearest = nearest_name(name, known);
    std::string mend = nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest);
    if (nearest.empty() && !call) mend = "; is it a parameter that is not declared?";
    if (nearest.empty() && call) {
      mend = "; known are sum";
      for (const Function& function : functions()) mend += fmt::format(" {}", function.name);
    }
    if (name == "t") mend = "; the time cannot stand here";
    if (name == "T") mend = "; T is the duration only in a guess, and in x(T) in a condition";
    stop(node, fmt::format("unknown {} '{}'{}", call ? "function" : "name", name.substr(0, 80), mend));
  }

  /// Properties of a node from those of its children.
  void summarise(Syntax& node) const {
    const auto links = formula_.children(node);
    node.numeric = node.meaning != Meaning::coordinate && node.meaning != Meaning::active &&
                   node.meaning != Meaning::time && node.meaning != Meaning::duration &&
                   node.meaning != Meaning::start && node.meaning != Meaning::end;
    node.moving =
        node.meaning == Meaning::coordinate || node.meaning == Meaning::start || node.meaning == Meaning::end;
    bool below = false;
    int summed_factors = 0;
    for (const Link link : links) {
      const Syntax& part = formula_.nodes[link.node];
      node.numeric &= part.numeric;
      node.moving |= part.moving;
      node.depth = std::max(node.depth, part.depth + 1);
      below |= part.additive;
      if (part.additive) summed_factors += link.inverse ? 2 : 1;
    }
    node.additive = node.form == Form::series || (node.form == Form::product && summed_factors == 1) ||
                    ((node.form == Form::negative || node.form == Form::total) && below);
    if (node.meaning == Meaning::definition) {
      const Formula& definition = names_.definitions[node.id];
      const Syntax& root = definition.nodes[definition.root];
      node.numeric = root.numeric;
      node.moving = root.moving;
      node.additive = root.additive;
      node.depth = root.depth + 1;
    }
    node.additive &= !node.numeric;
    if (node.depth > deepest_tree)
      stop(node, fmt::format("nested more than {} deep through definitions", deepest_tree));
  }

  Formula& formula_;
  const Names& names_;
  std::vector<std::string> indices_;
};

/// The definitions that a formula names, each with where it stands.
std::vector<std::pair<int, std::uint32_t>> definitions_in(const Formula& formula, const Names& names) {
  std::vector<std::pair<int, std::uint32_t>> used;
  for (const Syntax& node : formula.nodes) {
    if (node.form != Form::reference) continue;
    const Known* known = names.find(formula.name(node));
    if (known != nullptr && known->meaning == Meaning::definition) used.emplace_back(known->id, node.offset);
  }
  return used;
}

/// A formula on the way down through definitions, with what of it is still to be visited.
struct Visit {
  int definition;  ///< -1: the formula itself
  std::vector<std::pair<int, std::uint32_t>> used;
  std::size_t next = 0;
};

[[noreturn]] void fail_on_cycle(const Names& names, std::span<const Visit> path, int again) {
  const auto name = [&](int definition) {
    return names.definitions[definition].where.substr(std::string_view("definitions.").size());
  };
  const auto begin =
      std::find_if(path.begin(), path.end(), [&](const Visit& v) { return v.definition == again; });
  std::string cycle;
  for (auto it = begin; it != path.end(); ++it) cycle += name(it->definition) + " -> ";
  const Visit& last = path.back();
  fail(names.definitions[last.definition], last.used[last.next - 1].second,
       fmt::format("definitions form a cycle: {}{}", cycle, name(again)));
}

}  // namespace

void resolve(Formula& formula, Names& names) {
  enum State : char { unseen, open, done };
  std::vector<State> state(names.definitions.size(), unseen);
  std::vector<Visit> path{{-1, definitions_in(formula, names)}};
  while (!path.empty()) {
    Visit& visit = path.back();
    if (visit.next < visit.used.size()) {
      const int needed = visit.used[visit.next++].first;
      if (state[needed] == open) fail_on_cycle(names, path, needed);
      if (state[needed] == unseen) {
        state[needed] = open;
        path.push_back({needed, definitions_in(names.definitions[needed], names)});
      }
      continue;
    }
    Formula& complete = visit.definition < 0 ? formula : names.definitions[visit.definition];
    Resolver(complete, names).visit(complete.root);
    if (visit.definition >= 0) state[visit.definition] = done;
    path.pop_back();
  }
}

}  // namespace extremal::formula
