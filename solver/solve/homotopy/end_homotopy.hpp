#pragma once

#include <vector>

#include "solve/homotopy/homotopy.hpp"

/// \file Extremals by continuation from those with other ends.

namespace extremal {

/// The shortest displacement of the ends (2n) that changes one row of the relation, by 1.
std::vector<double> unit_displacement(const BoundaryRelation& relation, int row);

/// Extremals whose ends, moved back by the parameter times a displacement, satisfy the boundary relation.
/// With one coordinate and fixed ends, one of which is displaced, all extremals of the problem lie on one
/// such curve, which the velocity at the other end parametrises.
class EndHomotopy : public Homotopy {
 public:
  /// A displacement (2n) of which `unit` is about the extent of a path.
  EndHomotopy(const Problem& problem, Path& path, Workspace& workspace, std::function<bool()> count,
              std::vector<double> displacement, double unit);

  /// Takes the path, whose ends are displaced by `parameter`, onto the family and along it to the
  /// problem's ends. False if it does not end there.
  bool trace(const ElementTables& tables, double parameter);
  /// From an extremal of the problem along the displacement or against it. False if it cannot set out.
  bool leave(const ElementTables& tables, bool along);

 private:
  bool solve_linearised(Move& correction, Move& direction) override;
  void sample_displacement(std::size_t inner);
  const Problem& problem() const override { return problem_; }
  double parameter() const override { return parameter_; }
  bool set_parameter(double value) override;
  double onward(const Move&) const override { return sense_ != 0 ? sense_ : -parameter_; }

  const Problem& problem_;
  std::vector<double> ends_;  ///< the displacement
  double unit_, parameter_ = 0, sense_ = 0;
  Path at_;
  Step displacement_;  ///< of the path's nodes, linear in t
};

}  // namespace extremal
