#include "refute.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rivals/verify.hpp"
#include "solution/observe.hpp"

namespace bench {
namespace {

constexpr double margin = 10;
/// The integrator stays three digits below what is asked; one is enough where it cannot follow.
constexpr double looser = 100;
constexpr int usual_steps = 100000, patience = 1000000;
/// Fields nearer to turning round, and so many tolerances, may do so by errors.
constexpr double least_orientation = 1e-3, much = 100;
constexpr const char* unverified = "unverified";
/// No more can be asked of an integrator in double precision.
constexpr double tightest = 1e-12;

class Refutation {
 public:
  Refutation(const extremal::Study& study, const extremal::Solution& solution,
             const std::optional<TrueError>& reference)
      : study_(study),
        solution_(solution),
        problem_(study.problem),
        trajectory_(solution.trajectory),
        reference_(reference),
        by_distance_(study.options.scheme.has_value()),
        tolerance_(study.options.tolerance),
        ranges_(survey(*problem_.lagrangian, trajectory_)),
        magnitude_(magnitude(problem_, trajectory_)),
        size_(size_of(study, trajectory_)) {}

  std::vector<Fault> run() {
    if (rests(problem_, trajectory_)) return at_rest();
    const Fault doubt = judge(tolerance_);
    if (doubt.kind.empty()) return {};
    if (doubt.kind == unverified) {
      const Fault patient = judge(looser * tolerance_);
      return patient.kind.empty() ? std::vector<Fault>{} : std::vector<Fault>{patient};
    }
    // What is refuted must be so with the integrator more precise, as far as it gets through: along
    // directions that are nearly null its own errors make distances.
    Fault certain = doubt;
    for (const double integrated : {std::max(tolerance_ / 100, tightest), tightest}) {
      const Fault confirmed = judge(std::min(tolerance_, integrated));
      if (confirmed.kind.empty()) return {};
      if (confirmed.kind != unverified) certain = confirmed;
    }
    return {certain};
  }

 private:
  /// The motion must have no reason to leave: |q''| T²/2 below what is allowed, q'' = L_vv⁻¹ L_q at rest.
  std::vector<Fault> at_rest() {
    if (problem_.copies) return {};
    const std::size_t n = problem_.coordinates();
    std::vector<double> q(n), v(n);
    trajectory_.at(0, q, v);
    std::fill(v.begin(), v.end(), 0.0);
    extremal::Scratch scratch;
    const extremal::PointValues at =
        evaluate_at(*problem_.lagrangian, q, v, 0, extremal::Order::hessian, scratch);
    const auto size = static_cast<Eigen::Index>(n);
    const Eigen::VectorXd acceleration = Eigen::Map<const Eigen::MatrixXd>(at.vv.data(), size, size)
                                             .fullPivLu()
                                             .solve(Eigen::Map<const Eigen::VectorXd>(at.dq.data(), size));
    const double moved = acceleration.cwiseAbs().maxCoeff() * std::pow(trajectory_.duration(), 2) / 2;
    if (moved <= margin * std::max(tolerance_, 1e-13) * magnitude_) return {};
    return {{"false", fmt::format("at rest where the motion would leave by {:.3g}", moved)}};
  }

  /// What is wrong, integrated as for the tolerance `integrated`; of no kind where nothing is.
  Fault judge(double integrated) {
    const extremal::Verification found =
        verify(problem_, trajectory_,
               {.tolerance = integrated,
                .margin = std::numeric_limits<double>::max(),
                .ends = pieces(),
                .max_steps = integrated > tolerance_ ? patience : usual_steps});
    if (!found.verified) {
      const bool slow = found.message.find("steps of the integrator") != std::string::npos;
      return {slow ? unverified : "false", found.message};
    }
    const double unit = integrated / tolerance_, roundoff = velocity_roundoff(trajectory_);
    const double unknown_q = roundoff * trajectory_.duration() / found.pieces / (tolerance_ * size_);
    if (!by_distance_) {
      if (found.defect * unit > margin + unknown_q)
        return {"false", fmt::format("a defect of {:.3g} tolerances in q at t = {:.6g}", found.defect * unit,
                                     found.worst_time)};
      const double unknown_p = roundoff * largest_mass() / (10 * tolerance_ * largest_of(ranges_.p));
      if (found.conditions * unit > margin + unknown_p)
        return {"false", fmt::format("a natural or closing condition is missed by {:.3g} tolerances",
                                     found.conditions * unit)};
    }
    const double far = found.distance.value_or(0) * unit;
    if (far > margin + unknown_q && !excused())
      return {"error", fmt::format("the extremal is {:.3g} tolerances away", far)};
    // In units of ten tolerances of what q' is on average: a uniform motion has no range.
    const double average = std::max(largest_of(ranges_.v), size_ / trajectory_.duration());
    const double fast = found.velocity_defect * unit * largest_of(ranges_.v) / average;
    if (!by_distance_ && fast > margin + roundoff / (10 * tolerance_ * average) && !excused_velocity(average))
      return {"velocity", fmt::format("a defect of {:.3g} times what is allowed in q' at t = {:.6g}", fast,
                                      found.worst_time)};
    return solution_.conjugate_times_known ? judge_index(found.orientation) : Fault{};
  }

  /// Steps across kinks of L cost the integrator its last digits: pieces end where elements do, also there.
  std::vector<double> pieces() const {
    if (!problem_.lagrangian->kinks()) return {};
    return {trajectory_.times.begin() + 1, trajectory_.times.end()};
  }

  /// Fields along the path begin with its velocities, which are less exact than it is, and may turn round
  /// elsewhere than those along the extremal: a doubt is confirmed there.
  Fault judge_index(double along_path) const {
    const auto doubtful = [&](double turned) {
      const bool sure = std::abs(turned) > least_orientation + much * tolerance_;
      return sure && turned * expected_orientation() < 0;
    };
    if (!doubtful(along_path)) return {};
    const auto along_reference = [&] {
      return verify(problem_, reference_->reference,
                    {.tolerance = tolerance_, .margin = std::numeric_limits<double>::max()})
          .orientation;
    };
    if (reference_ && !doubtful(along_reference())) return {};
    return {reference_ ? "index" : unverified,
            fmt::format("index {}, but Jacobi fields that are integrated turn round an {} number of times",
                        *solution_.morse_index, along_path < 0 ? "odd" : "even")};
  }

  /// (−1)^index with fixed ends, off conjugate ends; 0 elsewhere, and where fields jump at kinks of L, which
  /// those that are integrated do not.
  int expected_orientation() const {
    if (problem_.ends.free > 0 || problem_.duration.free || solution_.nullity != 0) return 0;
    if (problem_.lagrangian->kinks()) return 0;
    return *solution_.morse_index % 2 == 0 ? 1 : -1;
  }

  /// The largest entry of L_vv at the start: momentum by velocity.
  double largest_mass() const {
    std::vector<double> q(problem_.coordinates()), v(q.size());
    trajectory_.at(0, q, v);
    extremal::Scratch scratch;
    return largest_of(evaluate_at(*problem_.lagrangian, q, v, 0, extremal::Order::hessian, scratch).vv);
  }

  /// Momenta of a pinned scheme, as far off as a shift along the orbit, must not be taken for one; nor
  /// roundoff along an orbit, which the phase amplifies; nor that of an integrator without digits to spare.
  bool excused() const {
    const std::optional<TrueError> error =
        of_nearest(by_distance_ || problem_.periodic || no_digits_to_spare());
    return error && error->q <= margin * tolerance_ * size_ + 10 * error->q_unknown;
  }
  bool excused_velocity(double average) const {
    if (!no_digits_to_spare()) return false;
    const std::optional<TrueError> error = of_nearest(true);
    return error && error->v <= margin * 10 * tolerance_ * average;
  }
  /// A doubt cannot be confirmed by an integrator with a hundred times smaller errors.
  bool no_digits_to_spare() const { return tolerance_ < 100 * tightest; }
  std::optional<TrueError> of_nearest(bool wanted) const {
    return wanted && !reference_ ? distance_from_nearest(study_, solution_) : reference_;
  }

  const extremal::Study& study_;
  const extremal::Solution& solution_;
  const extremal::Problem& problem_;
  const extremal::Trajectory& trajectory_;
  const std::optional<TrueError>& reference_;
  const bool by_distance_;  ///< q' of a pinned scheme is O(h^s) off, and every motion that starts from it
  const double tolerance_;
  const extremal::Survey ranges_;
  const double magnitude_, size_;
};

}  // namespace

double velocity_roundoff(const extremal::Trajectory& trajectory) {
  double shortest = trajectory.duration();
  for (int k = 0; k < trajectory.elements(); ++k)
    shortest = std::min(shortest, trajectory.times[k + 1] - trajectory.times[k]);
  return 4 * std::numeric_limits<double>::epsilon() * largest_of(trajectory.nodes) *
         std::pow(trajectory.degree, 2) / shortest;
}

std::vector<Fault> refute(const extremal::Study& study, const extremal::Solution& solution,
                          const std::optional<TrueError>& reference) {
  return Refutation(study, solution, reference).run();
}

}  // namespace bench
