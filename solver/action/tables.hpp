#pragma once

#include <optional>
#include <vector>

#include "action/element.hpp"
#include "action/fronts.hpp"
#include "action/rule.hpp"
#include "action/scheme.hpp"
#include "system/lagrangian.hpp"

/// \file A scheme as numbers: basis functions at the quadrature points, their products summed with
/// the weights, and the matrices that read a polynomial's size from its nodes.

namespace extremal {

/// Owner of a PointSums table.
struct PointTable {
  std::vector<int> start{0}, point;
  std::vector<double> coefficient;
  void add(int at_point, double value);
  void close() { start.push_back(static_cast<int>(point.size())); }
  PointSums view() const { return {start.data(), point.data(), coefficient.data()}; }
};

/// Whether elements use Gauss's rule, not Lobatto's. Where L has kinks, as it has no point at an end: at a
/// kink derivatives of L are those of the one side or the other. In phase space, as Hamilton's equations hold
/// at its points.
bool uses_gauss(const Lagrangian& lagrangian);

/// Of one scheme with `points` quadrature points; independent of the system.
struct SchemeTables {
  Scheme scheme;
  int degree = 0, functions = 0, points = 0;
  bool nodal = false;
  std::vector<double> node, weight;    ///< of the quadrature
  std::vector<double> lobatto;         ///< s + 1 nodes of the element
  std::vector<double> value, slope;    ///< points × functions, basis as in element.hpp
  std::vector<double> end_derivative;  ///< 2 × (s + 1): nodal basis, derivatives at τ = 0 and τ = 1
  std::vector<double> stiffness, gyration;
  PointTable value_sum, slope_sum, value_value, slope_value, slope_slope;
  std::vector<double> legendre;  ///< functions × functions: Legendre coefficients from (d, 1 − τ, τ)

  /// `exact_points` counts only where scheme.quadrature is `exact`.
  explicit SchemeTables(const Scheme& scheme, int exact_points = 0);
  /// Of lobatto(degree), kept for the whole run.
  static const SchemeTables& of_lobatto(int degree);
  /// Of gauss(degree), likewise.
  static const SchemeTables& of_gauss(int degree);
  /// The rule of order 2·degree for a Lagrangian: Lobatto's, or Gauss's, see uses_gauss().
  static const SchemeTables& of_order(int degree, const Lagrangian& lagrangian);
};

/// Above this many unknowns in an element Newton's method holds its Hessian as a list of entries.
inline constexpr int most_dense_unknowns = 800;

/// Tables bound to a Lagrangian: what the kernels take.
class ElementTables {
 public:
  ElementTables() = default;
  /// Both must outlive the tables. Keeps memory.
  void bind(const SchemeTables& scheme, const Lagrangian& lagrangian);
  /// Where elements end at the kinks of L, these; else null.
  const Kinks* kinks() const { return kinks_; }
  void end_at(const Kinks* kinks) { kinks_ = kinks; }
  const ElementShape& shape() const { return shape_; }
  const SchemeTables& scheme() const { return *scheme_; }
  int coordinates() const { return shape_.n; }
  int inner() const { return (shape_.functions - 2) * shape_.n; }
  int unknowns() const { return shape_.functions * shape_.n; }

  /// The fronts of the elimination, and where each contribution to the Hessian goes in their matrix; made
  /// when first asked for.
  struct Condensation {
    Fronts fronts;
    std::vector<int> slots;
  };
  const Condensation& condensation() const;

  /// The entries that may differ from zero, and where each contribution goes in their list; likewise.
  struct Entries {
    std::vector<int> row, column;  ///< local numbers, row >= column
    std::vector<int> slots;
  };
  const Entries& entries() const;

 private:
  struct Place {
    int row, column;
    bool twice;  ///< stands for itself and a mirror image that is the same entry
  };
  void list_places();

  const SchemeTables* scheme_ = nullptr;
  const Kinks* kinks_ = nullptr;
  std::vector<EntryView> mass_, gyroscopic_, hessian_;
  std::vector<double> linear_;
  ElementShape shape_{};
  std::vector<Place> places_;
  mutable std::optional<Condensation> condensation_;
  mutable Entries entries_;
};

}  // namespace extremal
