#pragma once

#include <functional>
#include <string>

#include "solve/adapt/scheme_equations.hpp"

/// \file From a path near no solution of the equations of a scheme to one of their solutions.

namespace extremal {

/// With F the equations of a scheme and x_0 a path, the solutions of
///   F(x) = μ F(x_0)
/// are curves in (x, μ), one of which begins at x_0 with μ = 1 in two senses (Newton's homotopy; Allgower and
/// Georg, Numerical Continuation Methods, 1990). Newton's method at falling μ finds its way along those that
/// do not fold; else they are followed past folds, by pseudo-arclength, to μ = 0.
class ResidualHomotopy {
 public:
  /// As of SchemeEquations. `on_step` says after each linearisation whether there may be more.
  ResidualHomotopy(const Problem& problem, const ElementTables& tables, int elements, bool free_times,
                   std::function<bool()> on_step);

  struct Report {
    bool reached = false;
    std::string failure;  ///< of times: with the node at which they fail
  };
  Report find(Path& path);

 private:
  struct Tangent {
    SchemeEquations::Vector step;
    double parameter;
  };
  bool linearise(const Path& path, double mu);
  double product(const Tangent& a, const Tangent& b, const Path& path) const;
  bool converge(Path& path, double mu);
  bool descend(Path& path, double& mu);
  bool correct(Path& path, double& mu, const Tangent& tangent, double length);
  bool next_tangent(const Path& path, const Tangent* before, double sense, Tangent& next) const;
  static Tangent bent(const Tangent& here, const Tangent& before, double by);
  int most_linearisations_of_curve() const;
  bool trace(Path path, double mu, double sense, Path& found);
  std::string failure(const Path& from) const;

  const ElementTables& tables_;
  const bool free_times_;
  std::function<bool()> on_step_;
  SchemeEquations equations_;
  SchemeEquations::Vector first_;                   ///< F(x_0)
  SchemeEquations::Vector correction_, direction_;  ///< at fixed μ, and by μ
  double extent_ = 0;
  double enough_ = 0;  ///< of the residual, where equations are solved
  int left_ = 0;       ///< linearisations that a curve may still have
  Path nearest_;       ///< on the curves, where μ was least
  double least_ = 0;
};

}  // namespace extremal
