#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// \file The keys of scenes and system files, as records: reading, checking and suggestions go by them.

namespace extremal {

/// What a value may be.
enum class Kind {
  text,    ///< a string
  number,  ///< finite
  integer,
  boolean,
  quantity,    ///< a number or a formula
  texts,       ///< a list of strings
  quantities,  ///< a quantity or a list of them
  note,        ///< a string or a list of strings
  table,       ///< with keys of its own in the schema
  tables,      ///< a list of such tables
};

/// "a number or a formula", as a message says what was expected.
const char* description(Kind kind);

/// One key. `table` is "" for the top of a scene, "system file" for that of a system file; the key "*" stands
/// for any name (a coordinate). The tables of problems/README.md are made from these records.
struct KeyRecord {
  std::string_view table, key;
  Kind kind;
  std::string_view fallback = {};  ///< the value where the key is left out, or "none", "required"
  std::string_view meaning = {};
  std::string_view example = {};  ///< as TOML within its table
  bool by_name = false;           ///< a table of such values, under names of the user's
  std::span<const std::string_view> choices =
      {};  ///< the texts that there are; of a quantity, beside formulas
};

/// All keys, table by table.
std::span<const KeyRecord> key_records();

/// The record of a key, or of "*", or null.
const KeyRecord* find_key(std::string_view table, std::string_view key);

/// The keys of a table, and the choices of a key, for suggestions.
std::vector<std::string> keys_of(std::string_view table);
std::vector<std::string> choices_of(std::string_view table, std::string_view key);

/// Two keys that exclude each other, as "table.key", and why.
struct Exclusion {
  std::string_view a, b;
  std::string_view why;
  std::string_view unless = {};  ///< another key, with which both make sense
};
std::span<const Exclusion> exclusions();

/// A key that makes no sense without another.
struct Requirement {
  std::string_view key, needed;
  std::string_view why;
};
std::span<const Requirement> requirements();

/// A way of solving, for solve.method.
struct MethodRecord {
  std::string_view name, help;
};
std::span<const MethodRecord> method_records();

}  // namespace extremal
