#include "rivals/shooting.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rivals/dop853.hpp"
#include "rivals/flow.hpp"

namespace extremal {

namespace {

/// The integrator is asked for this much more than the ends.
constexpr double margin = 0.1;
constexpr double least_damping = 1.0 / 1024;
/// Piece of [0, 1] over which the initial velocity of the guess is read.
constexpr double initial_piece = 1e-6;

void check_ends(const Problem& problem) {
  if (problem.ends.free > 0)
    throw std::invalid_argument(
        fmt::format("shooting needs both ends fixed; {} end coordinates are free", problem.ends.free));
  if (problem.duration.free) throw std::invalid_argument("shooting needs a fixed duration");
}

/// One integration with variations, from q(0) and p(0) = `momentum`.
class Shooter {
 public:
  explicit Shooter(const Problem& problem)
      : n_(problem.coordinates()),
        duration_(problem.duration.value),
        ends_(Eigen::Map<const Eigen::VectorXd>(problem.ends.offset.data(), 2 * n_)),
        flow_(*problem.lagrangian),
        y_(2 * n_ * (n_ + 1)) {
    const Eigen::VectorXd velocity = initial_velocity(problem);
    momentum_.resize(n_);
    valid_ = flow_.momentum(start(), {velocity.data(), n_}, 0, {momentum_.data(), n_});
    scale_ = std::max(ends_.cwiseAbs().maxCoeff(), (ends_.tail(n_) - ends_.head(n_)).cwiseAbs().maxCoeff());
    if (scale_ == 0) scale_ = 1;
  }

  bool valid() const { return valid_; }
  double scale() const { return scale_; }
  int steps() const { return steps_; }
  std::span<const double> start() const { return {ends_.data(), n_}; }
  const Eigen::VectorXd& momentum() const { return momentum_; }
  Flow& flow() { return flow_; }

  /// q(T) − wanted and ∂q(T)/∂p(0); false if the integration fails.
  bool run(const Eigen::VectorXd& momentum, double tolerance, Eigen::VectorXd& miss,
           Eigen::MatrixXd& jacobian) {
    const int block = static_cast<int>(n_), size = static_cast<int>(y_.size());
    std::fill(y_.begin(), y_.end(), 0.0);
    std::copy_n(ends_.data(), n_, y_.begin());
    std::copy_n(momentum.data(), n_, y_.begin() + n_);
    for (std::size_t c = 0; c < n_; ++c) y_[2 * n_ * (c + 1) + n_ + c] = 1;
    Dop853 integrator(
        [this](double t, auto y, auto slope) { return flow_.slope_with_variations(t, y, slope); }, size);
    double t = 0;
    const Integrated outcome = integrator.advance(t, y_, duration_, {.tolerance = tolerance, .block = block});
    steps_ += integrator.steps();
    if (outcome != Integrated::done) return false;
    const Eigen::Map<const Eigen::MatrixXd> columns(y_.data(), 2 * n_, n_ + 1);
    miss = columns.col(0).head(n_) - ends_.tail(n_);
    jacobian = columns.topRightCorner(n_, n_);
    return true;
  }

 private:
  Eigen::VectorXd initial_velocity(const Problem& problem) const {
    if (!problem.guess.given()) return (ends_.tail(n_) - ends_.head(n_)) / duration_;
    Eigen::VectorXd here(n_), there(n_);
    problem.guess.at(0, {here.data(), n_});
    problem.guess.at(initial_piece, {there.data(), n_});
    return (there - here) / (initial_piece * duration_);
  }

  std::size_t n_;
  double duration_, scale_ = 1;
  bool valid_ = false;
  int steps_ = 0;
  Eigen::VectorXd ends_, momentum_;
  Flow flow_;
  std::vector<double> y_;
};

/// Takes the longest step along `full` = −J⁻¹ F whose simplified correction is shorter, |J⁻¹ F(trial)| <= (1
/// − λ/2) |J⁻¹ F| (Deuflhard, Newton Methods for Nonlinear Problems, 3.3). False if none is.
bool damped_step(Shooter& shooter, double tolerance, const Eigen::VectorXd& full, Eigen::VectorXd& momentum,
                 Eigen::VectorXd& miss, Eigen::MatrixXd& jacobian) {
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(jacobian);
  Eigen::VectorXd trial_miss;
  for (double damping = 1; damping >= least_damping; damping /= 2) {
    const Eigen::VectorXd trial = momentum + damping * full;
    if (!shooter.run(trial, tolerance, trial_miss, jacobian)) continue;
    if (!(factors.solve(trial_miss).norm() <= (1 - damping / 2) * full.norm()) &&
        !(trial_miss.cwiseAbs().maxCoeff() <= tolerance / margin * shooter.scale()))
      continue;
    momentum = trial;
    miss = trial_miss;
    return true;
  }
  return false;
}

}  // namespace

Shot shoot(const Problem& problem, const ShootingOptions& options) {
  check_ends(problem);
  Shooter shooter(problem);
  const double tolerance = margin * options.tolerance;
  Eigen::VectorXd momentum = shooter.momentum(), miss;
  Eigen::MatrixXd jacobian;
  Shot shot;
  const auto finish = [&](Status status, std::string message) {
    shot.status = status;
    shot.message = std::move(message);
    shot.steps = shooter.steps();
    return shot;
  };
  if (!shooter.valid() || !shooter.run(momentum, tolerance, miss, jacobian))
    return finish(Status::not_converged, "the motion from the guess's initial velocity cannot be integrated");
  while (shot.iterations < options.max_iterations) {
    shot.miss = miss.cwiseAbs().maxCoeff();
    if (shot.miss <= options.tolerance * shooter.scale()) {
      shot.momentum_start.assign(momentum.begin(), momentum.end());
      shot.velocity_start.resize(momentum.size());
      if (!shooter.flow().velocity(shooter.start(), shot.momentum_start, 0, shot.velocity_start))
        return finish(Status::not_converged, "no velocity belongs to the initial momentum found");
      return finish(Status::converged, fmt::format("single shooting, {} iterations", shot.iterations));
    }
    const Eigen::VectorXd full = -jacobian.partialPivLu().solve(miss);
    if (!full.allFinite())
      return finish(Status::conjugate_ends, "the ends are conjugate along the motion tried");
    if (!damped_step(shooter, tolerance, full, momentum, miss, jacobian))
      return finish(Status::not_converged,
                    fmt::format("no step reduces the miss of {} at the end, after {} iterations", shot.miss,
                                shot.iterations));
    ++shot.iterations;
  }
  return finish(Status::iteration_limit,
                fmt::format("the end is missed by {} after {} iterations", shot.miss, shot.iterations));
}

}  // namespace extremal
