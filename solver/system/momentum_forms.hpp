#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "system/algebra.hpp"
#include "system/derivative.hpp"
#include "system/tape.hpp"

/// \file A Hamiltonian as a sum of quadratic forms of the momenta and of square roots of such forms.

namespace extremal {

enum class PhaseInput : std::uint8_t { coordinate, momentum, time, parameter, uniform };

/// Rows of a term whose inputs are of the same kinds.
struct PhaseRows {
  NodeId body;
  int arity;
  std::vector<PhaseInput> kinds;
  std::vector<std::uint32_t> table;

  int rows() const { return arity ? static_cast<int>(table.size()) / arity : 1; }
  std::uint32_t at(int row, std::uint32_t input) const {
    return table[static_cast<std::size_t>(row) * arity + input];
  }
};

/// What some momenta of a term contribute: ½ pᵀ a p + bᵀ p + c, or g times its square root, in the inputs of
/// the term.
struct MomentumForm {
  struct Second {
    std::uint32_t row, column;  ///< inputs, both orders stand
    Scaled value;
  };
  std::size_t rows;                    ///< which PhaseRows
  std::vector<std::uint32_t> momenta;  ///< inputs
  std::vector<Second> a;
  std::vector<Partial> b;
  Scaled c, g;
  bool root = false;
  std::vector<std::uint32_t> read;  ///< inputs that a, b, c, g are made of
};

struct MomentumForms {
  /// Without momenta: expression over the inputs of these rows.
  struct Rest {
    std::size_t rows;
    Scaled value;
  };
  std::vector<PhaseRows> rows;
  std::vector<MomentumForm> forms;
  std::vector<Rest> rest;
};

/// H taken apart, with expressions built by `algebra`. The velocity inputs of `hamiltonian` stand for
/// momenta. Nothing where a summand is neither a quadratic form nor a root of one.
std::optional<MomentumForms> momentum_forms(const LagrangianGraph& hamiltonian, Algebra& algebra);

}  // namespace extremal
