#pragma once

#include <string>
#include <string_view>

/// \file The tokens of a formula.

namespace extremal::formula {

enum class TokenKind { number, name, symbol, end };

struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text;
  std::size_t offset = 0;
  double value = 0;  ///< of a number
  bool is(char symbol) const { return kind == TokenKind::symbol && text[0] == symbol; }
};

/// Reads tokens from left to right; `where` names the text in errors.
class Lexer {
 public:
  Lexer(std::string_view text, const std::string& where) : text_(text), where_(where) {}
  /// Throws FormulaError at a character that no formula has, or a number beyond the range of double.
  Token next();

 private:
  Token number();
  Token name();

  std::string_view text_;
  const std::string& where_;
  std::size_t at_ = 0;
};

}  // namespace extremal::formula
