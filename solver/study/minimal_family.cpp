#include "study/minimal_family.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "solution/from_minimal.hpp"
#include "study/minimal/limits.hpp"
#include "study/minimal/polar_frames.hpp"
#include "study/study.hpp"
#include "system/minimal_copies.hpp"

namespace extremal {
namespace {

/// A problem with one value of the parameter.
struct Member {
  Problem problem;
  std::shared_ptr<const MinimalProblem> minimal;
};

/// The problems of a family, each in the chart of the first.
class MinimalFamily {
 public:
  MinimalFamily(const Study& study, std::shared_ptr<const MinimalProblem> first)
      : continued_(*study.continuation), problem_(study.problem), first_(std::move(first)) {}

  ProblemFamily family() const {
    ProblemFamily family = continued_.family;
    family.problem = first_->problem;
    if (varies_parameter())
      family.at = [this](double value) -> std::optional<Problem> {
        std::optional<Member> there = at(value);
        if (!there) return std::nullopt;
        return there->minimal->problem;
      };
    return family;
  }

  /// The point in all coordinates; false if its error exceeds the tolerance there.
  bool lift(BranchPoint& point, double tolerance) const {
    std::optional<Member> there = varies_parameter() ? at(point.parameter) : Member{problem_, first_};
    if (!there) return false;
    std::optional<Solution> solution =
        from_minimal(there->problem, *there->minimal, std::move(point.solution), tolerance, true);
    if (solution) point.solution = *std::move(solution);
    return solution.has_value();
  }

 private:
  bool varies_parameter() const { return continued_.family.varied == Varied::parameter; }

  std::optional<Member> at(double value) const {
    std::optional<BareProblem> bare = continued_.bare(value);
    if (!bare) return std::nullopt;
    Chart chart = first_->lagrangian->chart();
    keep_invariants(*bare->problem.manifold, chart);
    auto minimal = minimal_problem_like(*first_, bare->problem, minimal_system(bare->graph, chart));
    if (!minimal) return std::nullopt;
    return Member{std::move(bare->problem), std::move(minimal)};
  }

  /// Of the constraints with this value of the parameter.
  void keep_invariants(const Manifold& manifold, Chart& chart) const {
    PathPoints path;
    const Guess& guess = first_->guess;
    const Eigen::Index n = chart.coordinates;
    for (std::size_t k = 0; k < guess.tau.size(); ++k) {
      path.q.emplace_back(Eigen::Map<const Eigen::VectorXd>(guess.q.data() + k * n, n));
      path.times.push_back(guess.tau[k] * first_->duration.value);
    }
    const Eigen::Map<const Eigen::MatrixXd> transposed(chart.basis.data(), n, n);
    for (Polar& pair : chart.polar)
      pair.invariants = invariant_constraints(manifold, path, transposed.transpose(), pair);
  }

  const Continued& continued_;
  const Problem& problem_;
  std::shared_ptr<const MinimalProblem> first_;
};

/// Branches also end there in all coordinates; elsewhere the end of the chart may be the reason.
bool ended(const BranchRecord& branch) {
  switch (branch.end) {
    case BranchEnd::target:
    case BranchEnd::points:
    case BranchEnd::closed:
    case BranchEnd::rest:
    case BranchEnd::infinite_period:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::ptrdiff_t unended(const FollowedBranch& followed) {
  return std::ranges::count_if(followed.branches, [](const BranchRecord& branch) { return !ended(branch); });
}

std::optional<FollowedBranch> follow_in_minimal_coordinates(const Study& study, const SolveOptions& options) {
  if (!study.problem.manifold || options.scheme || options.method != Method::newton) return std::nullopt;
  const std::shared_ptr<const MinimalProblem> first = study.problem.manifold->parts().minimal;
  if (!first) return std::nullopt;
  const MinimalFamily minimal(study, first);
  SolveOptions own = options;
  own.deadline = options.deadline.share(limits::polar::share_of_family);
  own.tolerance /= first->stretch;
  const Continued& continued = *study.continuation;
  Diagram diagram(minimal.family(), {std::move(own), continued.points, continued.switching});
  FollowedBranch followed;
  followed.title = study.title;
  followed.parameter = continued.parameter;
  followed.names = study.problem.names;
  while (diagram.advance()) {
    BranchPoint point = diagram.point();
    if (!minimal.lift(point, options.tolerance)) return std::nullopt;
    followed.points.push_back(std::move(point));
  }
  followed.branches = diagram.branches();
  // Where a chart without angles ends may look like a point of rest.
  const auto doubtful = [](const BranchRecord& branch) {
    return branch.end == BranchEnd::rest || branch.end == BranchEnd::infinite_period;
  };
  if (first->lagrangian->chart().polar.empty() && std::ranges::any_of(followed.branches, doubtful))
    return std::nullopt;
  return followed;
}

}  // namespace extremal
