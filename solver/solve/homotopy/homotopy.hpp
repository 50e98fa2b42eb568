#pragma once

#include <functional>

#include "solve/adapt/workspace.hpp"
#include "solve/curve/arclength.hpp"
#include "solve/curve/move.hpp"
#include "solve/homotopy/comoving.hpp"

/// \file Continuation along a curve of extremals to one of the problem.

namespace extremal {

/// A path is taken along a curve of extremals, past folds, by pseudo-arclength. The parameter is zero where
/// an extremal belongs to the problem.
class Homotopy {
 public:
  virtual ~Homotopy() = default;

  /// Takes the path onward to where the parameter is zero again: nearly an extremal of the problem then.
  /// False where the curve does not come there.
  bool reach();
  /// Back to where the last reach() passed zero, after the workspace was used for something else.
  void resume();

  // The curve, see solve/curve/arclength.hpp.
  Move correction, direction;
  bool linearise(Factors factors);
  bool apply(const Move& move, double factor);
  double dot(const Move& a, const Move& b) const;
  double varied() const { return parameter(); }
  double change(bool along) const { return (along ? direction : correction).parameter; }
  bool goes_on() const { return steps_ < most_steps_; }
  void save();
  bool correct(const Move& tangent, double length);
  void refuse();

 protected:
  /// `count` is called for each factorisation and says whether there may be more; `unit` is the size of the
  /// parameter that counts as much as the extent of the path.
  Homotopy(Path& path, Workspace& workspace, std::function<bool()> count, double unit);

  /// All solutions of the linearised equations are correction + α·direction. False where they cannot be
  /// solved.
  virtual bool solve_linearised(Move& correction, Move& direction) = 0;
  virtual const Problem& problem() const = 0;
  virtual double parameter() const = 0;
  /// False if the parameter cannot have this value.
  virtual bool set_parameter(double value) = 0;
  /// Which way the first step goes along `direction`: the sign of the result.
  virtual double onward(const Move& direction) const = 0;

  Path& path_;
  Workspace& w_;

  /// Linearisations until the parameter must be zero: on the way to the problem, and from one extremal of it
  /// to the next.
  static constexpr int most_steps_there = 200, most_steps_on = 600;

  /// To be called with the path that the family begins near or on.
  bool begin(const ElementTables& tables, int most_steps);
  /// From a path nearby onto the family, by the shortest correction each time.
  bool approach();
  /// The tangent at the first point.
  bool find_tangent();

 private:
  bool land(double from);
  void polish();
  bool resolve();
  void restore();

  std::function<bool()> count_;
  const ElementTables* tables_ = nullptr;
  double unit_, scale_ = 1, first_scale_ = 1, farthest_ = 0;
  int most_steps_ = 0, steps_ = 0, saved_steps_ = 0;  ///< linearisations
  int refusals_ = 0;                                  ///< steps refused since the last that was not
  Comoving comoving_;
  ArclengthSteps<Move> along_;
  Path saved_, beyond_;
  double saved_parameter_ = 0, beyond_parameter_ = 0;
};

}  // namespace extremal
