#pragma once

#include <span>
#include <vector>

#include "solve/mesh/mesh.hpp"
#include "solve/mesh/resolution.hpp"

/// \file The elements that a tolerance needs, from how well others resolve the path.

namespace extremal {

/// Elements of one degree on a mesh.
struct Plan {
  int degree = 0;            ///< 0: none within the limits
  std::vector<double> mesh;  ///< empty: the one there is
};

/// The aim of a plan, and its limits.
struct PlanLimits {
  Resolution::Error aim;  ///< expected of the elements
  Resolution::Error
      tolerated;      ///< by a higher degree on the mesh there is, where the aim takes too high a one
  int raised_degree;  ///< at least, on the mesh there is
  int least_degree, highest_degree;  ///< on another mesh; the highest on any
  int most_elements;
  double strongest_cut;         ///< an element becomes at most so many
  double strongest_growth = 1;  ///< and nodes lie at most so many times farther apart than they do
};

/// The cheapest elements whose expected error is aimed at. On an element of length h the coefficients fall by
///   f = 1/(y + √(1 + y²)),   y = 2d/h,
/// where d is the distance in complex time to the nearest singularity of the path (the sum of half-axes of
/// the largest ellipse around the element without one). So a tail (size, f, h) gives d, which changes
/// along the path by no more than t does, and d gives the h' that another degree needs.
class Planner {
 public:
  /// `mesh` and `tables` are those of the path that was measured.
  Plan plan(const Resolution& resolution, std::span<const double> mesh, const ElementTables& tables,
            const PlanLimits& limits);

 private:
  struct ElementDecay {
    double h, distance, log_reach, log_size;  ///< log of the coefficients extrapolated to k = 0
  };
  /// Of the coefficient that elements of a degree leave out, at most: for q, and for q' by their length.
  struct Goal {
    int degree;
    double log_q, log_v;
  };
  static Goal goal(int degree, const PlanLimits& limits);
  void locate(const Resolution& resolution);
  double length(const ElementDecay& decay, const Goal& goal, const PlanLimits& limits) const;
  double elements(int degree, const PlanLimits& limits) const;

  int degree_ = 0;  ///< of the elements that were measured
  std::vector<ElementDecay> decays_;
  Density density_;
};

/// Nanoseconds, roughly, of one Newton step on eight elements of `degree`, from tables of any degree:
/// assembly, elimination of the inner unknowns, whose work grows with the cube of the degree, and the nodes
/// between.
double batch_cost(const ElementTables& tables, int degree);

}  // namespace extremal
