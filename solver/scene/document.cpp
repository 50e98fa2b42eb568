#include "scene/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <tuple>
#include <utility>

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

/// What the parser says, but for a string without its closing quote, where it blames the end of the line, for
/// velocities as keys, and for its limits, which it gives by the names of its macros.
std::string readable(std::string_view description) {
  const auto has = [&](const char* part) { return description.find(part) != std::string_view::npos; };
  if (has("unescaped control characters"))
    return "this string is not closed on its line, or contains a control character";
  if (has("expected '=', saw '''"))
    return "a key with a prime, as a velocity has, is written in quotes: \"x'\" = …";
  if (has("TOML_MAX_NESTED_VALUES"))
    return fmt::format("lists and tables stand more than {} deep in each other", TOML_MAX_NESTED_VALUES);
  return std::string(description);
}

bool is_value(const std::string& text) {
  try {
    static_cast<void>(toml::parse("x = " + text));
    return true;
  } catch (const toml::parse_error&) {
    return false;
  }
}

/// The line of a place, without its end; empty where there is none.
std::string_view line_at(const Location& at) {
  if (!at.source || at.line < 1) return {};
  std::string_view text = at.source->text;
  for (int line = 1; line < at.line; ++line) {
    const auto end = text.find('\n');
    if (end == text.npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// The value at an error of the parser that is a text or a formula without quotes, and where it begins; empty
/// if it is none.
std::pair<std::string, Location> unquoted(const Location& at) {
  const std::string_view text = line_at(at);
  // Columns count characters; before the value there are hardly others than ASCII.
  std::size_t begin = std::min<std::size_t>(std::max(at.column - 1, 0), text.size());
  while (begin > 0 && !std::strchr("=,[", text[begin - 1])) --begin;
  begin = text.find_first_not_of(" \t", begin);
  if (begin == text.npos || std::strchr("\"'[{#,]}", text[begin])) return {};
  std::size_t end = begin;
  for (int depth = 0; end < text.size() && text[end] != '#'; ++end) {
    depth += (text[end] == '(') - (text[end] == ')');
    if (depth <= 0 && std::strchr(",]}", text[end])) break;
  }
  while (end > begin && std::strchr(" \t", text[end - 1])) --end;
  std::string value(text.substr(begin, end - begin));
  if (value.find('"') == value.size() - 1) value.pop_back();  // the quote at its beginning is missing
  if (value.find_first_of("=\"") != value.npos || is_value(value)) return {};
  return {value, {at.source, at.line, static_cast<int>(begin) + 1}};
}

[[noreturn]] void refuse_text(const Location& at, std::string_view description) {
  if (const auto [value, begin] = unquoted(at); !value.empty()) {
    double number = 0;
    const auto [after, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error == std::errc::result_out_of_range)
      throw SceneError(
          begin, fmt::format("{} is out of the range of numbers, whose size is 2.3e-308 to 1.8e308", value));
    const auto blank = value.find(' ');
    const bool first = line_at(begin).find_first_not_of(" \t") + 1 == static_cast<std::size_t>(begin.column);
    if (first && blank != value.npos && is_value(value.substr(blank)))
      throw SceneError(begin, fmt::format("'=' is missing between a key and its value; write {} = {}",
                                          value.substr(0, blank), value.substr(blank + 1)));
    throw SceneError(begin, fmt::format("texts and formulas are written in quotes: \"{}\"", value));
  }
  throw SceneError(at, readable(description));
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

/// Where "q[2]", or "q[2]'" of the velocities "q'", names an element of a list, the list and the number.
std::pair<toml::array*, std::size_t> element_named(toml::table& table, std::string_view key) {
  const auto open = key.find('['), close = key.find(']');
  if (close == key.npos || open >= close || table.contains(key)) return {};
  std::size_t number = 0;
  const char *begin = key.data() + open + 1, *end = key.data() + close;
  if (const auto [stop, error] = std::from_chars(begin, end, number); error != std::errc() || stop != end)
    return {};
  const std::string list = std::string(key.substr(0, open)) + std::string(key.substr(close + 1));
  return {table[list].as_array(), number};
}

void set_element(toml::array& list, std::size_t number, toml::node&& value, const std::string& key,
                 const Location& at) {
  if (number < 1 || number > list.size())
    throw SceneError(at,
                     fmt::format("'{}' is out of range: the list has elements 1 to {}", key, list.size()));
  const auto place = list.erase(list.begin() + static_cast<std::ptrdiff_t>(number) - 1);
  list.insert(place, std::move(value));
}

void merge(const Document& document, toml::table& into, toml::table&& from) {
  for (auto&& [key, value] : from) {
    if (const auto [list, number] = element_named(into, key.str()); list && !value.is_table()) {
      set_element(*list, number, std::move(value), std::string(key.str()), document.at(value));
      continue;
    }
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
    refuse_text(document.at(e.source()), e.description());
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
