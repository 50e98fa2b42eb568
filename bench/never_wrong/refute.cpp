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
/// No more can be asked of an integrator in double precision.
constexpr double tightest = 1e-12;

class Refutation {
 public:
  Refutation(const extremal::Study& study, const extremal::Solution& solution,
             const std::optional<TrueError>& reference)
      : problem_(study.problem),
        trajectory_(solution.trajectory),
        reference_(reference),
        by_distance_(study.options.scheme.has_value()),
        tolerance_(study.options.tolerance),
        ranges_(survey(*problem_.lagrangian, trajectory_)),
        magnitude_(magnitude(problem_, trajectory_)),
        size_(size_of(study, trajectory_)),
        fast_(std::max(largest_of(ranges_.v), size_ / trajectory_.duration())) {}

  std::vector<Fault> run() {
    if (rests(problem_, trajectory_)) return at_rest();
    const std::string doubt = judge(tolerance_);
    if (doubt.empty()) return {};
    // What is refuted must be so with the integrator a hundred times more precise as well.
    const std::string confirmed = judge(std::min(tolerance_, std::max(tolerance_ / 100, tightest)));
    if (confirmed.empty()) return {};
    return {{kind_, confirmed}};
  }

 private:
  /// The motion must have no reason to leave: |q''| T²/2 below what is allowed, q'' = L_vv⁻¹ L_q at rest.
  std::vector<Fault> at_rest() {
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

  /// What is wrong, or nothing; all in units of what `tolerance_` allows.
  std::string judge(double integrated) {
    const extremal::Verification found = verify(
        problem_, trajectory_, {.tolerance = integrated, .margin = std::numeric_limits<double>::max()});
    const double unit = integrated / tolerance_;
    const double roundoff = velocity_roundoff(trajectory_),
                 excuse = roundoff / (10 * tolerance_ * largest_of(ranges_.v)),
                 slow = largest_of(ranges_.v) / fast_,
                 excuse_q =
                     roundoff * trajectory_.duration() / std::max(1, found.pieces) / (tolerance_ * size_);
    kind_ = "false";
    if (!found.verified) {
      if (found.message.find("steps of the integrator") != std::string::npos) kind_ = "unverified";
      return found.message;
    }
    if (!by_distance_) {
      if (found.defect * unit > margin + excuse_q)
        return fmt::format("a defect of {:.3g} tolerances in q at t = {:.6g}", found.defect * unit,
                           found.worst_time);
      if (found.conditions * unit > margin + excuse)
        return fmt::format("a natural or closing condition is missed by {:.3g} tolerances",
                           found.conditions * unit);
    }
    const double far = found.distance.value_or(0) * unit;
    kind_ = "error";
    if (far > margin + excuse_q && !excused())
      return fmt::format("the extremal is {:.3g} tolerances away", far);
    kind_ = "velocity";
    if (!by_distance_ && found.velocity_defect * unit * slow > margin + excuse * slow)
      return fmt::format("a defect of {:.3g} times what is allowed in q' at t = {:.6g}",
                         found.velocity_defect * unit * slow, found.worst_time);
    return {};
  }

  bool excused() const {
    return reference_ && reference_->q <= margin * tolerance_ * size_ + 10 * reference_->q_unknown;
  }

  const extremal::Problem& problem_;
  const extremal::Trajectory& trajectory_;
  const std::optional<TrueError>& reference_;
  const bool
      by_distance_;  ///< a scheme of low degree has q' O(h^s) off, and every motion that starts from it
  const double tolerance_;
  const extremal::Survey ranges_;
  const double magnitude_, size_;
  const double fast_;  ///< range of q', or what it is on average: a uniform motion has no range
  std::string kind_;
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
