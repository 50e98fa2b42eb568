#pragma once

#include <functional>
#include <string>

#include "solve/adapt/scheme_equations.hpp"
#include "solve/newton/newton_loop.hpp"

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

  // The curve in (x, μ), moves by μ last; see solve/curve/arclength.hpp.
  using Move = SchemeEquations::Vector;
  Move correction, direction;
  bool linearise(Factors) { return linearise(at_.path, at_.mu); }
  bool apply(const Move& move, double factor);
  double dot(const Move& a, const Move& b) const;
  bool goes_on() const { return left_ > 0; }
  void save();
  bool correct(const Move& tangent, double length);
  void refuse() { at_ = saved_; }

 private:
  struct Point {
    Path path;
    double mu;
  };
  bool linearise(const Path& path, double mu);
  bool converge(Path& path, double mu);
  bool descend(Point& at);
  int most_linearisations_of_curve() const;
  bool trace(const Point& from, double sense, Path& found);
  std::string failure(const Path& from) const;

  const ElementTables& tables_;
  const bool free_times_;
  std::function<bool()> on_step_;
  SchemeEquations equations_;
  SchemeEquations::Vector first_;  ///< F(x_0)
  double extent_ = 0;
  double enough_ = 0;              ///< of the residual, where equations are solved
  int left_ = 0, saved_left_ = 0;  ///< linearisations that a curve may still have
  Point at_, saved_;
  Point nearest_;  ///< on the curves, where |μ| was least
};

}  // namespace extremal
