#pragma once

#include <array>
#include <memory>
#include <vector>

#include "action/tables.hpp"

/// \file Elements of rising degree for one Lagrangian, and the matrices between them; kept between solves.

namespace extremal {

class Levels {
 public:
  /// Tables are for this Lagrangian from now on; those that are for it already stay.
  void bind(std::shared_ptr<const Lagrangian> lagrangian);

  /// lobatto(degree), or gauss(degree) where L has kinks, made when first asked for.
  const ElementTables& at(int degree);
  /// The same elements under Gauss's rule with `degree` points more; likewise.
  const ElementTables& finer(const SchemeTables& rule);

  /// From Lobatto(from) nodal values to the Lobatto(to) nodes.
  const std::vector<double>& raise(int from, int to);

  /// From Lobatto(degree) nodal values to the 2·degree + 1 nodes of the two halves.
  const std::vector<double>& halve(int degree);

 private:
  struct Level {
    const SchemeTables* scheme = nullptr;
    std::unique_ptr<SchemeTables> own = {};
    ElementTables tables = {};
    bool bound = false;
  };
  using Ladder = std::array<std::unique_ptr<Level>, max_degree + 1>;
  const ElementTables& bound(Level& level);
  std::shared_ptr<const Lagrangian> lagrangian_;
  Ladder levels_, finer_;
  std::array<std::vector<double>, (max_degree + 1) * (max_degree + 1)> raise_;
  std::array<std::vector<double>, max_degree + 1> halve_;
};

}  // namespace extremal
