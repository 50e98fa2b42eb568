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

/// An end of an element at which the path crosses a surface u(q, t) = 0, or a jump in t. Beside it
///   L = smooth part + w |u| + a sign u,   a = 0 along the path,
/// and with n = ∂u/∂q, from u < 0 to u > 0, ∂L/∂q jumps by J = 2 (w n + ∂a/∂q). A change δq at the node moves
/// the crossing by δt = −(u + n·δq)/u', and for δt the force is that of the other side. To first order that
/// adds J (u + n·δq)/|u'| to δS at the node. The second variation of w |u| + a sign u is
///   ∫ 2 δ(u) (n·δq) (w n + 2 ∂a/∂q)·δq dt = stiffness (n·δq)² + 2 (b·δq)(n·δq),
/// with stiffness = 2 w/|u'| and b = 2 ∂a/∂q/|u'|.
struct Corner {
  int node = 0;
  double u = 0, rate = 0;  ///< u there, du/dt
  double stiffness = 0;
  std::vector<double> normal;    ///< n
  std::vector<double> sideways;  ///< b, across n
};

/// The nodes between elements at which u changes its sign, u being so small there that no quadrature point
/// (Gauss's, of as many points as the degree) is on the wrong side. Surfaces that depend on velocities are
/// left out. A path that is `closed`, unless that is null, goes on beyond T: then T may be such a node too.
std::vector<Corner> corners_of(const Kinks& kinks, const Polynomials& path, const ClosingMap* closed);
std::vector<Corner> corners_of(const Kinks& kinks, const Path& path, const ClosingMap* closed);

/// A node at which the path crosses a surface u(q, q', t) = 0 that depends on velocities. A node alone does
/// not tell how the crossing moves.
struct Switch {
  int node = 0;
  std::vector<double> q, v;  ///< n, where u = 0
  double t = 0;
  std::vector<double> by_q, by_v;  ///< n, slopes of u
  double by_t = 0;
  double before = 0;         ///< u within the element before
  std::vector<double> jump;  ///< n, of ∂L/∂q, from before to after

  /// Velocities with which u has this value, to first order.
  std::vector<double> velocity_at(double u) const;
};
std::vector<Switch> switches_of(const Kinks& kinks, const Polynomials& path, const ClosingMap* closed);

/// Moves the mesh nodes of a path, of which these were the corners, to where a step of its nodes, (N + 1) ×
/// n, that was taken by `factor`, has taken u along them: u + ∂u/∂q δq + u' δt = 0. Where surfaces share a
/// node, to the mean of their times; T does not move. Where that is far for the elements beside a node, the
/// nodes up to the next corner follow. False, and nothing is done, where Path::slide() does
/// nothing.
bool move_corners(Path& path, std::span<const Corner> corners, std::span<const double> node_step,
                  double factor);

/// Whether forces jump at one of these corners.
bool forces_jump(std::span<const Corner> corners);

/// Adds the force of a corner if u is as given, n.
void add_force(const Corner& corner, double u, double* gradient);
/// Adds the matrix of a corner, n × n.
void add_stiffness(const Corner& corner, double* block);

/// Times in (0, T), ascending, at which a path crosses a surface.
std::vector<double> crossings(const Kinks& kinks, const Polynomials& path);
/// The same of a path, in t/T.
std::vector<double> crossings(const Kinks& kinks, const Path& path);

}  // namespace extremal
