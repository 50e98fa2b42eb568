#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "study/constraints/constraints.hpp"
#include "study/constraints/limits.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const Location& place_of(const BoundaryTable& boundary, bool at_end) {
  const std::vector<Assignment>& table = at_end ? boundary.end : boundary.start;
  if (!table.empty()) return table.front().name_at;
  return boundary.conditions.empty() ? boundary.at : boundary.conditions.front().at;
}

/// Both ends of a constrained problem.
class ConstrainedEnds {
 public:
  ConstrainedEnds(const Scene& scene, EndPoints& near, Problem& problem)
      : scene_(scene), near_(near), problem_(problem), manifold_(*problem.manifold) {
    n_ = problem.coordinates();
    m_ = manifold_.constraints();
  }

  bool complete() {
    check_momenta();
    fit_fixed();
    for (const bool at_end : {false, true})
      if (fixed(at_end)) meet(at_end);
    if (problem_.initial) {
      complete_initial();
      return true;
    }
    bool suited = problem_.periodic || (suits() && suits_nearby());
    if (!suited) {
      pin_determined();
      suited = suits();
      if (suited && !suits_nearby()) refuse_degenerate();
    }
    if (suited) project_free();
    return suited;
  }

 private:
  double point_of(const EndPoints& points, int e) const {
    return e < n_ ? points.start[e] : points.end[e - n_];
  }
  std::span<double> point(bool at_end) { return at_end ? near_.end : near_.start; }
  double time(bool at_end) const { return at_end ? problem_.duration.value : 0; }
  bool fixed(bool at_end) const { return problem_.ends.fixes(at_end); }

  /// Ends as the relation has them where it fixes them.
  void fit_fixed() {
    for (int e = 0; e < 2 * n_; ++e)
      if (problem_.ends.fixed[e]) point(e >= n_)[e % n_] = problem_.ends.offset[e];
  }

  void solve_again() { problem_.ends = solve_relation(problem_.boundary); }

  /// The end is on the manifold but for its decimals, which the relation then gets.
  void meet(bool at_end) {
    const std::span<double> q = point(at_end);
    std::vector<double> moved(q.begin(), q.end());
    const double t = time(at_end), size = vector(q).lpNorm<Eigen::Infinity>();
    const bool found = manifold_.project(moved, t);
    const double distance = found ? (vector(moved) - vector(q)).norm() : INFINITY;
    if (!(distance <= end_distance * std::max(size, least_size()))) refuse_missed(at_end);
    if (!manifold_.regular(moved, t)) refuse_singular(at_end);
    for (const Triplet& entry : problem_.boundary.matrix)
      if ((entry.column >= n_) == at_end)
        problem_.boundary.value[entry.row] += entry.value * (moved[entry.column % n_] - q[entry.column % n_]);
    std::copy(moved.begin(), moved.end(), q.begin());
    solve_again();
    for (int a = 0; a < n_; ++a) problem_.ends.offset[(at_end ? n_ : 0) + a] = q[a];
  }

  /// Of an end where all coordinates are near zero, that of the other.
  double least_size() {
    return std::max(vector(near_.start).lpNorm<Eigen::Infinity>(),
                    vector(near_.end).lpNorm<Eigen::Infinity>());
  }

  /// The constraint that a point misses most.
  static Index worst_of(const ConstraintValues& values) {
    Index worst = 0;
    for (Index k = 1; k < values.g.size(); ++k)
      if (size(values, k) > size(values, worst)) worst = k;
    return worst;
  }

  [[noreturn]] void refuse_missed(bool at_end) {
    const ConstraintValues values = manifold_.at(point(at_end), time(at_end));
    const Index worst = worst_of(values);
    throw SceneError(
        place_of(scene_.boundary, at_end),
        fmt::format("the {} does not satisfy the constraint '{}': left − right = {:.6g} there; give values "
                    "that do, or leave out coordinates that follow from the others",
                    at_end ? "end" : "start", scene_.system.constraints[worst].value, values.g[worst]));
  }

  [[noreturn]] void refuse_singular(bool at_end) {
    throw SceneError(
        place_of(scene_.boundary, at_end),
        fmt::format("the gradients of the constraints vanish, or depend on each other, at the {}; "
                    "move this end",
                    at_end ? "end" : "start"));
  }

  [[noreturn]] void refuse_unmet(bool at_end) {
    const ConstraintValues values = manifold_.at(point(at_end), time(at_end));
    const Index worst = worst_of(values);
    throw SceneError(
        place_of(scene_.boundary, at_end),
        fmt::format("no point near the guess satisfies both the constraints and what is given at the {0}: of "
                    "'{1}' left − right = {2:.6g} remains; give other values, or a guess whose {0} satisfies "
                    "both",
                    at_end ? "end" : "start", scene_.system.constraints[worst].value, values.g[worst]));
  }

  static double size(const ConstraintValues& values, Index k) {
    return std::abs(values.g[k]) / std::max(values.slopes.row(k).norm(), 1e-300);
  }

  static Eigen::Map<const VectorXd> vector(std::span<const double> values) {
    return {values.data(), static_cast<Index>(values.size())};
  }

  /// A momentum at an end whose point is not known does not have a known projection.
  void check_momenta() const {
    const std::vector<double>& given = problem_.boundary.momenta;
    for (std::size_t e = 0; e < given.size(); ++e)
      if (given[e] != 0)
        throw SceneError(place_of(scene_.boundary, e >= static_cast<std::size_t>(n_)),
                         "with constraints the momentum at an end cannot be given without its coordinates; "
                         "leave it out, or give all of them as initial data");
  }

  /// The momenta of L̃; a part normal to the manifold would be none of a motion on it.
  void complete_initial() {
    auto& [q, p, paired] = *problem_.initial;
    std::copy(near_.start.begin(), near_.start.end(), q.begin());
    const std::vector<double> projection = manifold_.projected_momentum(q, 0, p);
    std::vector<double> v(n_, 0);
    const std::vector<double> own = manifold_.momentum(q, 0, projection, v);
    const double largest = vector(p).lpNorm<Eigen::Infinity>(), T = problem_.duration.value;
    // At rest a constraint that hardly moves gives momenta that are roundoff.
    const double crossing =
        vector(q).lpNorm<Eigen::Infinity>() / (manifold_.metric().diagonal().minCoeff() * T);
    const double missed = std::max(normal_momentum * largest, negligible_momentum * crossing);
    for (int a = 0; a < n_; ++a)
      if (!(std::abs(own[a] - p[a]) <= missed))
        throw SceneError(place_of(scene_.boundary, false),
                         fmt::format("the momenta at the start are those of a velocity that leaves the "
                                     "constraints: p_{} is {:.9g}, and {:.9g} keeps them",
                                     problem_.names[a], p[a], own[a]));
    p = projection;
  }

  /// The free directions of the ends, 2n × f.
  MatrixXd directions() const {
    MatrixXd z = MatrixXd::Zero(2 * n_, problem_.ends.free);
    for (const Triplet& entry : problem_.ends.z) z(entry.row, entry.column) += entry.value;
    return z;
  }

  /// ∂g/∂q of both ends, 2m × 2n.
  MatrixXd slopes(VectorXd* g = nullptr) {
    MatrixXd both = MatrixXd::Zero(2 * m_, 2 * n_);
    if (g) g->resize(2 * m_);
    for (const bool at_end : {false, true}) {
      const ConstraintValues values = manifold_.at(point(at_end), time(at_end));
      both.block(at_end ? m_ : 0, at_end ? n_ : 0, m_, n_) = values.slopes;
      if (g) g->segment(at_end ? m_ : 0, m_) = values.g;
    }
    return both;
  }

  /// Whether the free directions are virtual displacements and displacements along W Gᵀ: then the natural
  /// conditions of L̃ are those on the manifold.
  bool suits() {
    const MatrixXd z = directions(), g = slopes();
    const int free = problem_.ends.free;
    if (free == 0) return true;
    MatrixXd across = MatrixXd::Zero(2 * n_, 2 * m_), both(2 * n_, free + 2 * m_);
    for (int end : {0, 1})
      across.block(end * n_, end * m_, n_, m_) =
          manifold_.metric() * g.block(end * m_, end * n_, m_, n_).transpose();
    for (Index k = 0; k < across.cols(); ++k) across.col(k).normalize();
    both << z, across;
    const int tangent = free - numerical_rank(g * z, rank),
              normal = free + numerical_rank(across, rank) - numerical_rank(both, rank);
    return tangent + normal == free;
  }

  /// The same beside these ends, moved in their free directions. On x² + y² + z² = 1 an end x = 0, y = 1 can
  /// seem free in z, though it is a single point.
  bool suits_nearby() {
    const std::vector<double> start = near_.start, end = near_.end;
    const MatrixXd z = directions();
    double step = aside_part * least_size();
    for (Index k = 0; k < z.cols(); ++k) {
      for (int e = 0; e < 2 * n_; ++e) point(e >= n_)[e % n_] += step * z(e, k);
      step *= -0.9;  // no combination that is special
    }
    const bool suited = suits();
    near_ = {start, end};
    return suited;
  }

  [[noreturn]] void refuse_degenerate() const {
    std::vector<std::string> names;
    for (const int e : problem_.ends.home)
      names.push_back(fmt::format("{}({})", problem_.names[e % n_], e < n_ ? "0" : "T"));
    throw SceneError(
        place_of(scene_.boundary, problem_.ends.home.front() >= n_),
        fmt::format("the constraints determine {}, but not near the guess; write the value in [boundary], "
                    "or give a guess that is nearer to it",
                    fmt::join(names, ", ")));
  }

  /// Moves the ends to the nearest ones that satisfy their relation.
  void put_on_relation(const MatrixXd& z) {
    VectorXd away(2 * n_);
    for (int e = 0; e < 2 * n_; ++e) away[e] = point(e >= n_)[e % n_] - problem_.ends.offset[e];
    move(z * least_norm(z, away) - away);
  }

  void move(const VectorXd& by) {
    for (int e = 0; e < 2 * n_; ++e) point(e >= n_)[e % n_] += by[e];
  }

  /// Newton's method along the free directions. The virtual displacements among these where it ends.
  MatrixXd meet_along(const MatrixXd& z) {
    constexpr int most_steps = 50;
    VectorXd g;
    MatrixXd by_free;
    for (int k = 0; k < most_steps; ++k) {
      by_free = slopes(&g) * z;
      const VectorXd step = z * least_norm(by_free, -g);
      move(step);
      if (step.norm() <= 1e-15 * std::max(vector(near_.start).norm(), vector(near_.end).norm())) break;
    }
    const SingularValues parts = singular_value_decomposition(by_free);
    return z * parts.v.rightCols(parts.v.cols() - numerical_rank(by_free, rank));
  }

  /// Moves the ends onto the manifold within their relation, and fixes what no virtual displacement moves,
  /// there and beside it: where z = 1/2 is given on the unit sphere, x is at an extremum at y = 0, but is not
  /// fixed. So is what comes back from beside: where x = 1, y = 0 is a point that solutions ±y join in.
  void pin_determined() {
    const MatrixXd z = directions();
    put_on_relation(z);
    const MatrixXd here = meet_along(z);
    for (const bool at_end : {false, true})
      if (!(manifold_.distance(point(at_end), time(at_end)) <= end_distance * least_size()))
        refuse_unmet(at_end);
    const EndPoints met = near_;
    MatrixXd beside = here;
    VectorXd aside = VectorXd::Zero(2 * n_), away = aside;
    if (here.cols() > 0) {
      aside = here.col(0);
      for (Index k = 1; k < here.cols(); ++k) aside += (k % 2 ? -0.9 : 0.8) * here.col(k);
      aside *= aside_part * least_size();
      move(aside);
      beside = meet_along(z);
      for (int e = 0; e < 2 * n_; ++e) away[e] = point(e >= n_)[e % n_] - point_of(met, e);
      near_ = met;
    }
    const auto held = [](const MatrixXd& moving, int e) {
      return moving.cols() == 0 || moving.row(e).norm() <= rank * moving.norm();
    };
    const auto comes_back = [&](int e) {
      return !held(here, e) && std::abs(away[e]) <= part_come_back * std::abs(aside[e]);
    };
    const std::vector<int> home = problem_.ends.home;
    for (const int e : home)
      if ((held(here, e) && held(beside, e)) || comes_back(e))
        problem_.boundary.fix(e % n_, e >= n_, point(e >= n_)[e % n_]);
    solve_again();
  }

  /// Free ends near the manifold.
  void project_free() {
    for (const bool at_end : {false, true})
      if (!fixed(at_end)) {
        std::vector<double> moved(point(at_end).begin(), point(at_end).end());
        if (manifold_.project(moved, time(at_end))) std::ranges::copy(moved, point(at_end).begin());
      }
  }

  const Scene& scene_;
  EndPoints& near_;
  Problem& problem_;
  const Manifold& manifold_;
  int n_ = 0, m_ = 0;
};

}  // namespace

EndPoints end_points(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  EndPoints points{std::vector<double>(n), std::vector<double>(n)};
  const EndMap& ends = problem.ends;
  if (problem.guess.given()) {
    problem.guess.at(0, points.start);
    problem.guess.at(1, points.end);
  }
  for (std::size_t a = 0; a < n; ++a) {
    if (ends.fixed[a]) points.start[a] = ends.offset[a];
    if (ends.fixed[n + a]) points.end[a] = ends.offset[n + a];
    if (problem.guess.given()) continue;
    if (!ends.fixed[a] && ends.fixed[n + a]) points.start[a] = points.end[a];
    if (ends.fixed[a] && !ends.fixed[n + a]) points.end[a] = points.start[a];
  }
  return points;
}

bool complete_ends(const Scene& scene, EndPoints& near, Problem& problem) {
  return ConstrainedEnds(scene, near, problem).complete();
}

void refuse_partly_free(const Scene& scene, const Problem& problem) {
  const int n = problem.coordinates();
  throw SceneError(
      place_of(scene.boundary, !std::ranges::any_of(problem.ends.home, [&](int e) { return e < n; })),
      "this end is fixed in part, and constraints link what is fixed with what is free: families, "
      "comparisons, other methods than Newton's and an L with kinks do not have such ends, and forces only "
      "where coordinates of the motion near the guess include what is fixed; give all coordinates of the "
      "end, or none");
}

}  // namespace extremal
