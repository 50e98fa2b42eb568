#include <fmt/format.h>

#include <utility>

#include "system/formula_lexer.hpp"
#include "system/formula_names.hpp"

namespace extremal::formula {

namespace {

/// Recursive descent:
///   total    = product { ("+" | "-") product }
///   product  = signed { ("*" | "/") signed }
///   signed   = { "+" | "-" } power
///   power    = value [ "^" signed ]
///   value    = number | "(" total ")" | "sum" "(" name "," total "," total "," total ")"
///            | name [ "[" total "]" ] [ "'" ] [ "(" total { "," total } ")" ]
class Parser {
 public:
  explicit Parser(Formula& formula) : formula_(formula), lexer_(formula.text, formula.where) {
    if (formula.text.size() > largest_text)
      stop(0, fmt::format("the formula has {} bytes; {} are the most", formula.text.size(), largest_text));
    advance();
    if (token_.kind == TokenKind::end) stop(0, "the formula is empty");
  }

  std::uint32_t formula() {
    const std::uint32_t root = total();
    if (token_.kind != TokenKind::end) unexpected();
    return root;
  }

  std::uint32_t equation() {
    const std::uint32_t left = total();
    if (token_.kind == TokenKind::end) stop(token_.offset, "'=' is missing: write left = right");
    if (!token_.is('=')) unexpected();
    const std::size_t sign = token_.offset;
    advance();
    const std::uint32_t right = total();
    if (token_.is('=')) stop(token_.offset, "a second '='; an equation has one");
    if (token_.kind != TokenKind::end) unexpected();
    return add({.form = Form::total, .offset = narrow(sign), .length = 1}, {{left}, {right, true}});
  }

 private:
  static constexpr std::size_t largest_text = 16u << 20, most_shown = 24;

  static std::uint32_t narrow(std::size_t offset) { return static_cast<std::uint32_t>(offset); }

  void advance() {
    previous_ = token_;
    token_ = lexer_.next();
  }

  [[noreturn]] void stop(std::size_t offset, std::string message) const {
    fail(formula_, offset, std::move(message));
  }

  [[noreturn]] void unexpected() const {
    if (token_.kind == TokenKind::end) stop(token_.offset, "the formula ends where a value is expected");
    std::string mend;
    if (token_.kind != TokenKind::symbol || token_.is('(')) mend = "; write '*' to multiply";
    if (token_.kind == TokenKind::name && previous_.kind == TokenKind::number)
      mend += ", and numbers without units";
    if (previous_.kind == TokenKind::name && find_function(previous_.text) != nullptr)
      mend = fmt::format("; write {}(…)", previous_.text);
    if (token_.is(')')) mend = "; no '(' is open";
    if (token_.is('=')) mend = "; a formula has no '='";
    const std::size_t after = token_.offset + 1;
    if (token_.is(',') && previous_.kind == TokenKind::number && after < formula_.text.size() &&
        formula_.text[after] >= '0' && formula_.text[after] <= '9')
      mend = "; decimals are written with a point";
    if (token_.is('*') && formula_.text[token_.offset - (token_.offset > 0)] == '*')
      mend = "; a power is written '^'";
    stop(token_.offset, fmt::format("unexpected '{}'{}", token_.text.substr(0, 40), mend));
  }

  void close(char symbol, const Token& opening) {
    if (!token_.is(symbol)) {
      const bool ends = token_.is(',') || token_.is(')') || token_.is(']') || token_.is('=');
      if (token_.kind != TokenKind::end && !ends) unexpected();
      const std::size_t length = previous_.offset + previous_.text.size() - opening.offset;
      const std::string_view open = std::string_view(formula_.text).substr(opening.offset, length);
      stop(token_.offset, fmt::format("'{}' is missing for the '{}' of {}{}{}", symbol, opening.text,
                                      open.substr(0, most_shown), open.size() > most_shown ? "…" : "",
                                      token_.is('=') ? ", before '='" : ""));
    }
    advance();
  }

  std::uint32_t add(Syntax node, std::initializer_list<Link> links) {
    return add(node, std::vector<Link>(links));
  }

  std::uint32_t add(Syntax node, const std::vector<Link>& links) {
    node.first = narrow(formula_.links.size());
    node.count = narrow(links.size());
    formula_.links.insert(formula_.links.end(), links.begin(), links.end());
    formula_.nodes.push_back(node);
    return narrow(formula_.nodes.size() - 1);
  }

  /// Operands joined by two operators of one rank, from left to right.
  template <class Operand>
  std::uint32_t chain(Form form, char direct, char inverse, Operand operand) {
    const std::size_t begin = token_.offset;
    const std::uint32_t first = operand();
    if (!token_.is(direct) && !token_.is(inverse)) return first;
    std::vector<Link> links{{first}};
    while (token_.is(direct) || token_.is(inverse)) {
      const bool inverted = token_.is(inverse);
      advance();
      if (token_.is('*')) unexpected();
      links.push_back({operand(), inverted});
    }
    return add({.form = form, .offset = narrow(begin), .length = 1}, links);
  }

  std::uint32_t total() {
    return chain(Form::total, '+', '-', [this] { return product(); });
  }

  std::uint32_t product() {
    return chain(Form::product, '*', '/', [this] { return signed_power(); });
  }

  std::uint32_t signed_power() {
    if (++depth_ > deepest_nesting)
      stop(token_.offset,
           fmt::format("nested more than {} deep; name parts of it as definitions", deepest_nesting));
    const std::size_t begin = token_.offset;
    bool negative = false;
    while (token_.is('-') || token_.is('+')) {
      negative ^= token_.is('-');
      advance();
    }
    const std::uint32_t operand = power();
    --depth_;
    return negative ? add({.form = Form::negative, .offset = narrow(begin), .length = 1}, {{operand}})
                    : operand;
  }

  std::uint32_t power() {
    const std::size_t begin = token_.offset;
    const std::uint32_t base = value();
    if (!token_.is('^')) return base;
    advance();
    const std::uint32_t exponent = signed_power();
    return add({.form = Form::power, .offset = narrow(begin), .length = 1}, {{base}, {exponent}});
  }

  std::uint32_t value() {
    const Token token = token_;
    if (token.kind == TokenKind::number) {
      advance();
      return add({.form = Form::number, .offset = narrow(token.offset), .value = token.value}, {});
    }
    if (token.is('(')) {
      advance();
      const std::uint32_t inner = total();
      close(')', token);
      return inner;
    }
    if (token.kind != TokenKind::name) {
      if (token.is('=') && previous_.is('=')) stop(token.offset, "a second '='; an equation has one");
      if (token.is(')') || token.is(']') || token.is(',') || token.is('='))
        stop(token.offset, fmt::format("a value is missing before '{}'", token.text));
      unexpected();
    }
    advance();
    return token.text == "sum" ? series(token) : named(token);
  }

  std::uint32_t series(const Token& name) {
    const Token opening = token_;
    if (!opening.is('(')) stop(name.offset, "'sum' is a function; write sum(i, from, to, body)");
    advance();
    const Token index = token_;
    if (index.kind != TokenKind::name)
      stop(index.offset, "the index is missing; write sum(i, from, to, body)");
    advance();
    std::vector<Link> links;
    for (int argument = 0; argument < 3; ++argument) {
      if (!token_.is(','))
        stop(token_.offset, "sum takes an index, two bounds and a body: sum(i, from, to, body)");
      advance();
      links.push_back({total()});
    }
    if (token_.is(','))
      stop(token_.offset, "sum takes an index, two bounds and a body: sum(i, from, to, body)");
    close(')', opening);
    return add({.form = Form::series, .offset = narrow(index.offset), .length = narrow(index.text.size())},
               links);
  }

  /// A name with whatever follows it: index, prime, arguments.
  std::uint32_t named(const Token& name) {
    Syntax node{.form = Form::reference, .offset = narrow(name.offset), .length = narrow(name.text.size())};
    std::vector<Link> links;
    if (const Token opening = token_; opening.is('[')) {
      advance();
      node.indexed = true;
      links.push_back({total()});
      if (token_.is(',')) stop(token_.offset, fmt::format("'{}' takes one index", name.text));
      close(']', opening);
      if (token_.is('[')) stop(token_.offset, fmt::format("'{}' takes one index", name.text));
    }
    if (token_.is('\'')) {
      advance();
      node.velocity = true;
      if (token_.is('\'')) stop(token_.offset, "a second \"'\"; formulas know first derivatives only");
      if (token_.is('['))
        stop(token_.offset, fmt::format("the index stands before the prime: {}[…]'", name.text));
    }
    if (const Token opening = token_; opening.is('(')) {
      node.form = Form::call;
      do {
        advance();
        links.push_back({total()});
      } while (token_.is(','));
      close(')', opening);
    }
    return add(node, links);
  }

  Formula& formula_;
  Lexer lexer_;
  Token token_, previous_;
  int depth_ = 0;
};

}  // namespace

Formula parse(std::string text, std::string where) {
  Formula formula{.where = std::move(where), .text = std::move(text)};
  formula.root = Parser(formula).formula();
  return formula;
}

Formula parse_equation(std::string text, std::string where) {
  Formula formula{.where = std::move(where), .text = std::move(text)};
  formula.root = Parser(formula).equation();
  return formula;
}

void fail(const Formula& formula, std::size_t offset, std::string message) {
  throw FormulaError(std::move(message), formula.where, offset);
}

}  // namespace extremal::formula
