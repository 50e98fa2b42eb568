#include "study/deviation.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int intervals = 400;
constexpr int most_alignments = 50;
/// Of the duration: beyond, the phases are no longer near each other.
constexpr double longest_shift = 0.25;
/// Moves that the samples do not tell apart, relative.
constexpr double same_move = 1e-9;

/// What is done to a motion before it is compared: q(t + delay) becomes turn q + shift.
struct Alignment {
  double delay = 0;
  MatrixXd turn;
  VectorXd shift;
};

/// The differences at the times that both have, and the moves that would make them least in the mean: by
/// time, then by each symmetry.
struct Difference {
  double largest = 0, mean_square = 0;
  VectorXd moves;
};

class Aligner {
 public:
  Aligner(const Motion& motion, const Motion& reference, int coordinates, const Invariance& invariance)
      : motion_(motion), reference_(reference), n_(coordinates), invariance_(invariance) {}

  double least() const {
    Alignment at{0, MatrixXd::Identity(n_, n_), VectorXd::Zero(n_)};
    Difference now = difference(at);
    for (int k = 0; k < most_alignments && now.moves.size() > 0; ++k) {
      Alignment next = moved(at, now.moves);
      if (!(std::abs(next.delay) <= longest_shift * reference_.duration)) break;
      Difference aligned = difference(next);
      if (!(aligned.mean_square < now.mean_square)) break;
      at = std::move(next);
      now = std::move(aligned);
    }
    return now.largest;
  }

 private:
  Difference difference(const Alignment& by) const {
    std::vector<double> here, there, beyond;
    for (int k = 0; k <= intervals; ++k) {
      const double t = k == intervals ? reference_.duration : reference_.duration * k / intervals;
      const double wanted = t + by.delay, own = std::clamp(wanted, 0.0, motion_.duration);
      if (invariance_.in_time && by.delay != 0 && own != wanted) continue;
      here.push_back(t);
      there.push_back(own);
      beyond.push_back(wanted - own);
    }
    const MotionSamples a = motion_.at(there), b = reference_.at(here);
    Difference result;
    if (a.q.size() < b.q.size()) {
      result.largest = result.mean_square = std::numeric_limits<double>::infinity();
      return result;
    }
    const Index rows = std::ssize(here), first = invariance_.in_time ? 1 : 0,
                moves = first + std::ssize(invariance_.symmetries);
    VectorXd apart(rows * n_);
    MatrixXd by_move(rows * n_, moves);
    for (Index k = 0; k < rows; ++k) {
      const auto row = Eigen::seqN(k * n_, n_);
      const VectorXd v = by.turn * Eigen::Map<const VectorXd>(a.v.data() + k * n_, n_),
                     q = by.turn * Eigen::Map<const VectorXd>(a.q.data() + k * n_, n_) + by.shift +
                         beyond[k] * v;
      apart(row) = q - Eigen::Map<const VectorXd>(b.q.data() + k * n_, n_);
      if (first) by_move(row, 0) = v;
      for (Index j = first; j < moves; ++j) {
        const Generator& generator = invariance_.symmetries[j - first];
        by_move(row, j) = matrix_of(generator) * q + shift_of(generator);
      }
    }
    if (rows == 0) return result;
    result.largest = apart.lpNorm<Eigen::Infinity>();
    result.mean_square = apart.squaredNorm() / static_cast<double>(rows);
    if (moves == 0) return result;
    result.moves = least_norm(by_move, -apart, same_move);
    return result;
  }

  /// A symmetry with δq = G q + c moves paths by exp of the affine map.
  Alignment moved(const Alignment& at, const VectorXd& moves) const {
    Alignment result = at;
    const Index first = invariance_.in_time ? 1 : 0;
    if (first) result.delay += moves[0];
    MatrixXd affine = MatrixXd::Zero(n_ + 1, n_ + 1);
    for (Index j = first; j < moves.size(); ++j) {
      const Generator& generator = invariance_.symmetries[j - first];
      affine.topLeftCorner(n_, n_) += moves[j] * matrix_of(generator);
      affine.topRightCorner(n_, 1) += moves[j] * shift_of(generator);
    }
    const MatrixXd move = affine.exp();
    result.turn = move.topLeftCorner(n_, n_) * at.turn;
    result.shift = move.topLeftCorner(n_, n_) * at.shift + move.topRightCorner(n_, 1);
    return result;
  }

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<const RowMajor> matrix_of(const Generator& generator) const {
    return {generator.matrix.data(), n_, n_};
  }
  Eigen::Map<const VectorXd> shift_of(const Generator& generator) const {
    return {generator.shift.data(), n_};
  }

  const Motion& motion_;
  const Motion& reference_;
  Index n_;
  const Invariance& invariance_;
};

}  // namespace

Invariance invariance_of(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  Invariance result{problem.periodic && problem.motion().structure().autonomous, {}};
  // Of two copies, symmetries move one at a time: those of the first.
  for (const Generator& found : (problem.pair ? *problem.pair : problem).symmetries) {
    const std::size_t width = found.shift.size();
    Generator one{{}, {found.shift.begin(), found.shift.begin() + n}};
    for (std::size_t a = 0; a < n; ++a)
      one.matrix.insert(one.matrix.end(), found.matrix.begin() + a * width,
                        found.matrix.begin() + a * width + n);
    const auto moves = [](double x) { return x != 0; };
    if (std::ranges::any_of(one.matrix, moves) || std::ranges::any_of(one.shift, moves))
      result.symmetries.push_back(std::move(one));
  }
  return result;
}

Motion motion_of(const Trajectory& trajectory) {
  return {
      trajectory.duration(), [&trajectory](const std::vector<double>& times) {
        const std::size_t n = trajectory.coordinates;
        MotionSamples samples{std::vector<double>(times.size() * n), std::vector<double>(times.size() * n)};
        for (std::size_t k = 0; k < times.size(); ++k)
          trajectory.at(times[k], {samples.q.data() + k * n, n}, {samples.v.data() + k * n, n});
        return samples;
      }};
}

double deviation(const Motion& motion, const Motion& reference, int coordinates,
                 const Invariance& invariance) {
  return Aligner(motion, reference, coordinates, invariance).least();
}

}  // namespace extremal
