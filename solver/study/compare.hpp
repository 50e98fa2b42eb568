#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/study.hpp"

/// \file Speed against error on a scene, beside shooting.

namespace extremal {

/// A method run at one tolerance.
struct ComparisonRow {
  std::string method;
  double tolerance = 0;
  double seconds = 0;           ///< median over repeated runs from the same guess
  std::optional<double> error;  ///< of q(t), in its units; absent without convergence or reference
  Status status = Status::not_converged;
};

struct Comparison {
  /// What errors are measured against: the scene solved to the tightest tolerance whose result integration
  /// verifies.
  struct Reference {
    double tolerance = 0, error_estimate = 0;
    double range = 0;  ///< largest range of a coordinate, that tolerances are relative to
  };
  std::string title;  ///< may be empty
  std::optional<Reference> reference;
  std::string message = "nothing has been compared";  ///< why there is no reference, or how good it is
  std::vector<ComparisonRow> rows;                    ///< method by method, from the loosest tolerance on

  /// Whether the error of a row is known.
  bool any() const;
};

struct CompareOptions {
  std::vector<double> tolerances = {1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13};
  double row_seconds = 0.05;  ///< of repetitions for a row; every row is run once at least
  std::function<void(const ComparisonRow&)> progress;
};

/// Solves the scene at each tolerance, with its own scheme if it names one, and by single and multiple
/// shooting from the same guess; shooting with many coordinates is left out. The budget of the study is
/// shared by the reference and the methods, and what one of them leaves goes to the next. Errors are the
/// largest at 401 equal times, and never below the reference's own; where shifts in time or symmetries change
/// nothing, after those that make them least. From initial data the march is compared with DOP853.
Comparison compare(const Study& study, const CompareOptions& options = {});

}  // namespace extremal
