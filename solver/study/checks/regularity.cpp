#include "study/checks/regularity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "linear/dense.hpp"
#include "linear/equilibration.hpp"
#include "problem/nearby.hpp"
#include "study/checks/limits.hpp"
#include "system/hamiltonian.hpp"

namespace extremal {
namespace {

using namespace limits::regularity;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// How far a symmetric matrix is from singular, in units in which its rows are comparable.
struct Rank {
  double rcond;  ///< the smallest eigenvalue over the largest, in modulus
  int weak;      ///< the coordinate that the eigenvector of the smallest has most of

  bool full() const { return rcond > singular; }
};

Rank rank_of(const MatrixXd& mass) {
  const VectorXd inverse = equilibration(mass.cwiseAbs()).cwiseInverse();
  const SymmetricEigen eigen = symmetric_eigen(inverse.asDiagonal() * mass * inverse.asDiagonal());
  const VectorXd size = eigen.values.cwiseAbs();
  Eigen::Index smallest = 0, weak = 0;
  const double least = size.minCoeff(&smallest);
  eigen.vectors.col(smallest).cwiseAbs().maxCoeff(&weak);
  return {size.maxCoeff() > 0 ? least / size.maxCoeff() : 0, static_cast<int>(weak)};
}

/// A function of q, a rate and t, L of q' or H of p, at points about the guess of a problem.
class Nearby {
 public:
  /// Keeps references to both.
  Nearby(const Problem& problem, const Lagrangian& law)
      : law_(law), n_(problem.coordinates()), points_(problem) {}

  /// The second derivatives by the rates at the next point where they are finite, the rates times `size`;
  /// nothing after `tries` points.
  std::optional<Map<const MatrixXd>> next_mass(double size = 1) {
    while (tried_++ < limits::regularity::tries) {
      const double t = points_.next(q_, rate_);
      for (double& component : rate_) component *= size;
      if (const Map<const MatrixXd> mass = mass_at(q_, rate_, t); mass.allFinite()) return mass;
    }
    return std::nullopt;
  }

  Map<const MatrixXd> mass_at(std::span<const double> q, std::span<const double> rate, double t) {
    values_ = evaluate_at(law_, q, rate, t, Order::hessian, scratch_);
    return {values_.vv.data(), n_, n_};
  }

  /// Whether the mass changes no momentum beyond roundoff, as where L is homogeneous of degree one: what is
  /// left of it is roundoff of terms as large as p/q'.
  bool mass_cancels(const MatrixXd& mass) const {
    const VectorXd change = mass * Map<const VectorXd>(rate_.data(), n_);
    const Map<const VectorXd> p(values_.dv.data(), n_);
    return mass.rows() == 1 && p.allFinite() &&
           std::abs(change[0]) <= limits::regularity::singular * std::abs(p[0]);
  }

  int tried() const { return tried_; }
  const std::vector<double>& rate() const { return rate_; }  ///< at the last point
  const PointValues& values() const { return values_; }      ///< likewise

 private:
  const Lagrangian& law_;
  int n_, tried_ = 0;
  NearbyPoints points_;
  Scratch scratch_;
  PointValues values_;
  std::vector<double> q_, rate_;
};

/// A coordinate without any second derivative by its velocity, or -1.
int massless(const Structure& structure) {
  const int n = structure.coordinates;
  std::vector<char> has(n, 0);
  for (const Triplet& m : structure.mass)
    if (m.value != 0) has[m.row] = has[m.column] = 1;
  for (const HessianEntry& h : structure.hessian)
    if (h.row >= n && h.column >= n) has[h.row - n] = has[h.column - n] = 1;
  const auto found = std::find(has.begin(), has.end(), 0);
  return found == has.end() ? -1 : static_cast<int>(found - has.begin());
}

/// A coordinate whose velocity the momenta do not determine near the guess, or -1.
int irregular(const Problem& problem) {
  const int without = massless(problem.lagrangian->structure());
  if (without >= 0 || problem.coordinates() > largest_dense) return without;
  Nearby nearby(problem, *problem.lagrangian);
  int weak = -1;
  for (int found = 0; found < telling; ++found) {
    const auto mass = nearby.next_mass();
    if (!mass) break;
    const Rank rank = rank_of(*mass);
    if (rank.full() && !nearby.mass_cancels(*mass)) return -1;
    weak = rank.weak;
  }
  return weak;
}

/// Whether q'·∂L/∂q' = L, but L²/2 is regular: L gives the length of a path.
bool is_length(const Problem& problem) {
  Nearby nearby(problem, *problem.lagrangian);
  int found = 0;
  double sign = 0;
  while (found < telling_of_lengths) {
    const auto mass = nearby.next_mass();
    if (!mass) return false;
    const PointValues& at = nearby.values();
    const Map<const VectorXd> p(at.dv.data(), problem.coordinates());
    if (!std::isfinite(at.value) || !p.allFinite() || at.value == 0) continue;
    if (at.value * sign < 0) return false;  // linear in the velocities, as a total derivative is
    sign = at.value;
    const double work = p.dot(Map<const VectorXd>(nearby.rate().data(), problem.coordinates()));
    if (!(std::abs(work - at.value) <= homogeneous * std::abs(at.value))) return false;
    if (!rank_of(p * p.transpose() + at.value * *mass).full()) return false;
    ++found;
  }
  return true;
}

[[noreturn]] void refuse_irregular(const Problem& problem, int coordinate, const Location& at) {
  const bool length = is_length(problem);
  if (length && !problem.lagrangian->structure().autonomous)
    throw SceneError(
        at,
        "the Lagrangian is homogeneous of degree one in the velocities, so its energy is zero; it depends on "
        "t, so the energy changes along an extremal; write it without t, or for a graph: sqrt(1 + x'^2) is "
        "the length of x(t)");
  if (length)
    throw SceneError(
        at,
        "the Lagrangian is homogeneous of degree one in the velocities: it determines the path, but "
        "not the speed along it; take L^2/2, whose extremals are the same curves");
  throw SceneError(
      at, fmt::format("the Lagrangian is not regular: its second derivative by the velocities is singular, "
                      "so the momenta do not determine {}'",
                      problem.names[coordinate]));
}

/// Whether H_pp is regular, with one signature, at points about the guess, with momenta of any size.
bool has_one_signature(const Problem& problem, const Lagrangian& hamiltonian) {
  constexpr double sizes[] = {1, 0.1, 10};
  Nearby nearby(problem, hamiltonian);
  bool found = false;
  std::optional<Eigen::Index> signature;
  while (const auto mass = nearby.next_mass(sizes[nearby.tried() % std::size(sizes)])) {
    found = true;
    if (!rank_of(*mass).full()) continue;
    const Eigen::Index negative = (symmetric_eigenvalues(*mass).array() < 0).count();
    if (negative != signature.value_or(negative)) return false;
    signature = negative;
  }
  return !found || signature;
}

/// Whether H_pp is finite and singular where momenta vanish, as that of p^4 is, or at initial data: motions
/// come there.
bool is_singular_at_rest(const Problem& problem, const Lagrangian& hamiltonian) {
  Nearby nearby(problem, hamiltonian);
  const auto singular_at = [&](std::span<const double> q, std::span<const double> p, double t) {
    const Map<const MatrixXd> mass = nearby.mass_at(q, p, t);
    return mass.allFinite() && !rank_of(mass).full();
  };
  if (problem.initial && singular_at(problem.initial->q, problem.initial->p, 0)) return true;
  std::vector<double> q, p;
  const double t = NearbyPoints(problem).next(q, p);
  return singular_at(q, std::vector<double>(p.size(), 0), t);
}

}  // namespace

bool is_regular(const Problem& problem) { return irregular(problem) < 0; }

void check_regular(const Problem& problem, const SystemTable& system) {
  if (system.hamiltonian) return;
  if (const int found = irregular(problem); found >= 0) refuse_irregular(problem, found, system.law().at);
}

bool has_legendre_transform(const Problem& problem) {
  const Lagrangian* hamiltonian = hamiltonian_of(*problem.lagrangian);
  if (!hamiltonian || problem.coordinates() > largest_dense) return is_regular(problem);
  return has_one_signature(problem, *hamiltonian) && !is_singular_at_rest(problem, *hamiltonian);
}

}  // namespace extremal
