#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "system/formula_mend.hpp"
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
  Resolver(Formula& formula, const Names& names, Kind kind, std::vector<std::string> indices)
      : formula_(formula), names_(names), kind_(kind), indices_(std::move(indices)) {}

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
    } else if (name == "T" && kind_ == Kind::guess) {  // a definition may be called so
      node.meaning = Meaning::duration;
    } else if (const Known* known = names_.find(name)) {
      declared(node, name, *known);
      return;
    } else if (name == "pi") {
      node.meaning = Meaning::pi;
    } else if (name == "t" && (in_motion(kind_) || kind_ == Kind::guess)) {
      node.meaning = Meaning::time;
    } else {
      unknown(node, name);
    }
    if (node.indexed) stop(node, fmt::format("'{}' is one number and takes no index", name));
    if (node.velocity)
      stop(node, fmt::format("'{}' has no velocity; only coordinates and definitions have", name));
  }

  void declared(Syntax& node, const std::string& name, const Known& known) const {
    node.meaning = known.meaning;
    node.id = known.id;
    node.momentum = known.momentum;
    if (known.meaning == Meaning::coordinate) {
      if (node.velocity && known.momentum)
        stop(node, fmt::format("'{}' is a momentum and has no velocity", name));
      if (node.velocity && kind_ == Kind::hamiltonian)
        stop(node, fmt::format("\"{0}'\" is a velocity; a hamiltonian has momenta: {1}", name,
                               momentum_of(name, known.array)));
      if (kind_ == Kind::condition)
        stop(node, fmt::format("write {0}(0) or {0}(T): a condition holds between end values",
                               spelled(name, known.array)));
      if (kind_ == Kind::quantity)
        stop(node, fmt::format("write {0}(0) or {0}(T): a quantity of a point is a formula of end values",
                               spelled(name, known.array)));
      if (kind_ == Kind::number || kind_ == Kind::guess)
        stop(node, fmt::format("'{}' is a coordinate; only {}parameters can stand here", name,
                               kind_ == Kind::guess ? "t, T and " : ""));
      if (node.velocity && kind_ == Kind::map)
        stop(node, fmt::format("\"{}'\" is a velocity; a map is made of coordinates", name));
    } else if (known.meaning == Meaning::definition) {
      defined(node, name);
    } else if (node.velocity) {
      stop(node, fmt::format("'{}' is {} and has no velocity; only coordinates and definitions have", name,
                             kind_of(known.meaning)));
    }
    check_index(node, name, known);
  }

  const Syntax& root_of(const Syntax& definition) const {
    const Formula& formula = names_.definitions[definition.id];
    return formula.nodes[formula.root];
  }

  /// Whether a definition may stand in a formula of this kind, by what it is made of.
  void defined(const Syntax& node, const std::string& name) const {
    const std::uint8_t reads = root_of(node).reads;
    if (node.velocity && kind_ == Kind::hamiltonian)
      stop(node, fmt::format("\"{0}'\" is a velocity; a hamiltonian has momenta: {1}", name,
                             momentum_of(names_.coordinates.front().name, names_.coordinates.front().array)));
    if (node.velocity && kind_ != Kind::lagrangian)
      stop(node, fmt::format("\"{}'\" is a velocity; it can stand in the Lagrangian only", name));
    if (node.velocity && (reads & of_velocities))
      stop(node, fmt::format("'{0}' has velocities in it, so \"{0}'\" would need second derivatives", name));
    if (kind_ == Kind::condition && (reads & of_coordinates))
      stop(node, fmt::format("write {0}(0) or {0}(T): a condition holds between end values", name));
    if (kind_ == Kind::quantity && (reads & ~of_time))
      stop(node,
           fmt::format("write {0}(0) or {0}(T): a quantity of a point is a formula of end values", name));
    const std::uint8_t allowed = in_motion(kind_)       ? 0xff
                                 : kind_ == Kind::map   ? of_coordinates
                                 : kind_ == Kind::guess ? of_time
                                                        : 0;
    if (reads & ~allowed)
      stop(node, fmt::format("the definition '{}' depends on {}, which cannot stand here", name,
                             reads & ~allowed & of_coordinates  ? "coordinates"
                             : reads & ~allowed & of_velocities ? "velocities"
                                                                : "t"));
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
    if (function.op == Op::step && (child(node, 0).reads & (of_coordinates | of_velocities | of_ends)))
      stop(
          node,
          "step(u) jumps where u passes 0, and a Lagrangian must not jump along a motion: u is made of t and "
          "parameters only; max(0, u) has the slope step(u)");
    node.op = function.op;
  }

  /// x(0), x[2](T), and of a definition made of coordinates.
  void end_value(Syntax& node) {
    const std::string name(formula_.name(node));
    const Known* known = names_.find(name);
    const bool index = std::find(indices_.begin(), indices_.end(), name) != indices_.end();
    if (known == nullptr && !index) unknown(node, name);
    const bool ends = kind_ == Kind::condition || kind_ == Kind::quantity;
    const bool definition = known != nullptr && known->meaning == Meaning::definition;
    const Syntax& argument = child(node, node.indexed);
    if (!index && !ends && argument.form == Form::reference && formula_.name(argument) == "t")
      stop(node,
           fmt::format("write {0}{1} for {0}{1}(t)", spelled(name, known->array), node.velocity ? "'" : ""));
    if (index || (known->meaning != Meaning::coordinate && !definition) || !ends)
      stop(node, fmt::format("'{}' is {}, not a function; write {}*(…) to multiply", name,
                             kind_of(index ? Meaning::index : known->meaning),
                             index ? name : spelled(name, known->array)));
    if (node.velocity && kind_ == Kind::condition)
      stop(node,
           fmt::format("\"{0}'\" is a velocity; conditions hold between coordinates; a momentum is given in "
                       "'start' or 'end': start = {{ p_{0} = … }}",
                       name));
    if (node.indexed) visit(formula_.children(node)[0].node);
    check_index(node, name, *known);
    const Syntax& when = argument;
    const bool start = when.form == Form::number && when.value == 0;
    const bool end = when.form == Form::reference && !when.indexed && formula_.name(when) == "T";
    if (node.count != 1u + node.indexed || (!start && !end))
      stop(node, fmt::format("write {0}(0) or {0}(T) for the value at an end", spelled(name, known->array)));
    node.id = known->id;
    node.meaning = definition ? (start ? Meaning::definition_start : Meaning::definition_end)
                              : (start ? Meaning::start : Meaning::end);
    if (definition && kind_ == Kind::quantity && node.velocity)
      stop(node, fmt::format("\"{}'\" is the velocity of a definition; only those of coordinates stand here",
                             name));
    const std::uint8_t allowed = kind_ == Kind::quantity ? of_coordinates | of_velocities : of_coordinates;
    if (definition && root_of(node).reads & ~allowed)
      stop(node, fmt::format("the definition '{}' depends on {}; conditions hold between coordinates", name,
                             root_of(node).reads & of_velocities ? "velocities" : "t"));
  }

  [[noreturn]] void unknown(const Syntax& node, const std::string& name) const {
    const bool call = node.form == Form::call;
    if (!call && find_function(name) != nullptr)
      stop(node, fmt::format("'{}' is a function; write {}(…)", name, name));
    stop(node, fmt::format("unknown {} '{}'{}", call ? "function" : "name", name.substr(0, 80),
                           mend_of_unknown(name, call, names_, kind_, indices_)));
  }

  /// Properties of a node from those of its children.
  void summarise(Syntax& node) const {
    const auto links = formula_.children(node);
    node.reads = read_by(node);
    bool below = false;
    int summed_factors = 0;
    for (const Link link : links) {
      const Syntax& part = formula_.nodes[link.node];
      node.reads |= part.reads;
      node.depth = std::max(node.depth, part.depth + 1);
      below |= part.additive;
      if (part.additive) summed_factors += link.inverse ? 2 : 1;
    }
    node.additive = node.form == Form::series || (node.form == Form::product && summed_factors == 1) ||
                    ((node.form == Form::negative || node.form == Form::total) && below);
    if (is_definition(node)) {
      const Syntax& root = root_of(node);
      node.additive = root.additive && node.meaning == Meaning::definition && !node.velocity;
      node.depth = root.depth + 1;
    }
    node.numeric = node.reads == 0;
    node.additive &= !node.numeric;
    if (node.depth > deepest_tree)
      stop(node, fmt::format("nested more than {} deep through definitions", deepest_tree));
  }

  static bool is_definition(const Syntax& node) {
    return node.meaning == Meaning::definition || node.meaning == Meaning::definition_start ||
           node.meaning == Meaning::definition_end;
  }

  /// What a node reads itself, its children aside.
  std::uint8_t read_by(const Syntax& node) const {
    switch (node.meaning) {
      case Meaning::coordinate:
        return node.velocity || node.momentum ? of_velocities : of_coordinates;
      case Meaning::time:
        return of_time;
      case Meaning::active:
      case Meaning::duration:
        return of_others;
      case Meaning::start:
      case Meaning::end:
        return of_ends;
      case Meaning::definition: {  // the velocity of one reads the coordinates and their velocities
        const std::uint8_t reads = root_of(node).reads;
        return node.velocity && (reads & of_coordinates) ? reads | of_velocities : reads;
      }
      case Meaning::definition_start:
      case Meaning::definition_end:
        return root_of(node).reads == 0 ? 0 : of_ends;
      default:
        return 0;
    }
  }

  Formula& formula_;
  const Names& names_;
  const Kind kind_;
  std::vector<std::string> indices_;
};

/// The definitions that a formula names, each with where it stands.
std::vector<std::pair<int, std::uint32_t>> definitions_in(const Formula& formula, const Names& names) {
  std::vector<std::pair<int, std::uint32_t>> used;
  for (const Syntax& node : formula.nodes) {
    if (node.form != Form::reference && node.form != Form::call) continue;
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

/// Parses the definitions that `used` needs, and calls ready(id) for each after those that it needs itself;
/// at last ready(-1).
template <class Ready>
void visit_definitions(Names& names, std::vector<std::pair<int, std::uint32_t>> used, const Ready& ready) {
  enum State : char { unseen, open, done };
  std::vector<State> state(names.definitions.size(), unseen);
  std::vector<Visit> path{{-1, std::move(used)}};
  while (!path.empty()) {
    Visit& visit = path.back();
    if (visit.next < visit.used.size()) {
      const int needed = visit.used[visit.next++].first;
      if (state[needed] == open) fail_on_cycle(names, path, needed);
      if (state[needed] == unseen) {
        state[needed] = open;
        Formula& definition = names.definitions[needed];
        if (definition.nodes.empty()) definition = parse(definition.text, definition.where);
        path.push_back({needed, definitions_in(names.definitions[needed], names)});
      }
      continue;
    }
    ready(visit.definition);
    if (visit.definition >= 0) state[visit.definition] = done;
    path.pop_back();
  }
}

}  // namespace

void resolve(Formula& formula, Names& names) {
  visit_definitions(names, definitions_in(formula, names), [&](int definition) {
    if (definition < 0)
      Resolver(formula, names, names.kind, names.indices).visit(formula.root);
    else if (Formula& needed = names.definitions[definition]; true)
      Resolver(needed, names, names.of_definitions(), {}).visit(needed.root);
  });
}

void parse_definitions(Names& names) {
  std::vector<std::pair<int, std::uint32_t>> all;
  for (std::size_t k = 0; k < names.definitions.size(); ++k) all.emplace_back(static_cast<int>(k), 0);
  visit_definitions(names, std::move(all), [](int) {});
}

std::vector<double> resolve_at(Formula& formula, Names& names, int index) {
  if (index > 0) names.indices = {"i"};
  resolve(formula, names);
  if (index == 0) return {};
  if (const Known* known = names.find("i"))
    for (const Syntax& node : formula.nodes)
      if (node.meaning == Meaning::index && formula.name(node) == "i")
        fail(formula, node.offset,
             fmt::format("'i' is the index of the element and {}; rename that one", kind_of(known->meaning)));
  return {static_cast<double>(index)};
}

}  // namespace extremal::formula
