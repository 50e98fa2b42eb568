#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/document.hpp"
#include "scene/schema.hpp"

namespace extremal {
namespace {

const char* type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

/// The kind of the elements of a list of this kind, where a list is allowed.
bool list_elements(Kind kind, Kind& element) {
  switch (kind) {
    case Kind::texts:
    case Kind::note:
      element = Kind::text;
      return true;
    case Kind::quantities:
      element = Kind::quantity;
      return true;
    default:
      return false;
  }
}

bool single(Kind kind, const toml::node& node) {
  switch (kind) {
    case Kind::text:
    case Kind::note:
      return node.is_string();
    case Kind::number:
      return node.is_number();
    case Kind::integer:
      return node.is_integer();
    case Kind::boolean:
      return node.is_boolean();
    case Kind::quantity:
    case Kind::quantities:
      return node.is_number() || node.is_string();
    case Kind::texts:
      return false;
    case Kind::table:
      return node.is_table();
    case Kind::tables:
      return node.is_array_of_tables();
  }
  return false;
}

/// What a key is called elsewhere.
struct OtherWord {
  std::string_view table, word, key;
};

constexpr OtherWord other_words[] = {
    {"system", "L", "lagrangian"},
    {"system", "H", "hamiltonian"},
    {"system", "coords", "coordinates"},
    {"system", "params", "parameters"},
    {"system", "forces", "force"},
    {"boundary", "T", "duration"},
    {"boundary", "time", "duration"},
    {"boundary", "period", "duration"},
    {"boundary", "initial", "start"},
    {"boundary", "begin", "start"},
    {"boundary", "final", "end"},
    {"boundary", "finish", "end"},
    {"boundary", "stop", "end"},
    {"solve", "n", "elements"},
    {"solve", "N", "elements"},
    {"solve", "timeout", "budget"},
    {"solve", "time", "budget"},
    {"search", "n", "solutions"},
    {"search", "count", "solutions"},
    {"search", "number", "solutions"},
    {"continuation", "end", "to"},
    {"continuation", "until", "to"},
    {"continuation", "steps", "points"},
    {"continuation", "n", "points"},
    {"fit", "file", "data"},
    {"fit", "params", "parameters"},
};

/// For a table or a list, of which a file has another value.
std::string as_in(const KeyRecord& record) {
  return record.example.empty() ? "" : fmt::format("; write it as in {}", record.example);
}

struct Checker {
  const Document& document;

  [[noreturn]] void refuse(const toml::node& node, const std::string& message) const {
    throw SceneError(document.at(node), message);
  }

  /// An infinite number may be meant for one of the choices.
  void check_finite(const toml::node& node, const std::string& label,
                    std::vector<std::string> choices = {}) const {
    const auto number = node.value<double>();
    if (node.is_floating_point() && !std::isfinite(*number))
      throw UnknownName(document.at(node), fmt::format("{} must be finite, found {}", label, *number),
                        fmt::format("{}", *number), std::move(choices));
  }

  void check_choice(const toml::node& node, std::string_view key, std::vector<std::string> choices) const {
    const Text text{*node.value<std::string>(), document.at(node)};
    if (std::ranges::find(choices, text.value) == choices.end())
      throw UnknownChoice(position(text, 0), fmt::format("unknown {} '{}'", key, text.value), text.value,
                          std::move(choices));
  }

  void check_value(const toml::node& node, Kind kind, const std::string& label,
                   const std::vector<std::string>& choices = {}) const {
    Kind element;
    if (node.is_array() && list_elements(kind, element)) {
      int k = 0;
      for (const toml::node& item : *node.as_array()) {
        ++k;
        if (!single(element, item))
          refuse(item, fmt::format("element {} of {} must be {}, found {}", k, label, description(element),
                                   type_name(item)));
        check_finite(item, fmt::format("element {} of {}", k, label));
      }
      return;
    }
    if (!single(kind, node))
      refuse(node, fmt::format("{} must be {}, found {}", label, description(kind), type_name(node)));
    check_finite(node, label, choices);
  }

  /// A key outside every table may belong to one of them, or be a parameter.
  [[noreturn]] void refuse_key(const Location& at, const std::string& key, std::string_view table,
                               const std::string& within) const {
    std::vector<std::string> known = keys_of(table);
    std::string message = fmt::format("unknown key '{}'{}", key, within);
    const auto suggest = [&](const std::string& meant) {
      throw SceneError(at, fmt::format("{}; did you mean '{}'?", message, meant));
    };
    for (const std::string& other : table.empty() ? known : std::vector<std::string>{})
      if (const KeyRecord* record = find_key(other, key); record && record->key == key)
        suggest(fmt::format("{}.{}", other, key));
    if (table.empty() && document.root["system"]["parameters"][key]) suggest("system.parameters." + key);
    for (const OtherWord& word : other_words)
      if (word.table == table && word.word == key) suggest(std::string(word.key));
    throw UnknownChoice(at, message, key, std::move(known));
  }

  void check_table(const toml::table& table, std::string_view name) const {
    const bool top = name.empty() || name == "system file";
    const std::string within = top ? "" : fmt::format(" in [{}]", name);
    for (const auto& [key, value] : document.entries(table)) {
      const KeyRecord* record = find_key(name, key->str());
      if (!record) refuse_key(document.at(key->source()), std::string(key->str()), name, within);
      const std::string label = top && record->kind == Kind::table
                                    ? fmt::format("[{}]", key->str())
                                    : fmt::format("'{}'{}", key->str(), within);
      const bool has_keys = record->by_name || record->kind == Kind::table;
      if (has_keys && !value->is_table())
        refuse(*value,
               fmt::format("{} must be a table, found {}{}", label, type_name(*value), as_in(*record)));
      if (record->kind == Kind::table)
        check_table(*value->as_table(), key->str());
      else if (record->kind == Kind::tables)
        check_tables(*value, key->str(), label);
      else if (record->by_name)
        check_named(*value->as_table(), record->kind,
                    top ? std::string(key->str()) : fmt::format("{}.{}", name, key->str()));
      else
        check_one(*value, *record, label);
    }
  }

  void check_one(const toml::node& node, const KeyRecord& record, const std::string& label) const {
    const std::vector<std::string> choices(record.choices.begin(), record.choices.end());
    if (record.kind == Kind::texts && !node.is_array())
      refuse(node, fmt::format("{} must be {}, found {}{}", label, description(record.kind), type_name(node),
                               as_in(record)));
    check_value(node, record.kind, label, choices);
    if (record.kind == Kind::text && !choices.empty()) check_choice(node, record.key, choices);
  }

  void check_tables(const toml::node& node, std::string_view name, const std::string& label) const {
    if (!single(Kind::tables, node))
      refuse(node, fmt::format("{} must be a list of tables, found {}; write [[{}]]", label, type_name(node),
                               name));
    for (const toml::node& item : *node.as_array()) check_table(*item.as_table(), name);
  }

  void check_named(const toml::table& table, Kind kind, const std::string& name) const {
    for (const auto& [key, value] : document.entries(table))
      check_value(*value, kind, fmt::format("'{}' in [{}]", key->str(), name));
  }
};

/// The key "table.key" where it is set ("guess.*": the first of the user's names); null where it is not, and
/// for a boolean that is false.
const toml::key* find_set(const Document& document, std::string_view path) {
  const auto dot = path.find('.');
  const std::string_view name = path.substr(0, dot), wanted = path.substr(dot + 1);
  const toml::table* table = document.root[name].as_table();
  if (!table) return nullptr;
  for (const auto& [key, value] : document.entries(*table)) {
    const bool named = wanted == "*" ? find_key(name, key->str())->key == "*" : key->str() == wanted;
    if (named && value->value_exact<bool>() != false) return key;
  }
  return nullptr;
}

}  // namespace

void check_keys(const Document& document, const toml::table& table, std::string_view name) {
  Checker{document}.check_table(table, name);
}

void check_relations(const Document& document) {
  for (const Exclusion& e : exclusions()) {
    const toml::key *a = find_set(document, e.a), *b = find_set(document, e.b);
    if (!a || !b || (!e.unless.empty() && find_set(document, e.unless))) continue;
    if (precedes(document.at(a->source()), document.at(b->source()))) std::swap(a, b);
    throw SceneError(document.at(a->source()),
                     fmt::format("'{}' and '{}' exclude each other: {}", a->str(), b->str(), e.why));
  }
  for (const Requirement& r : requirements()) {
    const toml::key* key = find_set(document, r.key);
    if (key && !find_set(document, r.needed))
      throw SceneError(
          document.at(key->source()),
          fmt::format("'{}' needs '{}': {}", key->str(), r.needed.substr(r.needed.find('.') + 1), r.why));
  }
}

}  // namespace extremal
