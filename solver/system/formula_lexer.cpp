#include "system/formula_lexer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "system/formula_syntax.hpp"

namespace extremal::formula {

namespace {

constexpr std::string_view symbols = "+-*/^()[],'=";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The character at the front of text as it may stand in a message: whole where it is valid UTF-8.
std::string printable(std::string_view text) {
  const auto byte = static_cast<unsigned char>(text[0]);
  if (byte >= 0x20 && byte < 0x7f) return std::string(1, text[0]);
  const std::size_t length = byte >= 0xf0 && byte < 0xf5 ? 4 : byte >= 0xe0 ? 3 : 2;
  bool whole = byte >= 0xc2 && byte < 0xf5 && text.size() >= length;
  for (std::size_t i = 1; whole && i < length; ++i) whole = (text[i] & 0xc0) == 0x80;
  return whole ? std::string(text.substr(0, length)) : fmt::format("\\x{:02x}", byte);
}

/// Characters that stand for what is written otherwise.
struct OtherCharacter {
  std::string_view character, written;
};

constexpr OtherCharacter other_characters[] = {
    {"·", "*"},  {"×", "*"},  {"⋅", "*"}, {"∗", "*"}, {"÷", "/"},  {"−", "-"},       {"–", "-"},
    {"²", "^2"}, {"³", "^3"}, {"′", "'"}, {"’", "'"}, {"π", "pi"}, {"√", "sqrt(u)"}, {"|", "abs(u) for |u|"},
    {"{", "("},  {"}", ")"},
};

std::string mend_of(const std::string& character) {
  for (const OtherCharacter& other : other_characters)
    if (other.character == character) return fmt::format("write {}", other.written);
  return "names are made of the letters a-z and A-Z, digits and _";
}

}  // namespace

bool is_name(std::string_view text) {
  return !text.empty() && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_letter(c) || is_digit(c); });
}

Token Lexer::next() {
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  if (at_ == text_.size()) return {TokenKind::end, {}, at_};
  const char c = text_[at_];
  if (is_letter(c)) return name();
  if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) return number();
  if (c == '<' || c == '>')
    throw FormulaError(
        fmt::format("unexpected '{}': formulas and equations have no comparisons; inequalities "
                    "along the path are the 'constraints' of [path]",
                    c),
        where_, at_);
  if (symbols.find(c) == std::string_view::npos)
    throw FormulaError(fmt::format("unexpected character '{}'; {}", printable(text_.substr(at_)),
                                   mend_of(printable(text_.substr(at_)))),
                       where_, at_);
  return {TokenKind::symbol, text_.substr(at_++, 1), at_ - 1};
}

Token Lexer::name() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
  return {TokenKind::name, text_.substr(begin, at_ - begin), begin};
}

Token Lexer::number() {
  Token token{TokenKind::number, {}, at_};
  const char* first = text_.data() + at_;
  const auto [last, error] = std::from_chars(first, text_.data() + text_.size(), token.value);
  token.text = text_.substr(at_, last - first);
  if (error == std::errc::result_out_of_range)
    throw FormulaError(fmt::format("the number {} is beyond the range of double", token.text.substr(0, 40)),
                       where_, at_);
  at_ += token.text.size();
  return token;
}

}  // namespace extremal::formula
