#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "report/figure.hpp"
#include "report/text.hpp"

namespace extremal {

namespace {

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// Length of the well-formed character that begins a text, or 0 (Unicode 15, table 3-7).
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (lead > 0xF4 || length == 0 || length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if (!continues(text[k])) return 0;
  }
  if (lead == 0xE0 && byte(1) < 0xA0) return 0;  // overlong
  if (lead == 0xED && byte(1) > 0x9F) return 0;  // surrogates
  if (lead == 0xF0 && byte(1) < 0x90) return 0;  // overlong
  if (lead == 0xF4 && byte(1) > 0x8F) return 0;  // beyond U+10FFFF
  return length;
}

/// The code point of a well-formed character.
std::uint32_t code_point(std::string_view character) {
  constexpr unsigned char lead_bits[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
  std::uint32_t code = static_cast<unsigned char>(character[0]) & lead_bits[character.size()];
  for (const char c : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(c) & 0x3F);
  return code;
}

/// C0 and C1 controls, line and paragraph separators, those that turn the direction of writing, and U+FFFE,
/// U+FFFF, which XML forbids.
bool is_control(std::uint32_t code) {
  const auto within = [code](std::uint32_t first, std::uint32_t last) {
    return first <= code && code <= last;
  };
  return code < 0x20 || within(0x7F, 0x9F) || within(0x2028, 0x202E) || within(0x2066, 0x2069) ||
         within(0xFFFE, 0xFFFF);
}

/// Calls take(character) for each character, with "" for a byte that begins none, as long as it returns true.
template <class Take>
void for_each_character(const std::string& text, Take&& take) {
  for (std::size_t k = 0; k < text.size();) {
    const std::string_view rest = std::string_view(text).substr(k);
    const std::size_t length = character_length(rest);
    if (!take(rest.substr(0, length))) return;
    k += std::max<std::size_t>(length, 1);
  }
}

constexpr const char* no_character = "\uFFFD";

}  // namespace

std::string printable(const std::string& text, std::size_t limit) {
  std::string result;
  std::size_t count = 0;
  for_each_character(text, [&](std::string_view character) {
    if (count++ == limit) {
      result += "…";
      return false;
    }
    if (character == ">" && result.ends_with("]]")) result += ' ';  // XML forbids the three together
    result += character.empty() ? no_character : is_control(code_point(character)) ? " " : character;
    return true;
  });
  return result;
}

std::string visible(const std::string& text, bool lines) {
  std::string result;
  for_each_character(text, [&](std::string_view character) {
    const std::uint32_t code = character.empty() ? 0 : code_point(character);
    if (character.empty())
      result += no_character;
    else if (code == '\n')
      result += lines ? "\n" : "\\n";
    else if (is_control(code))
      result += fmt::format("\\u{:04x}", code);
    else
      result += character;
    return true;
  });
  return result;
}

double text_width(const std::string& text) {
  const auto among = [](std::string_view some, char c) { return some.find(c) != std::string_view::npos; };
  double width = 0;
  for (const char c : text) {
    if (continues(c)) continue;
    const bool sign = among("=+<>~%@mwMW", c) || static_cast<unsigned char>(c) >= 0x80;
    width += among(" .,:;'|ijlI", c) ? 4.2 : among("[]()/frt-", c) ? 5.2 : sign ? 10.9 : 8.2;
  }
  return width;
}

}  // namespace extremal
