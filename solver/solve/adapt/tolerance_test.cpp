#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/adapt/limits.hpp"
#include "solve/adapt/refinement.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

/// \file Whether the path that Newton's method left meets the tolerance.

namespace extremal {

using namespace limits::tolerance_test;

void Refinement::measure() {
  w_.resolution.measure(path_, *tables_);
  scales_ = scales(path_, *tables_);
  scales_.q = std::max(scales_.q, rest * first_magnitude_);
  scales_.v = std::max(scales_.v, rest * first_magnitude_ / path_.duration());
  measure_momenta();
  if (inertia_ == 0 || momentum_range_ == 0) return;
  // The largest inertia, where it varies, bounds errors of momenta from far above.
  const double range = momentum_range_ / inertia_;
  if (!varied_mass_ || range < much_less * scales_.v)
    scales_.v = std::min(scales_.v, std::max(range, scales_.slowest));
}

/// Momenta may vary much less than velocities: of slow bodies in a frame that rotates, or beside a pole. What
/// extended precision does not show was measured before.
void Refinement::measure_momenta() {
  const DiscreteAction& action = w_.iteration.action();
  if (const double varied = varied_mass_ ? action.inertia(path_) : 0; varied > 0) inertia_ = varied;
  if (inertia_ == 0) return;
  if (const double range = action.momentum_range(); range > 0) momentum_range_ = range;
}

/// Of momenta by velocities in a frame that rotates or a magnetic field; 0 elsewhere.
double Refinement::inertia() const {
  const Structure& structure = problem_.lagrangian->structure();
  double largest = 0;
  if (!structure.gyroscopic.empty())
    for (const Triplet& m : structure.mass)
      if (m.row == m.column) largest = std::max(largest, std::abs(m.value));
  return largest;
}

/// In units of the error allowed.
double Refinement::excess(const Resolution::Error& error) const {
  if (error.q == 0 && error.v == 0) return 0;  // at rest
  return std::max(error.q / scales_.q, 0.1 * error.v / scales_.v) / options_.tolerance;
}

/// The force that may hold the phase of a periodic path, relative to the largest momentum: the truncation
/// error explains it, to second order. Where weak forces all but allow a family, it is more, however fine
/// they are.
double Refinement::phase_force() const {
  const double explained = std::max(left_out_ / scales_.q, least_phase_force);
  return std::min({spare * options_.tolerance, most_phase_force, explained});
}

/// One more step of a path whose ends are free: natural conditions ask more of momenta than q may need, and
/// along directions that are nearly null its length is roundoff amplified, an error that nothing else shows:
/// it is a better measure than the remainder that was expected.
/// A residual that was left within the tolerance becomes roundoff in a few.
Refinement::Attempt Refinement::satisfy_natural_conditions(const NewtonReport& report) {
  if (problem_.ends.free == 0) return Attempt::converged;
  const double phase = problem_.periodic || problem_.shifts_in_time() ? phase_force() : 0;
  NewtonIteration& newton = w_.iteration;
  // In periodic problems families, as about Kepler's circle, would count as soft.
  if (!problem_.periodic)
    newton.model().set_null_below(largest_null_eigenvalue(scales_.magnitude, left_out_, path_));
  bool passed = false;
  int steps = 0;
  const auto solve = [&](Factors) {
    const bool chord = steps++ == 0 || newton.contraction() <= worst_chord;
    return chord ? newton.chord_step(path_) : newton.full_step(path_, 0);
  };
  const auto take = [&](StepResult step) {
    record();
    passed = step == StepResult::ok && test_.passed(problem_, newton, path_, phase);
    if (passed && newton.norm() <= options_.tolerance) return Progress::arrived;
    // The residual was measured before the step; the first may follow one that was damped.
    const double allowed = std::min(10 * options_.tolerance, loosest_newton);
    const bool hopeless = step != StepResult::ok || (steps > 1 && test_.share() > allowed);
    return hopeless || exhausted() ? Progress::failed : Progress::more;
  };
  if (newton_loop(solve, most_natural_steps, take) == Progress::arrived) {
    outcome_.error += (newton.norm() - report.most_remaining) * scales_.q;
    return Attempt::converged;
  }
  if (passed && newton.extend()) return satisfy_natural_conditions(report);
  outcome_.message = passed ? hidden(newton.norm()) : test_.message();
  if (passed) return Attempt::unreachable;
  // The force that holds the phase is an error of the elements if it falls with them.
  const double before = std::exchange(held_, test_.share());
  const bool falls = held_ <= options_.tolerance && held_ < element_fall * before;
  return problem_.periodic && falls ? Attempt::refine : Attempt::failed;
}

/// The message where roundoff hides the tolerance.
std::string Refinement::hidden(double amplified) const {
  return fmt::format("roundoff is amplified to {:.1e} of the range, beyond the tolerance {:.1e}; loosen it",
                     amplified, options_.tolerance);
}

/// The polynomials that momenta make of elements which have q within the tolerance but not q', if that is
/// enough. The resolution is then that of the polynomials recovered.
std::optional<Resolution::Error> Refinement::recovered(double q) {
  if (!recover(problem_, path_, w_, w_.raised)) return std::nullopt;
  const int degree = path_.degree();
  w_.resolution.measure(w_.raised, w_.levels.at(degree + Recovery::raised_by));
  const Resolution::Error less = w_.resolution.at(degree + Recovery::gained(*problem_.lagrangian));
  if (excess({q, less.v}) <= 1) return less;
  w_.resolution.measure(path_, *tables_);
  return std::nullopt;
}

/// The error of a converged path: coefficients that its elements leave out; the error of the nodes,
/// which comes from the forces and velocities left out and falls with their product (order 2s) from what
/// the nodes moved when the elements changed; corrections not made; roundoff, a random walk over the points.
Refinement::Attempt Refinement::judge(const NewtonReport& newton, double aim, const NodeError& nodes) {
  outcome_.message = newton.failure;
  if (!newton.reached) return Attempt::failed;
  Resolution::Error error = w_.resolution.at(path_.degree());
  const Resolution::Error& before = nodes.left_out;
  const double fall = before.v > 0 ? (error.a / before.a) * (error.v / before.v) : 0;
  const double points = static_cast<double>(path_.elements()) * path_.degree();
  const double at_nodes = nodes.moved * std::min(1.0, fall);
  const double longest = std::sqrt(2 * std::log(points * path_.coordinates()));
  double roundoff = unit_roundoff * scales_.magnitude * std::sqrt(points);
  const auto with = [&](double walk) { return excess({error.q + at_nodes + longest * walk, error.v}); };
  // Where it decides it is measured: more elements would not help.
  if (with(roundoff) > 1 && with(0) <= 1) {
    const double measured = certain * w_.iteration.roundoff(path_) * scales_.q;
    roundoff = std::clamp(measured, unit_roundoff * scales_.magnitude, roundoff);
  }
  const double truncation = error.q + roundoff;
  error.q = left_out_ = truncation + at_nodes;
  outcome_.tolerance = options_.tolerance * scales_.q;
  outcome_.error = error.q + newton.most_remaining * scales_.q;
  if (newton.remaining > std::max(options_.tolerance, aim)) {
    outcome_.message = hidden(newton.remaining);
    return Attempt::unreachable;
  }
  // Of so many walks the longest is expected to be this much longer than one.
  error.q += roundoff * (longest - 1);
  worst_ = excess(error);
  outcome_.recovered = false;
  if (worst_ > 1 && excess({error.q}) <= 1 && newton.most_remaining <= spare * options_.tolerance) {
    const double alone = truncation - roundoff;  // of the elements
    if (const std::optional<Resolution::Error> less = recovered(error.q)) {
      outcome_.recovered = true;
      outcome_.error += less->q - alone;
      worst_ = excess({error.q, less->v});
    }
  }
  if (!(worst_ <= 1)) return Attempt::refine;
  // Much movement may have been Newton's, not the elements': from this converged path it is not.
  if (at_nodes > truncation && !nodes.from_converged && path_.degree() < highest_degree)
    return Attempt::refine;
  // Steps at a double root halve what remains, and end at the root of roundoff.
  if (outcome_.error > outcome_.tolerance) {
    outcome_.message = fmt::format(
        "corrections of {:.1e} of the range remain, beyond the tolerance {:.1e}: the equations are nearly "
        "singular, as at a double root, of which roundoff leaves half of the digits; loosen it",
        newton.most_remaining, options_.tolerance);
    return Attempt::unreachable;
  }
  outcome_.message = "converged";
  return Attempt::converged;
}

}  // namespace extremal
