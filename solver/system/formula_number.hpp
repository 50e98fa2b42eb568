#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "system/formula_names.hpp"

/// \file Formulas as numbers.

namespace extremal::formula {

/// Evaluates resolved formulas of numbers, parameters and indices (and of t, T in a guess, end values in a
/// quantity). The work of
/// all evaluations together is bounded: sums may be long, but nothing may hang.
class Evaluator {
 public:
  explicit Evaluator(const Names& names) : names_(names), definitions_(names.definitions.size()) {}

  double duration = 0;
  void set_time(double time);
  EndValues ends = {};

  /// `indices` holds the value of each index known at the node, outermost first.
  double value(const Formula& formula, std::uint32_t node, std::vector<double>& indices);

  /// As above, and finite; else throws.
  double finite(const Formula& formula, std::uint32_t node, std::vector<double>& indices);

  /// An integer formula; `what` names it in errors.
  long integer(const Formula& formula, std::uint32_t node, std::vector<double>& indices,
               std::string_view what);

  /// Which element, from 0, the reference `node` reads among `count`.
  int element(const Formula& formula, const Syntax& node, int count, std::vector<double>& indices);

  /// Counts `amount` units of work for this formula, and throws where all is too much.
  void spend(const Formula& formula, const Syntax& node, std::size_t amount);

 private:
  static bool whole(const Formula& formula, std::uint32_t node);
  double exact(const Formula& formula, std::uint32_t node, std::vector<double>& indices);
  double reference(const Formula& formula, const Syntax& node, std::vector<double>& indices);
  double series(const Formula& formula, const Syntax& node, std::vector<double>& indices);
  double end_value(const Formula& formula, const Syntax& node, std::vector<double>& indices);
  double end_definition(const Syntax& node);

  struct Cached {
    bool known = false;
    double value = 0;
  };

  const Names& names_;
  std::vector<Cached> definitions_;  ///< at time_
  double time_ = 0;
  bool at_end_ = false;  ///< where a definition is read
  std::size_t work_ = 0;
};

}  // namespace extremal::formula
