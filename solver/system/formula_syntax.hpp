#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "system/expression.hpp"
#include "system/formula.hpp"

/// \file A formula as a syntax tree: what is written, then what the names in it mean.

namespace extremal::formula {

enum class Form : std::uint8_t {
  number,     ///< value
  reference,  ///< a name, with an index as child where `indexed`, a velocity where `velocity`
  negative,   ///< −child
  total,      ///< child ± child …; an inverse link is subtracted
  product,    ///< child · child …; an inverse link divides
  power,      ///< child ^ child
  call,       ///< name(children); where `indexed`, name[first child](other children)
  series,     ///< sum(name, from, to, body)
};

/// What a name stands for.
enum class Meaning : std::uint8_t {
  none,
  coordinate,  ///< id in Names::coordinates
  parameter,   ///< id in Names::parameters
  active,      ///< a parameter that stays symbolic; id in Names::active
  definition,  ///< id in Names::definitions
  index,       ///< id counts the enclosing sums of the formula from outside
  time,
  duration,
  pi,
  start,             ///< a coordinate at 0
  end,               ///< a coordinate at T
  definition_start,  ///< a definition at 0; id in Names::definitions
  definition_end,    ///< a definition at T
};

/// What a part of a formula reads beside numbers, parameters and indices: bits.
enum Reads : std::uint8_t { of_coordinates = 1, of_velocities = 2, of_time = 4, of_ends = 8, of_others = 16 };

struct Link {
  std::uint32_t node;
  bool inverse = false;
};

struct Syntax {
  Form form = Form::number;
  Meaning meaning = Meaning::none;
  Op op = Op::constant;   ///< of a call
  bool velocity = false;  ///< written with '
  bool momentum = false;  ///< p_x; the id is that of x
  bool indexed = false;
  bool numeric = false;                  ///< made of numbers, parameters and indices alone: reads == 0
  bool additive = false;                 ///< a sum(…) stands in it as a summand, up to factors
  std::uint8_t reads = 0;                ///< of Reads
  std::uint32_t offset = 0, length = 0;  ///< where it stands in the text; of a name, all of the name
  std::uint32_t first = 0, count = 0;    ///< its links
  std::int32_t id = 0;
  std::int32_t depth = 1;  ///< levels below and including this one, through definitions
  double value = 0;
};

/// Children precede their parents in `nodes`.
struct Formula {
  std::string where, text;
  std::vector<Syntax> nodes{};
  std::vector<Link> links{};
  std::uint32_t root = 0;

  std::span<const Link> children(const Syntax& node) const { return {links.data() + node.first, node.count}; }
  std::string_view name(const Syntax& node) const {
    return std::string_view(text).substr(node.offset, node.length);
  }
};

/// Nesting beyond this is refused: the stack must hold it.
constexpr int deepest_nesting = 500;

/// Throws FormulaError.
Formula parse(std::string text, std::string where);

/// "left = right" as the tree of left − right.
Formula parse_equation(std::string text, std::string where);

bool is_name(std::string_view text);

[[noreturn]] void fail(const Formula& formula, std::size_t offset, std::string message);

}  // namespace extremal::formula
