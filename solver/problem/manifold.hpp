#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "system/lagrangian.hpp"

/// \file The manifold of holonomic constraints g(q, t) = 0, and the motion on it.

namespace extremal {

struct MinimalProblem;

/// Constraints and their derivatives at a point.
struct ConstraintValues {
  Eigen::VectorXd g;       ///< m
  Eigen::MatrixXd slopes;  ///< G = ∂g/∂q, m × n
  Eigen::VectorXd rates;   ///< ∂g/∂t
};

/// Immutable. A point has n coordinates; see system/constraints.hpp.
class Manifold {
 public:
  struct Parts {
    std::shared_ptr<const Lagrangian> lagrangian;  ///< L as it is written
    std::shared_ptr<const Lagrangian> timed;       ///< with t as one more coordinate
    std::shared_ptr<const Lagrangian> forms;       ///< Σ μ_k g_k in (q, t, μ)
    Eigen::MatrixXd metric;                        ///< W, n × n
    double rate = 0;                               ///< ω
    /// With forces: of two copies of L (system/copies.hpp). Null: there are none.
    std::shared_ptr<const Lagrangian> copies = nullptr;
    /// The problem in minimal coordinates; null where it has none.
    std::shared_ptr<const MinimalProblem> minimal = nullptr;
    bool only_minimal = false;  ///< L̃ has other natural conditions
  };
  explicit Manifold(Parts parts) : parts_(std::move(parts)) {}

  const Parts& parts() const { return parts_; }
  int coordinates() const { return parts_.lagrangian->structure().coordinates; }
  int constraints() const { return parts_.forms->structure().coordinates - coordinates() - 1; }
  const Lagrangian& lagrangian() const { return *parts_.lagrangian; }
  const Eigen::MatrixXd& metric() const { return parts_.metric; }
  double rate() const { return parts_.rate; }
  /// Neither L nor the constraints depend on t.
  bool autonomous() const;

  ConstraintValues at(std::span<const double> q, double t) const;

  /// Whether the gradients of the constraints at a point are independent.
  bool regular(std::span<const double> q, double t) const;

  /// Moves a point along W Gᵀ onto the manifold, to roundoff. False, and the point is anywhere, if the
  /// iteration does not converge.
  bool project(std::span<double> q, double t) const;
  /// Changes q' along W Gᵀ so that G q' + ∂g/∂t = 0.
  void make_tangent(std::span<const double> q, double t, std::span<double> v) const;
  /// |g| as a distance, in the units of q: the step of one iteration onto the manifold.
  double distance(std::span<const double> q, double t) const;

  /// The largest radius of curvature of a constraint at a point, |∂g/∂q| over |∂²g/∂q²|; 0 of planes. Terms
  /// of g that cancel are that large, wherever the origin is.
  double radius(std::span<const double> q, double t) const;

  /// The projection (∂P/∂x)ᵀ p of a momentum, which L̃ has where L has p.
  std::vector<double> projected_momentum(std::span<const double> q, double t,
                                         std::span<const double> p) const;
  /// The inverse: p = ∂L/∂q' of the velocity, tangent to the manifold, whose p has this projection. `v` is
  /// where the search begins; it becomes that velocity.
  std::vector<double> momentum(std::span<const double> q, double t, std::span<const double> projection,
                               std::span<double> v) const;
  /// ∂L/∂q'.
  std::vector<double> momentum(std::span<const double> q, double t, std::span<const double> v) const;
  /// p·q' − L.
  double energy(std::span<const double> q, double t, std::span<const double> v) const;

  /// λ of d/dt ∂L/∂q' − ∂L/∂q = F + Gᵀ λ along the motion with this state.
  std::vector<double> multipliers(std::span<const double> q, double t, std::span<const double> v) const;

 private:
  Eigen::VectorXd force(std::span<const double> q, double t, std::span<const double> v) const;
  Eigen::VectorXd step_onto(std::span<const double> q, const ConstraintValues& values) const;
  Eigen::VectorXd normal_step(const ConstraintValues& values, const Eigen::VectorXd& g) const;

  Parts parts_;
};

}  // namespace extremal
