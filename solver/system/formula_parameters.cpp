#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "system/formula.hpp"
#include "system/formula_lexer.hpp"

/// \file Parameters that are formulas of others.

namespace extremal {

namespace {

/// Evaluates parameters by dependence. Definitions are links between them.
class ParameterOrder {
 public:
  ParameterOrder(const std::map<std::string, ParameterEntry>& entries,
                 const std::map<std::string, std::string>& definitions)
      : entries_(entries), known_({}, definitions) {}

  std::map<std::string, ParameterText> values() {
    for (const auto& [name, entry] : entries_) visit(name, {});
    return std::move(known_.parameters);
  }

 private:
  /// A formula on the way down, and where it is written.
  struct Place {
    std::string name, where;
    std::size_t offset;  ///< of the name in the formula before
  };

  void visit(const std::string& name, const Place& from) {
    const auto entry = entries_.find(name);
    const auto definition = known_.definitions.find(name);
    if (entry == entries_.end() && definition == known_.definitions.end()) return;
    if (done_.contains(name)) return;
    if (std::ranges::any_of(path_, [&](const std::string& open) { return open == name; })) cycle(name, from);
    if (path_.size() > deepest)
      throw FormulaError(fmt::format("nested more than {} deep through definitions", deepest), from.where,
                         from.offset);
    path_.push_back(name);
    if (entry != entries_.end())
      evaluate(name, entry->second);
    else
      visit_names(definition->second, "definitions." + name);
    path_.pop_back();
    done_.insert(name);
  }

  void visit_names(const std::string& text, const std::string& where) {
    formula::Lexer lexer(text, where);
    for (formula::Token token = lexer.next(); token.kind != formula::TokenKind::end; token = lexer.next())
      if (token.kind == formula::TokenKind::name)
        visit(std::string(token.text), {std::string(token.text), where, token.offset});
  }

  void evaluate(const std::string& name, const ParameterEntry& entry) {
    ParameterText parameter{{}, entry.list};
    for (const std::variant<double, std::string>& value : entry.values) {
      const std::string where = fmt::format("parameters.{}[{}]", name, parameter.value.size() + 1);
      if (const auto* text = std::get_if<std::string>(&value)) {
        visit_names(*text, where);
        parameter.value.push_back(number(*text, known_, where));
      } else {
        parameter.value.push_back(std::get<double>(value));
      }
    }
    known_.parameters.emplace(name, std::move(parameter));
  }

  [[noreturn]] void cycle(const std::string& again, const Place& from) const {
    std::string names;
    for (auto it = std::ranges::find(path_, again); it != path_.end(); ++it) names += *it + " -> ";
    throw FormulaError(fmt::format("parameters form a cycle: {}{}", names, again), from.where, from.offset);
  }

  static constexpr std::size_t deepest = 500;

  const std::map<std::string, ParameterEntry>& entries_;
  Vocabulary known_;
  std::set<std::string> done_;
  std::vector<std::string> path_;
};

}  // namespace

std::map<std::string, ParameterText> evaluate_parameters(
    const std::map<std::string, ParameterEntry>& entries,
    const std::map<std::string, std::string>& definitions) {
  return ParameterOrder(entries, definitions).values();
}

std::set<std::string> names_in(const std::string& formula) {
  std::set<std::string> names;
  const std::string where;
  formula::Lexer lexer(formula, where);
  try {
    for (formula::Token token = lexer.next(); token.kind != formula::TokenKind::end; token = lexer.next())
      if (token.kind == formula::TokenKind::name) names.emplace(token.text);
  } catch (const FormulaError&) {
  }
  return names;
}

}  // namespace extremal
