#include "solve/march/initial_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <climits>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "action/momentum_jump.hpp"
#include "machine/clock.hpp"
#include "solution/broken_node.hpp"
#include "solution/observe.hpp"
#include "solve/march/deviation.hpp"
#include "solve/march/kink_watch.hpp"
#include "solve/march/limits.hpp"
#include "solve/march/march.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/mesh/overlooked.hpp"

namespace extremal {

using namespace limits::march;

namespace {

/// Coordinates that a message names; steps to the velocities of given momenta.
constexpr std::size_t most_named = 3;
constexpr int velocity_steps = 20;
/// Of the duration: a march that comes no farther has not begun.
constexpr double at_start = 1e-9;
/// Of the sizes of what u is made of: a motion so near a surface is on it.
constexpr double on_surface = 1e-8;

/// Coefficients of degree k fall like f^k, f = 1/(y + √(1 + y²)) with y = 2d/h, d the distance to the
/// nearest singularity in complex time. So the truncation f^(s+1) gives the length that a degree s allows, in
/// units of 2d; the cheapest degree has the least cost over this.
int degree_for(double truncation, const Lagrangian& lagrangian) {
  const Structure& structure = lagrangian.structure();
  const int gain = structure.quadratic && structure.velocity_free && structure.gyroscopic.empty() ? 2 : 1;
  const double n = structure.coordinates, rows = 1.0 + structure.gradient.size() + structure.hessian.size();
  int best = least_degree;
  double least = INFINITY;
  for (int s = least_degree; s <= highest_degree; ++s) {
    const double f = std::pow(truncation, 1.0 / (s + 1 + gain)), length = 2 * f / (1 - f * f);
    const double unknowns = n * s, lanes = simd_lanes();
    // Nanoseconds, roughly: values and sums of some steps, the matrix and its inverse.
    const double step = 60 + std::ceil(s / lanes) * rows * 4 + (4 * n * s * s + unknowns * unknowns) / lanes;
    const double matrix =
        unknowns > most_dense ? 20 * unknowns * s : (unknowns * unknowns * (s + 2 * unknowns)) / (2 * lanes);
    const double cost = (6 * step + 1.5 * matrix) / length;
    if (cost >= least) continue;
    least = cost;
    best = s;
  }
  return best;
}

/// A march with the tables that it was made with.
struct Marched {
  std::unique_ptr<StepTables> tables;
  March march;
  double truncation = 0;

  explicit operator bool() const { return tables != nullptr; }
  bool complete() const { return march.complete(); }
};

class InitialMotion {
 public:
  InitialMotion(const Problem& problem, const SolveOptions& options)
      : problem_(problem), options_(options), lagrangian_(*problem.lagrangian) {}

  Solution run() {
    const auto start = Clock::now();
    solution_.strategy = "marched from the initial data";
    if (options_.scheme)
      run_scheme();
    else
      run_adaptive();
    solution_.seconds_solve = seconds_since(start);
    const auto analysis = Clock::now();
    if (solution_.converged() && !survey_) survey_ = observe_energy(lagrangian_, solution_);
    solution_.seconds_analyse = seconds_since(analysis);
    return std::move(solution_);
  }

 private:
  /// Over the duration, or a part of it.
  Marched adaptive(double truncation, int degree, const Trajectory* near, double part = 1) {
    Marched result{std::make_unique<StepTables>(gauss(degree), 0, lagrangian_), {}, truncation};
    result.march = march_adaptive(*problem_.initial, part * problem_.duration.value, *result.tables,
                                  truncation, longest_, options_.deadline, near, options_.progress);
    steps_ += result.march.steps;
    return result;
  }

  /// Of a long motion the errors at the ends of elements decide. They grow with t² where the energy drifts:
  /// from those of a part of the motion, the truncation that the whole needs.
  double foreseen(double truncation) {
    const int degree = degree_for(truncation, lagrangian_);
    const Marched found = adaptive(truncation, degree, nullptr, pilot_part);
    if (!found.complete() || found.march.trajectory.elements() < least_pilot) return truncation;
    const Marched better = adaptive(std::max(companion_share * truncation, finest),
                                    degree + companion_degrees, &found.march.trajectory, pilot_part);
    if (!better.complete()) return truncation;
    const double range = deviation(lagrangian_, found.march.trajectory, better.march.trajectory).range.q;
    double error = 0;
    for (std::size_t a = 0; a < found.march.last.q.size(); ++a)
      error = std::max(error, std::abs(found.march.last.q[a].high - better.march.last.q[a].high));
    const double excess = error / (pilot_part * pilot_part * options_.tolerance * range);
    return excess > spare ? std::max(truncation * std::max(spare / excess, most_fall), finest) : truncation;
  }

  /// Lowers the truncation until the error of the motion, as another march finds it, is tolerated.
  void run_adaptive() {
    double truncation = foreseen(std::max(first_share * options_.tolerance, finest)), before = INFINITY;
    Marched companion;
    for (int marches = 0; marches < most_marches; ++marches) {
      const int degree = degree_for(truncation, lagrangian_);
      Marched found = adaptive(truncation, degree, companion ? &companion.march.trajectory : nullptr);
      if (!found.complete()) return fail(found.march, 0);
      if (!companion || companion.truncation > companion_enough * truncation) {
        companion = adaptive(std::max(companion_share * truncation, finest),
                             std::min(degree + companion_degrees, max_degree), &found.march.trajectory);
        if (!companion.complete()) return fail(companion.march, 0);
      }
      const MotionDeviation apart =
          deviation(lagrangian_, found.march.trajectory, companion.march.trajectory);
      double excess = apart.excess(options_.tolerance);
      if (excess <= 1 && !holds_energy(found)) excess = 2 / spare;
      if (excess <= 1 && !shorten_elements(found.march.trajectory)) return accept(std::move(found), apart);
      if (excess <= 1) {
        companion = {};
        continue;
      }
      const bool stagnates = excess > stagnant * before && apart.error.q < near_motions * apart.range.q;
      if (truncation <= finest || stagnates) {
        if (!refuse_jump(found.march.trajectory)) refuse_roundoff(apart);
        return;
      }
      before = excess;
      truncation = std::max(truncation * std::clamp(spare / excess, most_fall, 0.5), finest);
    }
    solution_.message =
        fmt::format("the error does not fall to the tolerance in {} marches; loosen it", most_marches);
  }

  /// Of a motion whose force elements overlook the energy drifts.
  bool holds_energy(const Marched& found) {
    solution_.trajectory = found.march.trajectory;
    survey_ = observe_energy(lagrangian_, solution_);
    if (!lagrangian_.structure().autonomous || problem_.paired) return true;
    return survey_ && conserves_energy(*survey_, solution_.trajectory, options_.tolerance);
  }

  /// Elements become so short that they find a force that these overlook. One that depends on positions alone
  /// makes the energy drift, unless it is a pulse.
  bool shorten_elements(const Trajectory& trajectory) {
    const Structure& s = lagrangian_.structure();
    if (s.autonomous && !s.pulses) return false;
    const OverlookedForces overlooked = overlooked_forces(lagrangian_, trajectory);
    const double seen = limits::overlooked::steps_an_element * overlooked.step;
    if (overlooked.steps.empty() || !(seen < longest_)) return false;
    longest_ = seen;
    return true;
  }

  /// Whether a velocity crosses a kink; says so.
  bool refuse_jump(const Trajectory& trajectory) {
    if (trajectory.elements() == 0) return false;
    const auto jump = momentum_jump(
        problem_, {trajectory.coordinates, trajectory.degree, trajectory.times, trajectory.nodes});
    if (!jump) return false;
    solution_.trajectory = {};
    solution_.message = describe(*jump);
    return true;
  }

  void refuse_roundoff(const MotionDeviation& apart) {
    const double until = apart.exceeded(options_.tolerance);
    solution_.status = Status::not_converged;
    if (apart.error.q <= roundings * apart.magnitude) {
      solution_.message = fmt::format(
          "the tolerance {:.1e} of the range {:.1e} is less than what rounding leaves of coordinates up to "
          "{:.1e} and of their velocities; loosen it",
          options_.tolerance, apart.range.q, apart.magnitude);
      return;
    }
    if (!std::isfinite(until) && survey_) {  // it is the energy that does not meet the tolerance
      solution_.message = fmt::format(
          "the energy drifts by {:.1e}, more than the tolerance {:.1e} allows: elements do not resolve a "
          "singularity or a kink of L on the way; try another tolerance",
          survey_->energy_drift, options_.tolerance);
      return;
    }
    const MotionDeviation::Part worst = apart.worst(options_.tolerance);
    solution_.message = fmt::format(
        "{}: the tolerance {:.1e} holds until t = {:.6g}; after that {} are known "
        "to {:.1e}, where {:.1e} is allowed; shorten the duration to {:.6g}, or loosen the tolerance",
        lagrangian_.kinks()
            ? "the motion amplifies roundoff, or its elements do not resolve it beside kinks of L"
            : "the motion amplifies roundoff",
        options_.tolerance, until, worst.of, worst.error, worst.allowed, shorter * until);
  }

  /// Equal elements of the scheme against a motion that is known much better; so many as the tolerance needs
  /// have the velocities of their momenta, which are of the order of the scheme.
  void run_scheme() {
    Marched companion = adaptive(scheme_companion, degree_for(scheme_companion, lagrangian_), nullptr);
    if (companion.complete() && shorten_elements(companion.march.trajectory))
      companion = adaptive(scheme_companion, degree_for(scheme_companion, lagrangian_), nullptr);
    if (!companion.complete()) return fail(companion.march, 0);
    int elements = options_.elements > 0 ? options_.elements : first_elements;
    const int order = std::min(options_.scheme->order, options_.scheme->degree + 1);
    for (double before = INFINITY;;) {
      Marched found = uniform(elements, options_.elements == 0);
      if (!found.complete() && (options_.elements > 0 || found.march.end != March::End::no_element))
        return fail(found.march, elements);
      double growth = most_element_growth;
      if (found.complete()) {
        MotionDeviation apart = deviation(lagrangian_, found.march.trajectory, companion.march.trajectory);
        if (companion.truncation > finest &&
            apart.error.q < scheme_margin * companion.truncation * apart.range.q) {
          companion = adaptive(finest, degree_for(finest, lagrangian_), &companion.march.trajectory);
          if (!companion.complete()) return fail(companion.march, 0);
          apart = deviation(lagrangian_, found.march.trajectory, companion.march.trajectory);
        }
        const double excess = apart.excess(options_.tolerance);
        if (options_.elements > 0 || excess <= 1) return accept(std::move(found), apart);
        if (excess > stagnant * before && apart.error.q < 1e-9 * apart.range.q) return refuse_roundoff(apart);
        before = excess;
        growth = std::pow(2 * excess, 1.0 / order);
        if (apart.error.q > near_motions * apart.range.q) growth = std::max(growth, 2.0);
      }
      const double next = elements * std::clamp(growth, 1.1, most_element_growth);
      if (next > most_elements || !(elements * growth < 1e3 * most_elements)) {
        solution_.message = fmt::format(
            "{} needs more than {} elements for the tolerance {:.0e}; loosen it, or leave the scheme out",
            options_.scheme->name, most_elements, options_.tolerance);
        return;
      }
      elements = std::max(elements + 1, static_cast<int>(std::ceil(next)));
    }
  }

  /// An exact quadrature takes more points until they do not change the action.
  Marched uniform(int elements, bool recovering) {
    const Scheme& scheme = *options_.scheme;
    for (int points = scheme.points;; points += points < 8 ? 2 : 4) {
      points = std::min(points, most_points);
      const bool more = scheme.quadrature == Quadrature::exact && points < most_points;
      const StepTables finer(scheme, std::min(points + 2, most_points), lagrangian_);
      Marched result{std::make_unique<StepTables>(scheme, points, lagrangian_), {}, 0};
      result.march = march_uniform(*problem_.initial, problem_.duration.value, *result.tables, elements,
                                   recovering, options_.deadline, options_.progress, more ? &finer : nullptr);
      steps_ += result.march.steps;
      if (!more || !result.complete()) return result;
      const March& march = result.march;
      if (std::abs(march.finer_action - march.action) <= exact * std::abs(march.action)) return result;
    }
  }

  void accept(Marched found, const MotionDeviation& apart) {
    March& march = found.march;
    if (const auto broken = find_broken_node(lagrangian_, march.trajectory, problem_.paired)) {
      solution_.trajectory = {};
      solution_.message = describe(*broken);
      return;
    }
    if (refuse_jump(march.trajectory)) return;
    solution_.status = Status::converged;
    solution_.message = "converged";
    if (const int kinked = options_.scheme ? kinked_elements(lagrangian_, march.trajectory) : 0; kinked > 0)
      solution_.message += fmt::format(
          "; the motion crosses kinks of the Lagrangian inside {} of its elements, which lowers the order",
          kinked);
    solution_.degree = found.tables->degree();
    solution_.pinned = options_.scheme.has_value();
    solution_.unknowns = static_cast<int>(std::min<long long>(
        static_cast<long long>(march.trajectory.elements()) * found.tables->unknowns(), INT_MAX));
    solution_.iterations = static_cast<int>(std::min<long long>(steps_, INT_MAX));
    solution_.trajectory = std::move(march.trajectory);
    const SchemeTables& scheme = found.tables->scheme();
    if (solution_.pinned && !problem_.paired) {
      // Of the discrete path itself, not of what its momenta make of it.
      const Marched discrete =
          options_.elements == 0 ? uniform(solution_.trajectory.elements(), false) : Marched{};
      solution_.element_energies =
          element_energies(lagrangian_, scheme.node, scheme.weight,
                           discrete ? discrete.march.trajectory : solution_.trajectory);
    }
    solution_.action = march.action;
    solution_.residual = march.residual;
    solution_.error_estimate = std::max(apart.error.q, unit_roundoff * apart.magnitude);
    solution_.momentum_start = problem_.initial->p;
    for (const LongSum& p : march.last.p) solution_.momentum_end.push_back(p.high);
  }

  /// Speeds at the end of the march are far above their mean.
  static bool runs_away(const Trajectory& trajectory) {
    const std::size_t n = trajectory.coordinates, count = trajectory.slopes.size();
    if (count < 8 * n) return false;
    double mean = 0, end = 0;
    for (int k = 0; k < trajectory.elements(); ++k) {
      double largest = 0;
      for (std::size_t a = 0; a < n; ++a)
        largest =
            std::max(largest, std::abs(trajectory.slopes[(k + 1) * (trajectory.degree + 1) * n - n + a]));
      mean += largest * trajectory.length(k) / trajectory.duration();
    }
    for (std::size_t a = count - n; a < count; ++a) end = std::max(end, std::abs(trajectory.slopes[a]));
    return end > collision_speed * mean;
  }

  /// Half the number of turning points of the coordinate that turns most often.
  static double oscillations(const Trajectory& trajectory) {
    const std::size_t n = trajectory.coordinates, step = (trajectory.degree + 1) * n;
    double most = 0;
    for (std::size_t a = 0; a < n; ++a) {
      double turns = 0, before = 0;
      for (std::size_t k = a; k < trajectory.slopes.size(); k += step) {
        const double slope = trajectory.slopes[k];
        turns += slope * before < 0;
        if (slope != 0) before = slope;
      }
      most = std::max(most, turns);
    }
    return 0.5 * most;
  }

  /// Says where the march ended; `elements` equal ones were asked for, or none.
  void fail(const March& march, int elements) {
    solution_.iterations = static_cast<int>(std::min<long long>(steps_, INT_MAX));
    solution_.trajectory = {};
    const double t = march.reached;
    if (march.end == March::End::deadline) {
      solution_.status = Status::iteration_limit;
      solution_.message = fmt::format(
          "{} (solve.budget) is spent at t = {:.6g} of a march; raise it, shorten the duration or "
          "loosen the tolerance",
          options_.deadline.budget_text(), t);
    } else if (march.end == March::End::memory) {
      const double parts = problem_.duration.value / t;
      solution_.message = fmt::format(
          "the motion takes {} elements until t = {:.6g}, with {:.3g} oscillations; the duration {:.6g} "
          "would take about {:.2g} elements, more than can be kept; shorten it or loosen the tolerance",
          march.trajectory.elements(), t, oscillations(march.trajectory), problem_.duration.value,
          march.trajectory.elements() * parts);
    } else if (refuse_jump(march.trajectory)) {
      return;
    } else if (elements > 0) {
      solution_.message = fmt::format(
          "element {} has no solution near the motion: {} from t = {:.9g} over {:.3g}; raise solve.elements, "
          "or leave scheme and elements out",
          march.trajectory.elements() + 1, reason(march.reason), t, march.wanted);
    } else if (runs_away(march.trajectory)) {
      solution_.status = Status::collision;
      solution_.message = fmt::format(
          "the motion runs into a collision or another singularity of L at t = {:.9g}, where q' grows "
          "without bound; end it before, at a shorter duration",
          t);
    } else {
      solution_.message = fmt::format(
          "no element, however short, continues the motion beyond t = {:.9g}: {}; end it before, at a "
          "shorter duration",
          t, reason_at(march));
    }
  }

  /// Why there is no element from where a march has come to, with its place.
  std::string reason_at(const March& march) const {
    const std::size_t n = march.last.q.size(), named = n / (problem_.paired ? 2 : 1);
    std::vector<double> q(n), p(n), v(n);
    for (std::size_t a = 0; a < n; ++a) {
      q[a] = march.last.q[a].high;
      p[a] = march.last.p[a].high;
    }
    double speed = 0;
    for (const double x : march.trajectory.slopes) speed = std::max(speed, std::abs(x));
    bool found = true;
    const std::vector<double>& slopes = march.trajectory.slopes;
    if (slopes.size() >= n && march.reached > at_start * problem_.duration.value)
      std::copy(slopes.end() - static_cast<std::ptrdiff_t>(n), slopes.end(), v.begin());
    else
      found = find_velocity(q, p, v);
    Scratch scratch;
    const PointValues at = evaluate_at(lagrangian_, q, v, march.reached, Order::hessian, scratch);
    std::string positions, velocities;
    for (std::size_t a = 0; a < std::min(named, most_named); ++a) {
      const std::string name = problem_.names.empty() ? fmt::format("q[{}]", a + 1) : problem_.names[a];
      positions += fmt::format("{}{} = {:.6g}", a ? ", " : "", name, q[a]);
      velocities += fmt::format(", {}' = {:.3g}", name, v[a]);
    }
    const std::string place = positions + velocities;
    const auto finite = [](const std::vector<double>& x) {
      return std::ranges::all_of(x, [](double value) { return std::isfinite(value); });
    };
    const bool stays = march.stays_on_kink || on_kink(q, v, march.reached, speed);
    if (!std::isfinite(at.value) && stays) return stays_at(place);
    const char* const what = problem_.paired ? "L or a force" : "L";
    if (!std::isfinite(at.value)) return fmt::format("{} is not finite at {}", what, place);
    if (!finite(at.dq) || !finite(at.dv))
      return fmt::format("{} is not finite, or has no derivative, at {}", what, place);
    if (!finite(at.qq) || !finite(at.vq) || !finite(at.vv))
      return fmt::format("second derivatives of {} are not finite at {}", what, place);
    if (!found) return fmt::format("Newton's method finds no velocity with these momenta at {}", positions);
    if (stays) return stays_at(place);
    return fmt::format("{}, at {}", reason(march.reason), place);
  }

  static std::string stays_at(const std::string& place) {
    return fmt::format("from {} on it stays on a kink of abs, min or max", place);
  }

  /// The velocities that have these momenta at t = 0. False if they are not found where L is finite.
  bool find_velocity(const std::vector<double>& q, const std::vector<double>& p,
                     std::vector<double>& v) const {
    const auto n = static_cast<Eigen::Index>(q.size());
    const Eigen::Map<const Eigen::VectorXd> wanted(p.data(), n);
    Scratch scratch;
    for (int k = 0; k < velocity_steps; ++k) {
      const PointValues at = evaluate_at(lagrangian_, q, v, 0, Order::hessian, scratch);
      const Eigen::Map<const Eigen::MatrixXd> mass(at.vv.data(), n, n);
      const Eigen::VectorXd missing = wanted - Eigen::Map<const Eigen::VectorXd>(at.dv.data(), n);
      if (!mass.allFinite() || !missing.allFinite()) return true;
      if (missing.norm() <= roundings * wanted.norm()) return true;
      Eigen::Map<Eigen::VectorXd>(v.data(), n) += mass.fullPivLu().solve(missing);
    }
    return false;
  }

  /// Whether a kink passes through a state. `speed`: of the motion before.
  bool on_kink(const std::vector<double>& q, const std::vector<double>& v, double t, double speed) const {
    const Kinks* const kinks = lagrangian_.kinks();
    Scratch scratch;
    return kinks && std::ranges::any_of(kinks->surfaces(), [&](const KinkSurface& surface) {
             const PointValues u = evaluate_at(*surface.u, q, v, t, Order::gradient, scratch);
             double size = 0;
             for (std::size_t a = 0; a < q.size(); ++a)
               size += std::abs(u.dq[a] * q[a]) + std::abs(u.dv[a]) * speed;
             return std::abs(u.value) <= on_surface * size;
           });
  }

  static const char* reason(ElementSolver::Result result) {
    switch (result) {
      case ElementSolver::Result::not_finite:
        return "L is not finite there";
      case ElementSolver::Result::singular:
        return "the equations are singular, so that the momenta do not determine the motion";
      case ElementSolver::Result::not_converged:
        return "Newton's method does not converge";
      case ElementSolver::Result::solved:
        break;
    }
    return "its elements do not resolve it";
  }

  const Problem& problem_;
  const SolveOptions& options_;
  const Lagrangian& lagrangian_;
  Solution solution_;
  std::optional<Survey> survey_;
  long long steps_ = 0;
  double longest_ = INFINITY;  ///< element
};

}  // namespace

Solution solve_initial(const Problem& problem, const SolveOptions& options) {
  return InitialMotion(problem, options).run();
}

}  // namespace extremal
