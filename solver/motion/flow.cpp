#include "motion/flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "machine/largest.hpp"
#include "system/hamiltonian.hpp"

namespace extremal {

namespace {

constexpr int most_iterations = 60;
/// Of a step that leaves ∂L/∂q' further from p.
constexpr double least_part = 1e-10;
/// ∂L/∂q' agrees with p to roundoff.
constexpr double roundoff = 2e-15;
/// From below the first of these the next step of Newton ends in roundoff, which is then below the second.
constexpr double near = 1e-8, acceptable = 1e-12;
/// Velocities along a momentum are tried from this size to its reciprocal.
constexpr double smallest_start = 0x1p-40;
/// Of ∂²L/∂q'² at a velocity, what is left of one that vanishes at rest.
constexpr double degenerate = 1e-6;

double largest_entry(std::span<const Triplet> m) {
  double found = 0;
  for (const Triplet& entry : m) found = std::max(found, std::abs(entry.value));
  return found;
}

}  // namespace

bool Flow::suits(const Lagrangian& lagrangian, int copies) {
  const Structure& structure = lagrangian.structure();
  return !structure.quadratic ||
         MassMatrix(structure.coordinates / copies).factor(PointEvaluator(lagrangian, copies).constant_vv());
}

Flow::Flow(const Lagrangian& lagrangian, int copies)
    : n_(lagrangian.structure().coordinates / copies),
      structure_(lagrangian.structure()),
      point_(lagrangian, copies),
      mass_(n_),
      v_(n_, nearly_at_rest),
      residual_(n_),
      from_(n_),
      step_(n_) {
  if (const Lagrangian* hamiltonian = hamiltonian_of(lagrangian))
    hamiltonian_ = std::make_unique<PointEvaluator>(*hamiltonian);
  if (structure_.quadratic && !mass_.factor(point_.constant_vv()))
    throw std::invalid_argument("the mass matrix of the Lagrangian is singular");
}

bool Flow::momentum(std::span<const double> q, std::span<const double> v, double t, std::span<double> p) {
  std::copy(v.begin(), v.end(), v_.begin());
  if (!point_.evaluate(q, v, t, Order::gradient)) return false;
  std::copy(point_.dv().begin(), point_.dv().end(), p.begin());
  return true;
}

/// Either leaves q' in v_, and in point_ the derivatives of L there up to `order`.
bool Flow::solve_velocity(std::span<const double> q, std::span<const double> p, double t, Order order) {
  if (structure_.quadratic) return solve_linear(q, p, t, order);
  // A state far off the motion must not spoil what the next search begins from.
  last_v_ = v_;
  if (!solve_newton(q, p, t)) {
    // Where momenta have a bound, they hardly depend on a velocity that is too fast: no step leads back.
    std::ranges::fill(v_, nearly_at_rest);
    if (hamiltonian_ || !(solve_newton(q, p, t) || (begin_along(q, p, t) && solve_newton(q, p, t)))) {
      v_ = last_v_;
      return false;
    }
  }
  return order != Order::hessian || (point_.evaluate(q, v_, t, order) && mass_.factor(point_.vv()));
}

/// Where ∂²L/∂q'² vanishes at rest, as that of q'⁴, no step leads from there. The velocity along p whose
/// momentum is about as large is left in v_; false if there is none, or if it does not vanish.
bool Flow::begin_along(std::span<const double> q, std::span<const double> p, double t) {
  std::ranges::fill(v_, nearly_at_rest);
  if (!point_.evaluate(q, v_, t, Order::hessian)) return false;
  const double at_rest = largest_entry(point_.vv()), momentum = largest(p);
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (double size = smallest_start; momentum > 0 && size <= 1 / smallest_start; size *= 2) {
    for (int a = 0; a < n_; ++a) v_[a] = size * p[a] / momentum;
    const double error = momentum_error(q, p, t);
    if (!(error < least)) continue;
    least = error;
    best = size;
  }
  for (int a = 0; a < n_; ++a) v_[a] = best * p[a] / momentum;
  return least < momentum && point_.evaluate(q, v_, t, Order::hessian) &&
         at_rest < degenerate * largest_entry(point_.vv());
}

/// p = M q' + C q + a.
bool Flow::solve_linear(std::span<const double> q, std::span<const double> p, double t, Order order) {
  std::copy(p.begin(), p.end(), v_.begin());
  for (const Triplet& c : point_.constant_vq()) v_[c.row] -= c.value * q[c.column];
  for (std::size_t a = 0; a < point_.linear().size(); ++a) v_[a] -= point_.linear()[a];
  mass_.solve(v_);
  return point_.evaluate(q, v_, t, order);
}

/// ∂H/∂p, where that is known; else Newton from the last velocity, one step where L is quadratic in q'. A
/// step is shortened until ∂L/∂q' comes nearer to p: velocities may have a bound, at which momenta have none.
bool Flow::solve_newton(std::span<const double> q, std::span<const double> p, double t) {
  if (hamiltonian_) {
    if (!hamiltonian_->evaluate(q, p, t, Order::gradient)) return false;
    v_ = hamiltonian_->dv();
    return point_.evaluate(q, v_, t, Order::gradient);
  }
  double error = momentum_error(q, p, t), before = std::numeric_limits<double>::infinity();
  if (!std::isfinite(error)) {
    std::ranges::fill(v_, nearly_at_rest);
    error = momentum_error(q, p, t);
  }
  const double momentum = largest(p);
  double fastest = 0;  // so far: at rest p and q' vanish
  const auto agrees = [&](double scale) {
    return error <= roundoff * scale || (before <= near * scale && error <= acceptable * scale);
  };
  for (int i = 0; i < most_iterations && std::isfinite(error); ++i) {
    if (agrees(momentum)) return true;
    if (!point_.evaluate(q, v_, t, Order::hessian) || !mass_.factor(point_.vv())) return false;
    fastest = std::max(fastest, largest(v_));
    const double scale = momentum + mass_.largest() * fastest;
    if (agrees(scale)) return true;
    before = error;
    from_ = v_;
    step_ = residual_;
    mass_.solve(step_);
    const auto closer = [&] { return error < before || error <= acceptable * scale; };
    for (double part = 1; part > least_part; part /= 4) {
      for (int a = 0; a < n_; ++a) v_[a] = from_[a] + part * step_[a];
      error = momentum_error(q, p, t);
      if (closer()) break;
    }
    if (!closer()) return false;
  }
  return false;
}

/// By how much ∂L/∂q' at v_ is off p; not finite where L is not. Leaves the derivatives of L in point_.
double Flow::momentum_error(std::span<const double> q, std::span<const double> p, double t) {
  if (!point_.evaluate(q, v_, t, Order::gradient)) return std::numeric_limits<double>::quiet_NaN();
  for (int a = 0; a < n_; ++a) residual_[a] = p[a] - point_.dv()[a];
  return largest(residual_);
}

bool Flow::velocity(std::span<const double> q, std::span<const double> p, double t, std::span<double> v) {
  if (!solve_velocity(q, p, t, Order::gradient)) return false;
  std::copy(v_.begin(), v_.end(), v.begin());
  return true;
}

bool Flow::motion(double t, std::span<const double> y, std::span<double> slope, Order order) {
  if (!solve_velocity(y.first(n_), y.subspan(n_, n_), t, order)) return false;
  std::copy(v_.begin(), v_.end(), slope.begin());
  std::copy(point_.dq().begin(), point_.dq().end(), slope.begin() + n_);
  return true;
}

bool Flow::slope(double t, std::span<const double> y, std::span<double> slope) {
  return motion(t, y, slope, Order::gradient);
}

bool Flow::slope_with_variations(double t, std::span<const double> y, std::span<double> slope) {
  if (!motion(t, y, slope, Order::hessian)) return false;
  for (std::size_t begin = 2 * n_; begin < y.size(); begin += 2 * n_) {
    const auto dq = y.subspan(begin, n_), dp = y.subspan(begin + n_, n_);
    const auto dv = slope.subspan(begin, n_), force = slope.subspan(begin + n_, n_);
    std::copy(dp.begin(), dp.end(), dv.begin());
    for (const Triplet& e : point_.vq()) dv[e.row] -= e.value * dq[e.column];
    mass_.solve(dv);
    std::fill(force.begin(), force.end(), 0.0);
    for (const Triplet& e : point_.qq()) force[e.row] += e.value * dq[e.column];
    for (const Triplet& e : point_.qv()) force[e.row] += e.value * dv[e.column];
  }
  return true;
}

}  // namespace extremal
