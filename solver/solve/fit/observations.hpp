#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "action/path.hpp"
#include "machine/aligned.hpp"
#include "solution/solution.hpp"
#include "solve/fit/response.hpp"
#include "system/lagrangian.hpp"

/// \file What was observed of a motion, beside what is computed.

namespace extremal {

/// One value, in the row of its time.
struct ObservedValue {
  int row = 0;
  double value = 0, sigma = 1;
};

enum class Observable { coordinate, velocity, formula };

/// One kind of observation.
struct ObservedColumn {
  std::string name;
  Observable kind = Observable::coordinate;
  int index = 0;  ///< of the coordinate, or of the formula among those of the fit
  /// Of an angle, whose values differ by less than half of it from those that are computed; 0: it is none.
  double turn = 0;
  std::vector<ObservedValue> values;
};

struct Observations {
  std::vector<double> t;  ///< one each row, in any order
  std::vector<ObservedColumn> columns;
  bool sigmas = false;  ///< some column has standard deviations of its own
  int count() const;    ///< of all values
  double size() const;  ///< the root of Σ (value/σ)²
};

/// Formulas of observations: functions of q, q', t and active parameters, which Lagrangian describes.
using ObservedFormulas = std::vector<std::shared_ptr<const Lagrangian>>;

/// Computes observations along paths, and what they change by with the path. A path may have more coordinates
/// than are observed: copies, of which the first is.
class Observer {
 public:
  /// `data` must outlive it.
  Observer(const Observations& data, int coordinates);

  int count() const { return count_; }

  /// (observed − computed)/σ of every value, column by column. False if one is not finite.
  bool residuals(const Path& path, const ObservedFormulas& formulas, std::span<double> to);
  /// Their derivatives where residuals() was called last: by a step of that path and what else changes.
  /// Entries are `stride` apart.
  void derivatives(const Path& path, const ElementTables& tables, const ObservedFormulas& formulas,
                   const Step& step, const ProblemChange& change, double* to, std::ptrdiff_t stride);

 private:
  void place(const Path& path);
  void sample(const Trajectory& trajectory, AlignedDoubles& q, AlignedDoubles& v);
  void accelerate(const Trajectory& trajectory);
  void gradients(const ObservedFormulas& formulas);
  double* row(AlignedDoubles& of, int a) { return of.data() + static_cast<std::size_t>(a) * stride_; }

  const Observations& data_;
  int n_, rows_, stride_, count_;
  std::vector<double> mesh_;  ///< on which places are known, and the duration
  double duration_ = 0;
  std::vector<int> element_;        ///< in which each time lies
  std::vector<double> basis_;       ///< at each time: values, then derivatives
  int degree_ = 0, width_ = 0;      ///< of the basis; coordinates of the path
  AlignedDoubles t_, q_, v_, a_;    ///< rows of all times; q'' where T changes
  AlignedDoubles dq_, dv_;          ///< what they change by
  std::vector<AlignedDoubles> by_;  ///< of each formula, 2n rows: by q, by q'
  bool gradients_known_ = false, accelerations_known_ = false;
  AlignedDoubles out_;
  Scratch scratch_;
};

}  // namespace extremal
