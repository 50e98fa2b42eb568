#include "scene/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

namespace extremal {
namespace {

/// s as a basic string of TOML.
std::string quoted(std::string_view s) {
  std::string out(1, '"');
  for (const char c : s) {
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  out += '"';
  return out;
}

/// What the parser says, but for a string without its closing quote, where it blames the end of the line, and
/// for its limits, which it gives by the names of its macros.
std::string readable(std::string_view description) {
  const auto has = [&](const char* part) { return description.find(part) != std::string_view::npos; };
  if (has("unescaped control characters"))
    return "this string is not closed on its line, or contains a control character";
  if (has("TOML_MAX_NESTED_VALUES"))
    return fmt::format("lists and tables stand more than {} deep in each other", TOML_MAX_NESTED_VALUES);
  return std::string(description);
}

struct Setting {
  std::vector<std::string> key;
  std::string value;
};

/// Splits "a.b.'c.d'=value" at the dots and the first equals sign outside quotes; an apostrophe within a part
/// belongs to it (a velocity).
Setting split(const std::string& argument, const Location& at) {
  Setting setting{{""}, ""};
  char quote = 0;
  std::size_t k = 0;
  for (; k < argument.size() && (quote || argument[k] != '='); ++k) {
    const char c = argument[k];
    std::string& part = setting.key.back();
    if (quote ? c == quote : c == '"' || (c == '\'' && part.empty()))
      quote = quote ? 0 : c;
    else if (c == '.' && !quote)
      setting.key.emplace_back();
    else
      part += c;
  }
  if (k == argument.size()) throw SceneError(at, "no '='; write key=value");
  for (const std::string& part : setting.key)
    if (part.empty()) throw SceneError(at, "the key has an empty part; write table.key=value");
  setting.value = argument.substr(k + 1);
  return setting;
}

/// The value under its key as a document of its own, all nodes of which know the source.
toml::table parse_setting(const Setting& setting, const std::shared_ptr<Source>& source) {
  std::vector<std::string> parts;
  for (const std::string& part : setting.key) parts.push_back(quoted(part));
  const std::string key = fmt::format("{}", fmt::join(parts, "."));
  const auto parse = [&](const std::string& value) {
    source->text = key + " = " + value;
    check_key_depth(source);
    return toml::parse(source->text, source->name);
  };
  try {
    toml::table table = parse(setting.value);
    if (table.size() == 1 && setting.value.find('\n') == std::string::npos) return table;
  } catch (const toml::parse_error&) {  // not TOML: a string
  }
  try {
    return parse(quoted(setting.value));
  } catch (const toml::parse_error& e) {
    throw SceneError({source, 0, 0}, readable(e.description()));
  }
}

void merge(const Document& document, toml::table& into, toml::table&& from) {
  for (auto&& [key, value] : from) {
    toml::node* old = into.get(key);
    if (!value.is_table() || value.as_table()->is_inline() || !old) {
      into.insert_or_assign(key, std::move(value));
      continue;
    }
    if (!old->is_table())
      throw SceneError(document.at(value), fmt::format("'{}' is not a table", std::string_view(key)));
    merge(document, *old->as_table(), std::move(*value.as_table()));
  }
}

}  // namespace

Location Document::at(const toml::source_region& region) const {
  if (!region.path) return {};
  const auto found = sources.find(*region.path);
  if (found == sources.end()) return {};
  return {found->second, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

bool precedes(const Location& a, const Location& b) {
  const auto place = [](const Location& l) {
    return std::tuple(l.source && !l.source->numbered, l.line, l.column);
  };
  return place(a) < place(b);
}

Document parse_document(const std::shared_ptr<const Source>& source) {
  check_key_depth(source);
  Document document;
  document.sources.emplace(source->name, source);
  try {
    document.root = toml::parse(source->text, source->name);
  } catch (const toml::parse_error& e) {
    throw SceneError(document.at(e.source()), readable(e.description()));
  }
  return document;
}

void set_value(Document& document, const std::string& argument) {
  auto source = std::make_shared<Source>();
  source->numbered = false;
  source->name = "--set " + argument.substr(0, argument.find('='));
  const Setting setting = split(argument, {source, 0, 0});
  document.sources.insert_or_assign(source->name, source);
  merge(document, document.root, parse_setting(setting, source));
}

std::vector<Entry> Document::entries(const toml::table& table) const {
  std::vector<std::pair<Location, Entry>> list;
  for (auto&& [key, value] : table) list.push_back({at(key.source()), {&key, &value}});
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return precedes(a.first, b.first); });
  std::vector<Entry> sorted;
  for (const auto& [location, entry] : list) sorted.push_back(entry);
  return sorted;
}

}  // namespace extremal
