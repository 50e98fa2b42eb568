#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// \file Where a scene's texts come from, and errors that point there.

namespace extremal {

/// A text that was read: a file, or the argument of --set.
struct Source {
  std::string name;  ///< as errors show it: "scene.toml", "--set solve.scheme"
  std::string text;
  bool numbered = true;  ///< lines and columns mean something to the user
};

/// Line and column count from 1, columns in characters; line 0 is the whole source.
struct Location {
  std::shared_ptr<const Source> source;
  int line = 0, column = 0;
};

/// "scene.toml:7:1", or the name of the source alone.
std::string to_string(const Location& location);

/// A scene that cannot be used. what() reads "scene.toml:7:1: message".
struct SceneError : std::runtime_error {
  Location at;
  SceneError(const Location& at, const std::string& message)
      : std::runtime_error(to_string(at) + ": " + message), at(at) {}
};

/// A name that does not exist, with those that do, for a suggestion; `prefix` is written before it.
struct UnknownName : SceneError {
  std::string message, name;
  std::vector<std::string> known;
  std::string prefix;
  UnknownName(const Location& at, const std::string& message, std::string name,
              std::vector<std::string> known, std::string prefix = "")
      : SceneError(at, message),
        message(message),
        name(std::move(name)),
        known(std::move(known)),
        prefix(std::move(prefix)) {}
};

/// The same where `known` is all that can stand there: it is listed where none of it is near.
struct UnknownChoice : UnknownName {
  using UnknownName::UnknownName;
};

/// A string of a scene. `at` is its opening quote.
struct Text {
  std::string value;
  Location at;
};

/// Where byte `offset` of a text's value stands in its source: quotes, escapes and line ends are walked over.
Location position(const Text& text, std::size_t offset);

inline constexpr std::size_t largest_file = std::size_t{16} << 20;     ///< bytes
inline constexpr std::size_t largest_binary = std::size_t{256} << 20;  ///< bytes

/// Reads a text file. Throws UnknownName with the files beside it if it is missing, SceneError if it is
/// unreadable, not a regular file, above `largest_file` (by its size, before reading), empty, or not UTF-8
/// text.
std::shared_ptr<const Source> read_source(const std::string& path);

/// Throws SceneError where a scene names a file that does not exist, UnknownName with the files beside it.
void require_file(const std::string& path, const Text& name);

/// Reads a file of any bytes, up to `largest_binary`. Throws as read_source() does.
std::shared_ptr<const Source> read_binary(const std::string& path);

/// A text that is no file, under the name that errors show. Throws SceneError as read_source() does.
std::shared_ptr<const Source> text_source(const std::string& name, const std::string& text);

/// Throws SceneError if a dotted key has more than 64 parts: the parser recurses over them.
void check_key_depth(const std::shared_ptr<const Source>& source);

}  // namespace extremal
