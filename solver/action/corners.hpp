#pragma once

#include <span>
#include <vector>

#include "action/path.hpp"
#include "problem/closing.hpp"
#include "system/kinks.hpp"

/// \file Where a path crosses the surfaces on which L is not smooth. Elements end there, at times that are
/// unknowns: each is closed by u(q(t), t) = 0.

namespace extremal {

/// A piecewise polynomial path by its values at the Lobatto nodes of each element.
struct Polynomials {
  int coordinates = 0, degree = 0;
  std::span<const double> times;  ///< N + 1 ends of elements
  std::span<const double> nodes;  ///< [(k*(s + 1) + j)*n + a]
  int elements() const { return static_cast<int>(times.size()) - 1; }
};

/// An end of an element at which the path crosses a surface, or a jump in t. With J = 2 w ∂u/∂q sign(u') the
/// jump of ∂L/∂q, a change δq at the node moves the crossing by δt = −(u + ∂u/∂q δq)/u', and for δt the force
/// J is that of the other side. To first order that adds to δS at the node
///   stiffness · normal (u + normal·δq),   stiffness = 2 w/|u'|,   normal = ∂u/∂q,
/// and this is the second variation of w |u| there: ∫ 2w δ(u) (normal·δq)² dt.
struct Corner {
  int node = 0;
  double u = 0, rate = 0;  ///< u there, du/dt
  double stiffness = 0;
  std::vector<double> normal;  ///< n
};

/// The nodes between elements at which u changes its sign, u being so small there that no quadrature point
/// (Gauss's, of as many points as the degree) is on the wrong side. Surfaces that depend on velocities are
/// left out. A path that is `closed`, unless that is null, goes on beyond T: then T may be such a node too.
std::vector<Corner> corners_of(const Kinks& kinks, const Polynomials& path, const ClosingMap* closed);
std::vector<Corner> corners_of(const Kinks& kinks, const Path& path, const ClosingMap* closed);

/// Moves the mesh nodes of a path, of which these were the corners, to where a step of its nodes, (N + 1) ×
/// n, that was taken by `factor`, has taken u along them: u + ∂u/∂q δq + u' δt = 0. Where surfaces share a
/// node, to the mean of their times; T does not move. Where that is far for the elements beside a node, the
/// nodes up to the next corner follow. False, and nothing is done, where Path::slide() does
/// nothing.
bool move_corners(Path& path, std::span<const Corner> corners, std::span<const double> node_step,
                  double factor);

/// Adds the matrix of a corner, n × n.
void add_stiffness(const Corner& corner, double* block);

/// Times in (0, T), ascending, at which a path crosses a surface.
std::vector<double> crossings(const Kinks& kinks, const Polynomials& path);
/// The same of a path, in t/T.
std::vector<double> crossings(const Kinks& kinks, const Path& path);

}  // namespace extremal
