#include <string_view>

#include "report/figure.hpp"

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

/// U+0000 … U+001F, U+007F … U+009F, and U+FFFE, U+FFFF, which XML forbids.
bool is_control(std::string_view character) {
  const auto lead = static_cast<unsigned char>(character[0]);
  return lead < 0x20 || lead == 0x7F || (lead == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0) ||
         character == "\xEF\xBF\xBE" || character == "\xEF\xBF\xBF";
}

}  // namespace

std::string printable(const std::string& text, std::size_t limit) {
  std::string result;
  std::size_t count = 0;
  for (std::size_t k = 0; k < text.size(); ++count) {
    if (count == limit) return result + "…";
    const std::string_view rest = std::string_view(text).substr(k);
    const std::size_t length = character_length(rest);
    if (length == 0) {
      result += "\uFFFD";
      ++k;
      continue;
    }
    const std::string_view character = rest.substr(0, length);
    if (character == ">" && result.ends_with("]]")) result += ' ';  // XML forbids the three together
    result += is_control(character) ? " " : character;
    k += length;
  }
  return result;
}

double text_width(const std::string& text) {
  double width = 0;
  for (const char c : text) {
    if (continues(c)) continue;
    width += std::string_view("., '[]()fijlrt").find(c) == std::string_view::npos ? 7.2 : 3.8;
  }
  return width;
}

}  // namespace extremal
