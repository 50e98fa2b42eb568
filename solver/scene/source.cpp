#include "scene/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace extremal {
namespace fs = std::filesystem;
namespace {

constexpr int deepest_key = 64;

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// A place in a text that knows its line and column.
struct Cursor {
  std::string_view text;
  std::size_t byte = 0;
  int line = 1, column = 1;

  bool done() const { return byte >= text.size(); }
  char peek(std::size_t ahead = 0) const { return byte + ahead < text.size() ? text[byte + ahead] : '\0'; }
  bool starts_with(std::string_view s) const { return text.substr(byte, s.size()) == s; }
  void next() {
    if (text[byte] == '\n') {
      ++line;
      column = 1;
    } else if (!continues_character(peek(1))) {
      ++column;
    }
    ++byte;
  }
  void skip(std::size_t bytes) {
    for (std::size_t k = 0; k < bytes && !done(); ++k) next();
  }
  void move_to(int to_line, int to_column) {
    while (!done() && (line < to_line || (line == to_line && column < to_column))) next();
  }
  /// Past the string that opens here; a string of one line ends with its line, closed or not.
  void skip_string() {
    const char quote = peek();
    const std::string three(3, quote);
    const bool long_string = starts_with(three);
    skip(long_string ? 3 : 1);
    while (!done() && !(long_string ? starts_with(three) : peek() == quote)) {
      if (!long_string && peek() == '\n') return;
      skip(quote == '"' && peek() == '\\' ? 2 : 1);
    }
    skip(long_string ? 3 : 1);
    if (long_string)
      skip(peek() != quote ? 0 : peek(1) != quote ? 1 : 2);  // quotes may touch the closing ones
  }
};

/// Bytes of the UTF-8 character that begins at text[k]; 0 if none does.
int character_size(std::string_view text, std::size_t k) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned lead = byte(k);
  if (lead < 0x80) return lead == 0 ? 0 : 1;
  const int size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  for (int i = 1; i < size; ++i)
    if ((byte(k + i) & 0xC0) != 0x80) return 0;
  const unsigned second = byte(k + 1);
  const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool surrogate = lead == 0xED && second >= 0xA0, beyond = lead == 0xF4 && second >= 0x90;
  return overlong || surrogate || beyond ? 0 : size;
}

void check_characters(const std::shared_ptr<const Source>& source) {
  const std::string_view text = source->text;
  int line = 1, column = 1;
  for (std::size_t k = 0; k < text.size();) {
    const int size = character_size(text, k);
    if (size == 0)
      throw SceneError({source, line, column},
                       fmt::format("not a text file: byte {} of {} is 0x{:02x}, which is not "
                                   "UTF-8 text",
                                   k + 1, text.size(), static_cast<unsigned char>(text[k])));
    const bool new_line = text[k] == '\n';
    line += new_line;
    column = new_line ? 1 : column + 1;
    k += size;
  }
}

/// Refuses a file that does not exist, with the names of those beside it, as they are to be written in
/// `folder_as_named`.
[[noreturn]] void refuse_missing(const fs::path& path, const Location& at, const std::string& message,
                                 const fs::path& folder_as_named) {
  const fs::path folder = path.parent_path();
  std::error_code error;
  if (!folder.empty() && !fs::is_directory(folder, error))
    throw SceneError(at, fmt::format("{}; there is no folder '{}'", message, folder.string()));
  std::vector<std::string> files;
  const fs::path here = folder.empty() ? "." : folder;
  for (fs::directory_iterator it(here, error), end; !error && it != end; it.increment(error))
    if (std::error_code ignored; it->is_regular_file(ignored))
      files.push_back(it->path().filename().string());
  std::sort(files.begin(), files.end());
  const std::string name = path.filename().string(), completed = name + ".toml";
  const bool exists = std::binary_search(files.begin(), files.end(), completed);
  throw UnknownName(at, message, exists ? completed : name, files,
                    folder_as_named.empty() ? "" : (folder_as_named / "").string());
}

/// Moves over one character of content as it is written; returns the bytes it stands for.
std::size_t skip_content(Cursor& cursor, bool escapes, bool long_string) {
  if (!escapes || cursor.peek() != '\\') {
    cursor.next();
    return 1;
  }
  const char kind = cursor.peek(1);
  if (long_string && (kind == '\n' || kind == '\r' || kind == ' ' || kind == '\t')) {  // a joined line
    cursor.next();
    while (!cursor.done() && std::strchr(" \t\r\n", cursor.peek())) cursor.next();
    return 0;
  }
  if (kind != 'u' && kind != 'U') {
    cursor.skip(2);
    return 1;
  }
  const int digits = kind == 'u' ? 4 : 8;
  const unsigned long code =
      std::strtoul(std::string(cursor.text.substr(cursor.byte + 2, digits)).c_str(), nullptr, 16);
  cursor.skip(2 + digits);
  return code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
}

/// The bytes of a file, at most so many.
std::shared_ptr<Source> read_bytes(const std::string& path, std::size_t most) {
  auto source = std::make_shared<Source>();
  source->name = path;
  const auto refuse = [&](const std::string& message) { throw SceneError({source, 0, 0}, message); };
  if (path.empty()) {
    source->name = "''";
    refuse("the name of the file is empty");
  }
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found)
    refuse_missing(path, {source, 0, 0}, "no such file", fs::path(path).parent_path());
  if (!fs::exists(status)) refuse(fmt::format("cannot be found: {}", error.message()));
  if (fs::is_directory(status)) refuse("is a directory; a file is needed");
  if (!fs::is_regular_file(status)) refuse("is not a regular file");
  const auto size = fs::file_size(path, error);
  if (error) refuse(fmt::format("its size cannot be read: {}", error.message()));
  if (size > most) refuse(fmt::format("has {} bytes; at most {} ({} MiB) are read", size, most, most >> 20));
  if (size == 0) refuse("the file is empty");
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(fmt::format("cannot be opened: {}", std::strerror(errno)));
  source->text.resize(size);
  if (!file.read(source->text.data(), static_cast<std::streamsize>(size)))
    refuse("cannot be read to its end");
  return source;
}

}  // namespace

std::string to_string(const Location& location) {
  if (!location.source) return "scene";
  if (location.line == 0 || !location.source->numbered) return location.source->name;
  return fmt::format("{}:{}:{}", location.source->name, location.line, location.column);
}

Location position(const Text& text, std::size_t offset) {
  if (!text.at.source || text.at.line == 0) return text.at;
  Cursor cursor{text.at.source->text};
  cursor.move_to(text.at.line, text.at.column);
  const char quote = cursor.peek();
  if (quote != '"' && quote != '\'') return text.at;
  const bool long_string = cursor.starts_with(std::string(3, quote));
  cursor.skip(long_string ? 3 : 1);
  if (long_string) cursor.skip(cursor.starts_with("\r\n") ? 2 : cursor.peek() == '\n' ? 1 : 0);
  for (std::size_t passed = 0; passed < offset && !cursor.done();)
    passed += skip_content(cursor, quote == '"', long_string);
  while (cursor.peek() == '\\' && quote == '"' && long_string && std::strchr("\r\n", cursor.peek(1)))
    skip_content(cursor, true, true);
  return {text.at.source, cursor.line, cursor.column};
}

void require_file(const std::string& path, const Text& name) {
  if (name.value.empty()) throw SceneError(name.at, "the name of the file is empty");
  std::error_code error;
  if (fs::status(path, error).type() == fs::file_type::not_found)
    refuse_missing(path, name.at, fmt::format("no such file: '{}'", name.value),
                   fs::path(name.value).parent_path());
}

std::shared_ptr<const Source> read_source(const std::string& path) {
  const std::shared_ptr<Source> source = read_bytes(path, largest_file);
  check_characters(source);
  return source;
}

std::shared_ptr<const Source> read_binary(const std::string& path) {
  return read_bytes(path, largest_binary);
}

std::shared_ptr<const Source> text_source(const std::string& name, const std::string& text) {
  auto source = std::make_shared<Source>(Source{name, text});
  const Location whole{source, 0, 0};
  if (text.size() > largest_file)
    throw SceneError(whole,
                     fmt::format("has {} bytes; at most {} (16 MiB) are read", text.size(), largest_file));
  if (text.empty()) throw SceneError(whole, "the text is empty");
  check_characters(source);
  return source;
}

void check_key_depth(const std::shared_ptr<const Source>& source) {
  Cursor cursor{source->text};
  int dots = 0;        // joining the parts of one key
  char last = '\n';    // the last character that is not blank; 'a' for a part of a key
  bool blank = false;  // between it and this one
  while (!cursor.done()) {
    const char c = cursor.peek();
    const bool part = std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-\"'", c);
    if (c == ' ' || c == '\t') {
      blank = true;
      cursor.next();
      continue;
    }
    if (c == '.' && last == 'a')
      ++dots;
    else if (!part || (blank && last != '.'))
      dots = 0;
    if (dots >= deepest_key)
      throw SceneError({source, cursor.line, cursor.column},
                       fmt::format("this key has more than {} parts", deepest_key));
    last = part ? 'a' : c;
    blank = false;
    if (c == '#')
      while (!cursor.done() && cursor.peek() != '\n') cursor.next();
    else if (c == '"' || c == '\'')
      cursor.skip_string();
    else
      cursor.next();
  }
}

}  // namespace extremal
