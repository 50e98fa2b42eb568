#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "solve/adapt/workspace.hpp"

/// \file Minimisation of the action in windows.

namespace extremal {

/// Windows are as long as Cholesky's factorisation of the second variation with their ends held goes on. In
/// them Newton's step leads downhill and is shortened until the action falls (Armijo): with fixed ends and a
/// convex action there is one window, and this arrives from wherever the action is finite. Else the ends of
/// windows take a step towards stationarity of the whole when the windows are nearly minimal.
class Descent {
 public:
  /// `count` is called for each factorisation and says whether there may be more.
  Descent(Path& path, Workspace& workspace, std::function<bool()> count);

  /// Takes the path near an extremal on its elements: what is left of a step is at most `close` of the range.
  /// False if it does not arrive there, or if the action is not even convex over one element.
  bool run(const ElementTables& tables, double close);

 private:
  enum class Result { minimal, moved, failed };
  Result descend(const ElementTables& tables, double close);
  bool find_windows();
  void solve_windows();
  double slope();
  bool shorten(double slope, double before, double longest);

  Path& path_;
  Workspace& w_;
  std::function<bool()> count_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> factors_;  ///< of the pivot blocks of nodes 1 … N − 1
  std::vector<bool> held_;                            ///< those between windows
  Step step_;
  Path saved_;
};

}  // namespace extremal
