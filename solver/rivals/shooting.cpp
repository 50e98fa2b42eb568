#include "rivals/shooting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rivals/segments.hpp"

namespace extremal {

namespace {

/// The integrator is asked for this much more than the corrections.
constexpr double margin = 0.1;
/// What integration far from the solution is good for, and the correction from which on it is near.
constexpr double loose = 1e-5, near = 1e-3;
constexpr double least_damping = 1.0 / 1024;
/// Of the integrator where singular values must be told from zero.
constexpr double precise = 1e-10;
/// Corrections that fall by less per iteration call for new factors.
constexpr double slow = 0.1;

class Shooter {
 public:
  Shooter(const Problem& problem, const ShootingOptions& options)
      : problem_(problem),
        options_(options),
        segments_(problem, options.segments, options.deadline),
        final_(problem.periodic ? std::min(precise, margin * options.tolerance) : margin * options.tolerance),
        tolerance_(problem.periodic ? final_ : std::max(final_, loose)) {}

  Shot run() {
    if (!segments_.guess(course_)) return finish(Status::not_converged, "the guess cannot be evaluated");
    if (!segments_.evaluate(course_, tolerance_, true))
      return finish(Status::not_converged, "the motion from the guess cannot be integrated");
    if (!renew()) return finish(Status::conjugate_ends, "the ends are conjugate along the guess");
    while (shot_.iterations < options_.max_iterations) {
      shot_.correction = correction_.size;
      // What remains after this correction falls by the same factor.
      if (tolerance_ == final_ && contraction_ * correction_.size <= options_.tolerance) {
        course_ = moved(1);
        return finish(Status::converged, "");
      }
      ++shot_.iterations;
      if (!near_ && correction_.size <= near) {
        near_ = true;
        tolerance_ = final_;
      }
      if (!(near_ ? close_step() : damped_step()))
        return finish(Status::not_converged,
                      fmt::format("no step reduces the correction of {:.3g}", correction_.size));
    }
    return finish(Status::iteration_limit, "");
  }

 private:
  Course moved(double damping) const {
    Course course = course_;
    course.states += damping * correction_.states;
    course.duration *= 1 + damping * correction_.duration;
    return course;
  }

  /// A step of Newton from the last variations.
  bool renew() {
    segments_.factor();
    correction_ = segments_.correct();
    return correction_.finite;
  }

  /// Takes the longest step whose simplified correction is shorter, by 1 − λ/2 (Deuflhard, Newton Methods for
  /// Nonlinear Problems, 3.3); with new variations.
  bool damped_step() {
    for (double damping = 1; damping >= least_damping; damping /= 2) {
      const Course trial = moved(damping);
      if (!(trial.duration > 0.1 * course_.duration) || !segments_.evaluate(trial, tolerance_, true))
        continue;
      const Segments::Correction simplified = segments_.correct();
      if (!(simplified.size <= (1 - damping / 2) * correction_.size) && !(simplified.size <= near)) continue;
      course_ = trial;
      return renew();
    }
    return false;
  }

  /// The full step with the factors at hand; with new ones where these do not serve.
  bool close_step() {
    const Course trial = moved(1);
    if (!segments_.evaluate(trial, tolerance_, false)) return false;
    const Segments::Correction simplified = segments_.correct();
    const double ratio = simplified.size / correction_.size;
    if (!(ratio < 1)) return refresh_and_retry();
    contraction_ = ratio;
    course_ = trial;
    correction_ = simplified;
    if (ratio <= slow) return true;
    return segments_.evaluate(course_, tolerance_, true) && renew();
  }

  bool refresh_and_retry() {
    if (!segments_.evaluate(course_, tolerance_, true) || !renew()) return false;
    return damped_step();
  }

  Shot finish(Status status, std::string message) {
    const int n = problem_.coordinates();
    if (status != Status::converged && options_.deadline.passed()) {
      status = Status::iteration_limit;
      message =
          fmt::format("{} is spent after {} iterations", options_.deadline.budget_text(), shot_.iterations);
    }
    shot_.status = status;
    shot_.steps = segments_.steps();
    if (status == Status::converged)
      message = fmt::format("{} segment{}, {} iterations", options_.segments,
                            options_.segments > 1 ? "s" : "", shot_.iterations);
    if (status == Status::iteration_limit && message.empty())
      message = fmt::format("a correction of {:.3g} is left after {} iterations", shot_.correction,
                            shot_.iterations);
    shot_.message = std::move(message);
    if (status != Status::converged) return shot_;
    for (int k = 0; k < options_.segments; ++k) {
      const double t = course_.duration * k / options_.segments;
      const Eigen::VectorXd state = course_.states.col(k), v = segments_.velocity(state, t);
      shot_.times.push_back(t);
      shot_.q.insert(shot_.q.end(), state.begin(), state.begin() + n);
      shot_.v.insert(shot_.v.end(), v.begin(), v.end());
    }
    shot_.times.push_back(course_.duration);
    return shot_;
  }

  const Problem& problem_;
  const ShootingOptions& options_;
  Segments segments_;
  bool near_ = false;
  double final_, tolerance_, contraction_ = 1;
  Course course_;
  Segments::Correction correction_;
  Shot shot_;
};

}  // namespace

Shot shoot(const Problem& problem, const ShootingOptions& options) { return Shooter(problem, options).run(); }

}  // namespace extremal
