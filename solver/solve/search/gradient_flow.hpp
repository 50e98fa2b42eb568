#pragma once

#include <functional>
#include <vector>

#include "solve/adapt/workspace.hpp"
#include "solve/newton/node_system.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/monotone_cubic.hpp"
#include "solve/search/time_law.hpp"

/// \file Minimisation of the action by its gradient flow, on linear elements that are redistributed.

namespace extremal {

/// Implicit steps (W/τ + S''_h) δ = −S'_h of the gradient flow of the action, W the mass of the nodes: for
/// large τ Newton's, for small τ along the gradient (pseudo-transient continuation; Kelley and Keyes, SIAM J.
/// Numer. Anal. 35 (1998) 508). As long as 1/τ exceeds the negative curvature of L in q, the flow keeps the
/// order of paths, and monotone paths monotone; τ grows beyond that as long as steps are short. The action
/// falls at every step. Elements are redistributed by the curvature of the path, so that thin layers and
/// kinks in long intervals are resolved. A saddle is left along the direction of most negative curvature.
class GradientFlow {
 public:
  /// `path` is on elements of linear_elements(). `count` is called for each factorisation and says whether
  /// there may be more.
  GradientFlow(const Problem& problem, Path& path, Workspace& workspace, std::function<bool()> count);

  /// Elements of degree 1 under a rule that integrates the forces between their ends as well: interfaces
  /// cannot hide inside long elements.
  static const ElementTables& linear_elements(Levels& levels);
  /// Elements for a problem; 0 where its boundary relation does not let the flow run, which needs a fixed T
  /// and a path that is not closed, or where it has too many coordinates.
  static int elements_for(const Problem& problem);

  /// Takes the path near a minimiser; false if it does not arrive, or if L is not convex in q'.
  /// The path is moved first by `away` of its range, of either sign, along the direction of most negative
  /// curvature; false if there is none, unless `away` is 0.
  bool run(double away = 0);
  /// To which side saddles are left that the flow meets: 1 or −1.
  void prefer(double side) { side_ = side; }
  /// Begins with less time, as energies are higher then: what rests cannot hold them still. Where L does not
  /// depend on t.
  void lengthen_by_stages() { least_energy_ = limits::gradient_flow::first_energy; }

 private:
  enum class Result { minimal, moved, failed };
  bool begin();
  bool evaluate();
  double value() const;
  void measure_mass();
  void measure_curvature();
  void shift_to(double reciprocal);
  bool factor();
  double solve();
  double slope() const;
  void apply(double factor);
  Result step();
  bool shorten_rest();
  bool redistribute();
  bool equalise_energies();
  bool lengthen();
  double lowest_eigenvalue();
  bool leave_saddle(double size, double least);

  const Problem& problem_;
  Path& path_;
  Workspace& w_;
  std::function<bool()> count_;
  const ElementTables& tables_;
  DiscreteAction& action_;
  NodeSystem system_;
  MonotoneCubic curve_;
  TimeLaw times_;
  Density density_;
  std::vector<double> mass_;  ///< n: of each coordinate, the mean along the path
  Step step_;
  Path saved_;
  double shift_ = 0;             ///< 1/τ that the equations of the nodes have now
  double wanted_ = 0;            ///< 1/τ of the next step
  double curvature_ = 0;         ///< bound of the negative curvature of L in q, by the mass
  double stiffness_ = 0;         ///< of the curvature in q, by the mass: the largest
  double softness_ = 0;          ///< the harmonic mean in time of the largest curvature at each node
  double range_ = 0, size_ = 0;  ///< of the path and of the last step
  double side_ = 1;
  double T_ = 0;             ///< wanted
  double least_energy_ = 0;  ///< of this stage, see TimeLaw; 0: of none
  bool staged_ = false;
  int rests_shortened_ = 0;
};

}  // namespace extremal
