#include "system/formula_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <numbers>
#include <utility>

#include "system/expression_evaluate.hpp"

namespace extremal {

namespace formula {

namespace {

constexpr std::size_t most_work = 300'000'000;  ///< operations, a few seconds
constexpr double largest_integer = 1e15;

/// " (at i = 3, j = 4)" for the indices that stand below a node.
std::string circumstances(const Formula& formula, const Syntax& node, std::span<const double> indices) {
  std::vector<bool> named(indices.size());
  std::string text;
  std::vector<Link> open(formula.children(node).begin(), formula.children(node).end());
  if (node.meaning == Meaning::index) text = fmt::format("{} = {}", formula.name(node), indices[node.id]);
  while (!open.empty()) {
    const Syntax& part = formula.nodes[open.back().node];
    open.pop_back();
    for (const Link link : formula.children(part)) open.push_back(link);
    if (part.meaning != Meaning::index || part.id >= static_cast<int>(indices.size()) || named[part.id])
      continue;
    named[part.id] = true;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", formula.name(part), indices[part.id]);
  }
  return text.empty() ? text : " (at " + text + ")";
}

}  // namespace

void Evaluator::set_time(double time) {
  time_ = time;
  std::fill(definitions_.begin(), definitions_.end(), Cached{});
}

void Evaluator::spend(const Formula& formula, const Syntax& node, std::size_t amount) {
  work_ += amount;
  if (work_ > most_work)
    fail(formula, node.offset,
         fmt::format("the sums take more than {} operations; make them shorter", most_work));
}

double Evaluator::value(const Formula& formula, std::uint32_t id, std::vector<double>& indices) {
  const Syntax& node = formula.nodes[id];
  const auto links = formula.children(node);
  const auto part = [&](std::size_t k) { return value(formula, links[k].node, indices); };
  spend(formula, node, 1);
  switch (node.form) {
    case Form::number:
      return node.value;
    case Form::reference:
      return reference(formula, node, indices);
    case Form::series:
      return series(formula, node, indices);
    case Form::negative:
      return -part(0);
    case Form::power:
      return std::pow(part(0), part(1));
    case Form::call: {
      if (node.meaning != Meaning::none) return reference(formula, node, indices);  // at an end
      const double first = part(0);
      return scalar::apply(node.op, first, links.size() > 1 ? part(1) : 0.0);
    }
    case Form::total: {
      double sum = 0;
      for (std::size_t k = 0; k < links.size(); ++k) sum += links[k].inverse ? -part(k) : part(k);
      return sum;
    }
    case Form::product: {
      double product = part(0);
      for (std::size_t k = 1; k < links.size(); ++k) {
        const double factor = part(k);
        product = links[k].inverse ? product / factor : product * factor;
      }
      return product;
    }
  }
  return 0;
}

double Evaluator::reference(const Formula& formula, const Syntax& node, std::vector<double>& indices) {
  switch (node.meaning) {
    case Meaning::index:
      return indices[node.id];
    case Meaning::pi:
      return std::numbers::pi;
    case Meaning::time:
      return time_;
    case Meaning::duration:
      return duration;
    case Meaning::parameter: {
      const Parameter& list = *names_.parameters[node.id];
      return list[node.indexed ? element(formula, node, static_cast<int>(list.size()), indices) : 0];
    }
    case Meaning::coordinate:
    case Meaning::start:
    case Meaning::end:
      return end_value(formula, node, indices);
    case Meaning::definition:
    case Meaning::definition_start:
    case Meaning::definition_end: {
      if (names_.kind == Kind::quantity) return end_definition(node);
      if (node.velocity) return 0;  // of a number
      Cached& cached = definitions_[node.id];
      if (!cached.known) {
        const Formula& definition = names_.definitions[node.id];
        std::vector<double> none;
        cached = {true, value(definition, definition.root, none)};
      }
      return cached.value;
    }
    default:
      fail(formula, node.offset,
           fmt::format("'{}' is not a number when the formula is read", formula.name(node)));
  }
}

double Evaluator::series(const Formula& formula, const Syntax& node, std::vector<double>& indices) {
  const auto links = formula.children(node);
  const long from = integer(formula, links[0].node, indices, "the lower bound of a sum");
  const long to = integer(formula, links[1].node, indices, "the upper bound of a sum");
  double sum = 0;
  indices.push_back(0);
  for (long i = from; i <= to; ++i) {
    indices.back() = static_cast<double>(i);
    sum += value(formula, links[2].node, indices);
  }
  indices.pop_back();
  return sum;
}

/// A coordinate within a definition is that of the end at which the definition is read.
double Evaluator::end_value(const Formula& formula, const Syntax& node, std::vector<double>& indices) {
  const Coordinate& declared = names_.coordinates[node.id];
  const bool last = node.meaning == Meaning::coordinate ? at_end_ : node.meaning == Meaning::end;
  const std::span<const double> values =
      last ? (node.velocity ? ends.v_end : ends.q_end) : (node.velocity ? ends.v_start : ends.q_start);
  return values[declared.first + (node.indexed ? element(formula, node, declared.count, indices) : 0)];
}

double Evaluator::end_definition(const Syntax& node) {
  const bool before = at_end_;
  if (node.meaning != Meaning::definition) at_end_ = node.meaning == Meaning::definition_end;
  const Formula& definition = names_.definitions[node.id];
  std::vector<double> none;
  const double result = value(definition, definition.root, none);
  at_end_ = before;
  return result;
}

double Evaluator::finite(const Formula& formula, std::uint32_t node, std::vector<double>& indices) {
  const double result = value(formula, node, indices);
  const Syntax& syntax = formula.nodes[node];
  if (!std::isfinite(result))
    fail(formula, syntax.offset,
         fmt::format("the value is not finite{}", circumstances(formula, syntax, indices)));
  return result;
}

/// Whether the value is one of integer arithmetic, by the form of the formula.
bool Evaluator::whole(const Formula& formula, std::uint32_t id) {
  const Syntax& node = formula.nodes[id];
  const auto parts = [&](bool inverse) {
    return std::ranges::all_of(formula.children(node), [&](Link link) {
      return (inverse || !link.inverse) && whole(formula, link.node);
    });
  };
  switch (node.form) {
    case Form::number:
      return node.value == std::floor(node.value);
    case Form::reference:
      return node.meaning == Meaning::index;
    case Form::negative:
    case Form::total:
      return parts(true);
    case Form::product:
      return parts(false);
    default:
      return false;
  }
}

/// Without rounding: i + 1e-300 is i in floating-point numbers only.
double Evaluator::exact(const Formula& formula, std::uint32_t id, std::vector<double>& indices) {
  if (whole(formula, id)) return value(formula, id, indices);
  std::feclearexcept(FE_INEXACT);
  const double result = value(formula, id, indices);
  if (result == std::floor(result) && std::fetestexcept(FE_INEXACT)) {
    const Syntax& node = formula.nodes[id];
    fail(formula, node.offset,
         fmt::format("{} is an integer only by rounding{}; write it in integers", result,
                     circumstances(formula, node, indices)));
  }
  return result;
}

long Evaluator::integer(const Formula& formula, std::uint32_t node, std::vector<double>& indices,
                        std::string_view what) {
  const double result = exact(formula, node, indices);
  const Syntax& syntax = formula.nodes[node];
  if (!std::isfinite(result))
    fail(formula, syntax.offset,
         fmt::format("{} is not finite{}", what, circumstances(formula, syntax, indices)));
  if (result != std::floor(result) || !(std::abs(result) <= largest_integer))
    fail(formula, syntax.offset,
         fmt::format("{} is {}, not an integer{}", what, result, circumstances(formula, syntax, indices)));
  return static_cast<long>(result);
}

int Evaluator::element(const Formula& formula, const Syntax& node, int count, std::vector<double>& indices) {
  const std::uint32_t child = formula.children(node)[0].node;
  const std::string_view name = formula.name(node);
  const double result = exact(formula, child, indices);
  if (result >= 1 && result <= count && result == std::floor(result)) return static_cast<int>(result) - 1;
  const long index = integer(formula, child, indices, fmt::format("the index of '{}'", name));
  fail(formula, node.offset,
       fmt::format("{0}[{1}] is out of range: '{0}' has {2} elements, counted from 1{3}", name, index, count,
                   circumstances(formula, node, indices)));
}

}  // namespace formula

double number(const std::string& text, const Vocabulary& vocabulary, const std::string& where, int index) {
  using namespace formula;
  Names names = names_of(Kind::number, vocabulary);
  Formula formula = parse(text, where);
  std::vector<double> indices = resolve_at(formula, names, index);
  return Evaluator(names).finite(formula, formula.root, indices);
}

EndQuantity end_quantity(const std::string& text, const System& system,
                         const std::map<std::string, double>& further, const std::string& where) {
  using namespace formula;
  // What formula and names refer to lives as long as the quantity.
  struct Read {
    Vocabulary vocabulary;
    Names names;
    Formula formula;
  };
  const auto read = std::make_shared<Read>(Read{system, {}, parse(text, where)});
  for (const auto& [name, value] : further)
    if (!system.definitions.contains(name))
      read->vocabulary.parameters.try_emplace(name, ParameterText{{value}, false});
  read->names = names_of(Kind::quantity, read->vocabulary);
  resolve(read->formula, read->names);
  return [read](const EndValues& ends, const std::map<std::string, double>& values) {
    for (const auto& [name, value] : values)
      if (const auto known = read->vocabulary.parameters.find(name);
          known != read->vocabulary.parameters.end())
        known->second.value.front() = value;
    Evaluator evaluator(read->names);
    evaluator.ends = ends;
    std::vector<double> indices;
    return evaluator.value(read->formula, read->formula.root, indices);
  };
}

std::vector<double> tabulate(const std::string& text, const Vocabulary& vocabulary, double duration,
                             std::span<const double> times, int index, const std::string& where) {
  using namespace formula;
  Names names = names_of(Kind::guess, vocabulary);
  Formula formula = parse(text, where);
  std::vector<double> indices = resolve_at(formula, names, index);
  Evaluator evaluator(names);
  evaluator.duration = duration;
  std::vector<double> values;
  for (const double time : times) {
    evaluator.set_time(time);
    const double value = evaluator.value(formula, formula.root, indices);
    if (!std::isfinite(value)) fail(formula, 0, fmt::format("the guess is not finite at t = {}", time));
    values.push_back(value);
  }
  return values;
}

}  // namespace extremal
