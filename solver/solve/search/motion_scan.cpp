#include "solve/search/motion_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/dense.hpp"
#include "motion/flow.hpp"
#include "motion/sample.hpp"
#include "problem/manifold.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/search/arrivals.hpp"
#include "solve/search/from_motions.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::from_motions;

/// The derivative of q'·∂L/∂q' − L by the logarithm of the scale is q'·(∂²L/∂q'∂q')q'.
bool scale_to_energy(const Lagrangian& lagrangian, std::span<const double> q, double energy,
                     std::span<double> v) {
  Scratch scratch;
  const std::size_t n = v.size();
  for (int step = 0; step < most_energy_steps; ++step) {
    const PointValues at = evaluate_at(lagrangian, q, v, 0, Order::hessian, scratch);
    double excess = -at.value - energy, size = std::abs(at.value) + std::abs(energy), slope = 0;
    for (std::size_t a = 0; a < n; ++a) {
      excess += v[a] * at.dv[a];
      size += std::abs(v[a] * at.dv[a]);
      for (std::size_t b = 0; b < n; ++b) slope += v[a] * at.vv[a * n + b] * v[b];
    }
    if (std::abs(excess) <= energy_error * size) return true;
    if (!(slope > 0) || !std::isfinite(excess)) return false;
    const double scale = std::max(0.1, 1 - excess / slope);
    for (double& x : v) x *= scale;
  }
  return false;
}

Guess motion_from(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
                  double duration, double step_error, const std::function<bool()>& count) {
  const auto more = [&count](int steps) {
    return steps < most_integrator_steps && (steps % steps_a_count > 0 || count());
  };
  SampledMotion samples;
  if (!sample_motion<double>(Flow(lagrangian), q, v, 0, duration,
                             {step_error, samples_a_step, duration, more}, samples))
    return {};
  return {std::move(samples.tau), std::move(samples.q), samples_a_step};
}

MotionScan::MotionScan(Pursuit& pursuit, const GuessMesh& guess)
    : problem_(pursuit.problem), pursuit_(pursuit), guess_(guess) {
  const Problem& problem = problem_;
  const Duration& given = problem.duration;
  usable_ = !problem.periodic && problem.ends.free == 0 && (!given.free || given.energy) &&
            problem.coordinates() <= most_scanned && Flow::suits(*problem.lagrangian);
  if (!usable_) return;
  const int n = problem.coordinates();
  const std::vector<double> ends = starting_ends(problem);
  start_ = Eigen::Map<const Eigen::VectorXd>(ends.data(), n);
  const Eigen::VectorXd v = (Eigen::Map<const Eigen::VectorXd>(ends.data() + n, n) - start_) / given.value;
  Scratch scratch;
  const PointValues at = evaluate_at(*problem.lagrangian, {start_.data(), std::size_t(n)},
                                     {v.data(), std::size_t(n)}, 0, Order::hessian, scratch);
  const Eigen::Map<const Eigen::MatrixXd> mass(at.vv.data(), n, n);
  root_ = inverse_root_ = Eigen::MatrixXd::Identity(n, n);
  flow_.emplace(*problem.lagrangian);
  rest_ = momentum(Eigen::VectorXd::Zero(n));
  if (!rest_.allFinite()) rest_.setZero();
  if (!mass.allFinite()) return;
  const SymmetricEigen eigen = symmetric_eigen(mass);
  if (!(eigen.values.minCoeff() > 0)) return;
  const Eigen::VectorXd roots = eigen.values.cwiseSqrt();
  root_ = eigen.vectors * roots.asDiagonal() * eigen.vectors.transpose();
  inverse_root_ = eigen.vectors * roots.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
  find_tangents(ends.data() + n);
}

/// Motions of L̃ keep to the manifold only if they begin on it with a velocity along it: G q' = 0, and so
/// G root⁻¹ w = 0 where momenta are linear in velocities and constraints are fixed in time.
void MotionScan::find_tangents(const double* last) {
  const auto n = static_cast<std::size_t>(start_.size());
  if (!problem_.manifold) {
    tangents_.start = tangents_.end = Eigen::MatrixXd::Identity(start_.size(), start_.size());
    return;
  }
  const auto at = [&](const double* q) {
    const ConstraintValues values = problem_.manifold->at({q, n}, 0);
    return values.rates.isZero(0) ? values.slopes : Eigen::MatrixXd();
  };
  const Eigen::MatrixXd start = at(start_.data()), end = at(last);
  if (start.size() == 0 || end.size() == 0) return;
  const Eigen::MatrixXd along = complement((start * inverse_root_).transpose());
  for (Eigen::Index k = 0; k < along.cols(); ++k) {
    const Eigen::VectorXd v = velocity(along.col(k));
    const double off = (start * v).norm();
    if (!(off <= off_manifold * start.norm() * v.norm())) return;
  }
  tangents_ = {along, orthonormal(root_ * complement(end.transpose()))};
}

/// p at the start; not finite where L is not.
Eigen::VectorXd MotionScan::momentum(const Eigen::VectorXd& v) {
  Eigen::VectorXd p(v.size());
  if (!flow_->momentum(span_of(start_), span_of(v), 0, span_of(p))) p.setConstant(NAN);
  return p;
}

Eigen::VectorXd MotionScan::unknown(const Eigen::VectorXd& v) {
  return inverse_root_ * (momentum(v) - rest_);
}

/// q' at the start; not finite where none belongs to w.
Eigen::VectorXd MotionScan::velocity(const Eigen::VectorXd& w) {
  const Eigen::VectorXd p = rest_ + root_ * w;
  Eigen::VectorXd v(w.size());
  if (!flow_->velocity(span_of(start_), span_of(p), 0, span_of(v))) v.setConstant(NAN);
  return v;
}

double MotionScan::reach_of(const Solution& solution) {
  if (problem_.duration.free) return solution.duration();
  Eigen::VectorXd q(start_.size()), v(start_.size());
  solution.trajectory.at(0, {q.data(), std::size_t(q.size())}, span_of(v));
  return unknown(v).norm();
}

double MotionScan::least_reach(double extent) const {
  return problem_.duration.free ? 0 : root_.norm() * extent / problem_.duration.value;
}

/// In (0, 1).
double MotionScan::unit() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }

/// Of length one, all alike: normal numbers (Box and Muller).
Eigen::VectorXd MotionScan::direction() {
  const bool along = tangents_.start.cols() > 0;
  Eigen::VectorXd u(along ? tangents_.start.cols() : start_.size());
  do
    for (double& x : u) x = std::sqrt(-2 * std::log(unit())) * std::cos(2 * std::numbers::pi * unit());
  while (!(u.norm() > 0));
  return along ? tangents_.start * u.normalized() : u.normalized();
}

/// At a kink of L a curve has no tangent. With one coordinate the end alone is a condition on the start.
bool MotionScan::has_curves() const {
  const auto dimensions = tangents_.start.cols();
  return usable_ && !problem_.lagrangian->kinks() &&
         (dimensions == 2 || (dimensions == 1 && (problem_.duration.free || problem_.manifold)));
}

double MotionScan::slowest() {
  const auto n = static_cast<std::size_t>(start_.size());
  const Lagrangian& lagrangian = *problem_.lagrangian;
  if (problem_.duration.free || !lagrangian.structure().autonomous) return 0;
  const std::vector<double>& ends = guess_.ends();
  const std::vector<double> rest(n, 0);
  Scratch scratch;
  const std::span<const double> from = std::span(ends).first(n), to = std::span(ends).subspan(n, n);
  const double needed = -evaluate_at(lagrangian, to, rest, 0, Order::value, scratch).value;
  const double at_rest = -evaluate_at(lagrangian, from, rest, 0, Order::value, scratch).value;
  if (!(needed > at_rest)) return 0;
  double least = INFINITY;
  for (int k = 0; k < directions_tried; ++k) {
    const double angle = 2 * std::numbers::pi * k / directions_tried;
    Eigen::VectorXd direction = Eigen::VectorXd::Constant(1, k % 2 == 0 ? 1 : -1);
    if (tangents_.start.cols() == 2) direction = Eigen::Vector2d(std::cos(angle), std::sin(angle));
    Eigen::VectorXd v = inverse_root_ * (tangents_.start * direction) * std::sqrt(2 * (needed - at_rest));
    if (!scale_to_energy(lagrangian, from, needed, {v.data(), n})) return 0;
    least = std::min(least, unknown(v).norm());
  }
  return least;
}

bool MotionScan::all(double nearest, double farthest, const std::function<bool(int steps)>& more,
                     const std::function<void(const Guess& motion, double duration)>& visit) {
  const auto n = static_cast<std::size_t>(start_.size());
  const Lagrangian& lagrangian = *problem_.lagrangian;
  const Duration& given = problem_.duration;
  const auto scale = [&](Eigen::VectorXd& w) {
    Eigen::VectorXd v = velocity(w);
    if (!scale_to_energy(lagrangian, span_of(start_), *given.energy, {v.data(), n})) return false;
    w = unknown(v);
    return w.allFinite();
  };
  const bool first = !arrivals_;
  if (first) {
    const Eigen::VectorXd end = Eigen::Map<const Eigen::VectorXd>(guess_.ends().data() + n, start_.size());
    double speed = farthest;
    if (given.free) {
      Eigen::VectorXd w = tangents_.start.col(0);
      if (!scale(w)) return false;
      speed = w.norm();
    }
    arrivals_ =
        std::make_unique<Arrivals>(lagrangian, start_, rest_, end, root_, tangents_, speed, given.value);
  }
  arrivals_->count_by(more);
  const auto take = [&](const Arrivals::Arrival& arrival) {
    const Eigen::VectorXd v = velocity(arrival.w);
    const Guess motion = motion_from(lagrangian, {start_.data(), n}, {v.data(), n}, arrival.time,
                                     limits::arrivals::step_error_arriving, [] { return true; });
    if (motion.given()) visit(motion, arrival.time);
  };
  if (given.free) {
    for (const Arrivals::Arrival& arrival : arrivals_->sweep(1, farthest, scale)) take(arrival);
    return more(0);
  }
  const bool one = tangents_.start.cols() == 1;
  const int levels = (first ? first_levels : further_levels) * (one ? denser_in_one : 1);
  // Slow motions fall into what attracts them, and take most steps: so the fast ones come first, and no level
  // takes the steps of all. Those slower than all that arrive need not be looked at to the end.
  bool complete = true, arrived = false;
  // Where motions do not last, others may be missing, and curves may not end.
  int vain_steps = 0;
  const auto follow = [&](int steps) {
    vain_steps += steps;
    return more(steps) && (vain_steps < most_vain_steps || arrivals_->all_last());
  };
  for (int k = levels - 1; k >= 0 && follow(0); --k) {
    // Denser towards the least energies, where motions take longest.
    const double root_part = (k + 0.5) / levels, part = root_part * root_part;
    const double speed = std::sqrt(nearest * nearest + part * (farthest * farthest - nearest * nearest));
    int steps_here = 0;
    arrivals_->count_by([&](int steps) {
      steps_here += steps;
      return follow(steps) && steps_here < most_sweep_steps;
    });
    const std::vector<Arrivals::Arrival> seeds = arrivals_->sweep(speed, seed_until * given.value);
    complete = complete && (steps_here < most_sweep_steps || (arrived && seeds.empty()));
    arrived = arrived || !seeds.empty();
    arrivals_->count_by(follow);
    for (const Arrivals::Arrival& seed : seeds)
      if (follow(0) && !arrivals_->followed(seed))
        for (const Arrivals::Arrival& arrival :
             arrivals_->along(seed, follow_beyond * farthest, follow_until * given.value)) {
          take(arrival);
          vain_steps = 0;
        }
  }
  return more(0) && complete && arrivals_->all_last();
}

bool MotionScan::next(double reach) {
  const auto n = static_cast<std::size_t>(start_.size());
  const Duration& given = problem_.duration;
  const double part = given.free ? unit() : std::pow(unit(), 1.0 / std::min<double>(n, most_dimensions));
  Eigen::VectorXd v = given.free ? inverse_root_ * direction() : velocity(part * reach * direction());
  const std::span<const double> from(start_.data(), n);
  if (given.free && !scale_to_energy(*problem_.lagrangian, from, *given.energy, {v.data(), n})) return false;
  const double duration = given.free ? part * reach : given.value;
  const Guess motion = motion_from(*problem_.lagrangian, from, {v.data(), n}, duration, step_error,
                                   [this] { return pursuit_.count_step(); });
  return motion.given() && move_to_ends(pursuit_, guess_.ends(), motion, duration) == Trial::found;
}

}  // namespace extremal
