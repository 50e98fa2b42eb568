#pragma once

#include <functional>
#include <vector>

#include "solve/adapt/workspace.hpp"

/// \file Newton's method kept away from extremals that are known.

namespace extremal {

/// Newton's method for m(x)·δS_h(x) = 0, where m = Π_i (1/|x − x_i|² + 1) grows without bound at the
/// extremals x_i that are known (Farrell, Birkisson, Funke, Deflation techniques for finding distinct
/// solutions of nonlinear partial differential equations, SIAM J. Sci. Comput. 37, 2015). By the formula of
/// Sherman and Morrison its step is a multiple of the plain step d,
///   τ d,   τ = 1/(1 − ∇ log m · d),
/// and costs no more. |x| is the root mean square over the nodes, by the extent of the path, and T by T.
class DeflatedNewton {
 public:
  DeflatedNewton(const Problem& problem, Path& path, Workspace& workspace, std::function<bool()> count);

  /// Takes the path to where plain Newton steps are short. False if it does not come there.
  bool run(const ElementTables& tables, const std::vector<Solution>& known);

 private:
  /// The plain step.
  bool solve();
  void sample(const std::vector<Solution>& known);
  double dot(const std::vector<double>& nodes, const std::vector<double>& others) const;
  double stretch(const Step& step);

  const Problem& problem_;
  Path& path_;
  Workspace& w_;
  std::function<bool()> count_;
  struct Known {
    std::vector<double> nodes;
    double duration;
  };
  std::vector<Known> known_;  ///< of the known extremals
  std::vector<double> away_;
  double scale_ = 1;
  Step step_;
};

}  // namespace extremal
