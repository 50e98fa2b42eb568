#pragma once

#include <toml++/toml.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/source.hpp"

/// \file A TOML text with the places of its nodes, for the reader of scenes alone.

namespace extremal {

struct Entry {
  const toml::key* key;
  const toml::node* value;
};

/// The tables of a file, and of --set arguments merged into it.
struct Document {
  toml::table root;
  std::map<std::string, std::shared_ptr<const Source>, std::less<>> sources;  ///< by name

  Location at(const toml::source_region& region) const;
  Location at(const toml::node& node) const { return at(node.source()); }
  /// The entries of a table, ordered by `precedes`.
  std::vector<Entry> entries(const toml::table& table) const;
};

/// In the order in which they are written, those of --set last.
bool precedes(const Location& a, const Location& b);

/// Throws SceneError where the text is not TOML.
Document parse_document(const std::shared_ptr<const Source>& source);

/// Applies "key=value": a dotted key, and a value in TOML, or else a string. Tables that are missing are
/// made; "m[2]" is an element of a list m. Throws SceneError if the key is malformed or leads through what is
/// no table.
void set_value(Document& document, const std::string& argument);

/// Throws SceneError at the first key that is unknown or of the wrong type in `table`, whose keys the schema
/// holds under `name`, and in the tables below.
void check_keys(const Document& document, const toml::table& table, std::string_view name);

/// Throws SceneError where two keys exclude each other or one lacks another.
void check_relations(const Document& document);

}  // namespace extremal
