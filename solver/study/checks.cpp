#include "study/checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "machine/simd.hpp"
#include "problem/nearby.hpp"
#include "system/hamiltonian.hpp"

namespace extremal {
namespace {

constexpr int tries = 64;
constexpr int largest_dense = 200;  ///< matrices that eigenvalues are taken of
constexpr double singular = 1e-12;

/// The smallest eigenvalue over the largest, in modulus, of the mass matrix brought to unit rows; `weak` is
/// the coordinate that its eigenvector has most of.
double regularity(Eigen::MatrixXd mass, int& weak) {
  for (int pass = 0; pass < 4; ++pass) {
    Eigen::VectorXd row = mass.cwiseAbs().rowwise().maxCoeff();
    for (double& r : row) r = r > 0 ? 1 / std::sqrt(r) : 1;
    mass = row.asDiagonal() * mass * row.asDiagonal();
  }
  const SymmetricEigen eigen = symmetric_eigen(mass);
  const Eigen::VectorXd size = eigen.values.cwiseAbs();
  Eigen::Index smallest;
  const double least = size.minCoeff(&smallest);
  eigen.vectors.col(smallest).cwiseAbs().maxCoeff(&weak);
  return size.maxCoeff() > 0 ? least / size.maxCoeff() : 0;
}

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

/// Whether q'·∂L/∂q' = L, but L²/2 is regular: L gives the length of a path.
bool is_length(const Problem& problem) {
  constexpr int needed = 8;
  constexpr double roundoff = 1e-10, singular = 1e-10;
  const int n = problem.coordinates();
  NearbyPoints points(problem);
  Scratch scratch;
  std::vector<double> q, v;
  int found = 0, weak = 0;
  for (int k = 0; k < tries && found < needed; ++k) {
    const double t = points.next(q, v);
    const PointValues at = evaluate_at(*problem.lagrangian, q, v, t, Order::hessian, scratch);
    const Eigen::Map<const Eigen::VectorXd> p(at.dv.data(), n);
    const Eigen::Map<const Eigen::MatrixXd> mass(at.vv.data(), n, n);
    if (!std::isfinite(at.value) || !p.allFinite() || !mass.allFinite() || at.value == 0) continue;
    const double work = p.dot(Eigen::Map<const Eigen::VectorXd>(v.data(), n));
    if (!(std::abs(work - at.value) <= roundoff * std::abs(at.value))) return false;
    if (!(regularity(p * p.transpose() + at.value * mass, weak) > singular)) return false;
    ++found;
  }
  return found == needed;
}

[[noreturn]] void refuse_irregular(const Problem& problem, int coordinate, const Location& at) {
  if (is_length(problem))
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
bool is_regular(const Problem& problem, const Lagrangian& hamiltonian) {
  constexpr double sizes[] = {1, 0.1, 10};
  const int n = problem.coordinates();
  NearbyPoints points(problem);
  Scratch scratch;
  std::vector<double> q, p;
  int found = 0, weak = 0, first = -1;
  for (int k = 0; k < tries; ++k) {
    const double t = points.next(q, p);
    for (double& component : p) component *= sizes[k % std::size(sizes)];
    const PointValues values = evaluate_at(hamiltonian, q, p, t, Order::hessian, scratch);
    const Eigen::Map<const Eigen::MatrixXd> mass(values.vv.data(), n, n);
    if (!mass.allFinite()) continue;
    ++found;
    if (!(regularity(mass, weak) > singular)) continue;
    const auto negative = static_cast<int>((symmetric_eigenvalues(mass).array() < 0).count());
    if (first >= 0 && negative != first) return false;
    first = negative;
  }
  return found == 0 || first >= 0;
}

/// Whether H_pp is finite and singular where momenta vanish, as that of p^4 is, or at initial data: motions
/// come there.
bool is_singular_at_rest(const Problem& problem, const Lagrangian& hamiltonian) {
  const int n = problem.coordinates();
  NearbyPoints points(problem);
  Scratch scratch;
  std::vector<double> q, p;
  const auto singular_at = [&](const std::vector<double>& momenta, double t) {
    int weak = 0;
    const PointValues values = evaluate_at(hamiltonian, q, momenta, t, Order::hessian, scratch);
    const Eigen::Map<const Eigen::MatrixXd> mass(values.vv.data(), n, n);
    return mass.allFinite() && !(regularity(mass, weak) > singular);
  };
  if (problem.initial) {
    q = problem.initial->q;
    if (singular_at(problem.initial->p, 0)) return true;
  }
  const double t = points.next(q, p);
  return singular_at(std::vector<double>(n, 0), t);
}

/// A coordinate whose velocity the momenta do not determine near the guess, or -1.
int irregular(const Problem& problem) {
  constexpr int needed = 3;
  const int n = problem.coordinates(), without = massless(problem.lagrangian->structure());
  if (without >= 0 || n > largest_dense) return without;
  NearbyPoints points(problem);
  Scratch scratch;
  std::vector<double> q, v;
  int found = 0, weak = 0;
  for (int k = 0; k < tries && found < needed; ++k) {
    const double t = points.next(q, v);
    const PointValues values = evaluate_at(*problem.lagrangian, q, v, t, Order::hessian, scratch);
    const Eigen::Map<const Eigen::MatrixXd> mass(values.vv.data(), n, n);
    if (!mass.allFinite()) continue;
    if (regularity(mass, weak) > singular) return -1;
    ++found;
  }
  return found == 0 ? -1 : weak;
}

std::string point_text(const Problem& problem, const double* q) {
  std::string text;
  const int shown = std::min(problem.coordinates(), 6);
  for (int a = 0; a < shown; ++a) text += fmt::format("{}{} = {:.6g}", a ? ", " : "", problem.names[a], q[a]);
  return text + (shown < problem.coordinates() ? ", …" : "");
}

bool wholly_fixed(const EndMap& ends, bool at_end) {
  const std::size_t n = ends.fixed.size() / 2;
  const auto begin = ends.fixed.begin() + (at_end ? n : 0);
  return std::all_of(begin, begin + n, [](char fixed) { return fixed; });
}

/// Samples of the guess in batches, as structure of arrays, and the value of L's remainder there.
class GuessValues {
 public:
  explicit GuessValues(const Problem& problem) : problem_(problem), n_(problem.coordinates()) {
    stride_ = 8 * most_lanes;
    rows_ = inputs_.reserve(std::size_t(2 * n_ + 2) * stride_);
  }

  /// The first sample from `first` on where L is not finite, or -1.
  int first_not_finite(int first, int count) {
    for (int begin = first; begin < first + count; begin += stride_) {
      const int used = std::min<int>(stride_, first + count - begin);
      for (int i = 0; i < stride_; ++i) load(begin + std::min(i, used - 1), i);
      double* value = rows_ + (2 * n_ + 1) * stride_;
      const Points points{static_cast<int>(stride_), stride_, rows_, rows_ + n_ * stride_,
                          rows_ + 2 * n_ * stride_};
      problem_.lagrangian->evaluate(points, Order::value, value, scratch_);
      for (int i = 0; i < used; ++i)
        if (!std::isfinite(value[i])) return begin + i;
    }
    return -1;
  }

 private:
  /// Sample k into lane i, with the velocity of the chord through its neighbours.
  void load(int k, int i) {
    const Guess& guess = problem_.guess;
    const int last = static_cast<int>(guess.tau.size()) - 1;
    const int before = std::max(k - 1, 0), after = std::min(k + 1, last);
    const double span = (guess.tau[after] - guess.tau[before]) * problem_.duration.value;
    for (int a = 0; a < n_; ++a) {
      rows_[a * stride_ + i] = guess.q[std::size_t(k) * n_ + a];
      rows_[(n_ + a) * stride_ + i] =
          (guess.q[std::size_t(after) * n_ + a] - guess.q[std::size_t(before) * n_ + a]) / span;
    }
    rows_[2 * n_ * stride_ + i] = guess.tau[k] * problem_.duration.value;
  }

  const Problem& problem_;
  int n_;
  std::ptrdiff_t stride_;
  Scratch inputs_, scratch_;
  double* rows_;
};

}  // namespace

void check_guess_finite(const Problem& problem, const Location& at) {
  const Guess& guess = problem.guess;
  if (!guess.given()) return;
  const int first = wholly_fixed(problem.ends, false),
            after = static_cast<int>(guess.tau.size()) - wholly_fixed(problem.ends, true);
  const int k = GuessValues(problem).first_not_finite(first, after - first);
  if (k >= 0)
    throw SceneError(
        at,
        fmt::format("L is not finite on the guess at t = {:.6g}: {}", guess.tau[k] * problem.duration.value,
                    point_text(problem, guess.q.data() + std::size_t(k) * problem.coordinates())));
}

void check_regular(const Problem& problem, const SystemTable& system) {
  if (system.hamiltonian) return;
  if (const int found = irregular(problem); found >= 0) refuse_irregular(problem, found, system.law().at);
}

bool has_legendre_transform(const Problem& problem) {
  const Lagrangian* hamiltonian = hamiltonian_of(*problem.lagrangian);
  if (!hamiltonian || problem.coordinates() > largest_dense) return irregular(problem) < 0;
  return is_regular(problem, *hamiltonian) && !is_singular_at_rest(problem, *hamiltonian);
}

void check_energy_at_ends(const Problem& problem, const Location& at) {
  constexpr double roundoff = 1e-9;
  if (!problem.duration.energy) return;
  const std::size_t n = problem.coordinates();
  const double energy = *problem.duration.energy;
  Scratch scratch;
  std::vector<double> unused, v, rest(n, 0);
  for (const bool end : {false, true}) {
    if (!wholly_fixed(problem.ends, end)) continue;
    const double* q = problem.ends.offset.data() + (end ? n : 0);
    NearbyPoints points(problem);
    const auto convex = [&](const std::vector<double>& velocity) {
      const PointValues values =
          evaluate_at(*problem.lagrangian, {q, n}, velocity, 0, Order::hessian, scratch);
      const Eigen::Map<const Eigen::MatrixXd> mass(values.vv.data(), n, n);
      return mass.allFinite() && mass.llt().info() == Eigen::Success;
    };
    bool bounded = convex(rest);
    for (int k = 0; k < 8 && bounded; ++k) {
      points.next(unused, v);
      bounded = convex(v);
    }
    const double least = -evaluate_at(*problem.lagrangian, {q, n}, rest, 0, Order::value, scratch).value;
    if (bounded && energy < least - roundoff * std::max(std::abs(energy), std::abs(least)))
      throw SceneError(
          at, fmt::format(
                  "energy = {}, but at the {} ({}) it is at least {:.6g}, its value at rest; raise it, or "
                  "move this end",
                  energy, end ? "end" : "start", point_text(problem, q), least));
  }
}

void check_free_steps(const Problem& problem, const Location& at) {
  if (problem.phase)
    throw SceneError(at,
                     "free steps need a Hamiltonian whose second derivative by the momenta is regular; leave "
                     "'steps' out");
  if (!problem.lagrangian->structure().autonomous)
    throw SceneError(at,
                     "free steps give all elements the same energy, which is not conserved where L depends "
                     "on t; leave 'steps' out");
  if (problem.copies)
    throw SceneError(at,
                     "free steps give all elements the same energy, which forces change; leave 'steps' out");
  if (problem.initial)
    throw SceneError(at,
                     "free steps need ends: from initial data each element follows the one before; leave "
                     "'steps' out");
  if (problem.periodic)
    throw SceneError(at,
                     "free steps need ends: the nodes of a closed orbit can all be shifted along it; leave "
                     "'steps' out, or give start and end");
  if (problem.duration.where)
    throw SceneError(at, "with free steps a free duration is closed by 'energy', not by 'where'");
  if (problem.lagrangian->kinks())
    throw SceneError(at, "free steps need a smooth L, without abs, min, max and step; leave 'steps' out");
}

}  // namespace extremal
