#include "distance.hpp"

#include <cmath>
#include <vector>

#include "study/files/guess_file.hpp"

namespace bench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd first_state(const std::string& csv, const std::vector<std::string>& names) {
  std::vector<std::string> primed;
  for (const std::string& name : names) primed.push_back(name + "'");
  const auto q = extremal::read_guess_file(csv, names, {}).q,
             v = extremal::read_guess_file(csv, primed, {}).q;
  const auto n = static_cast<Eigen::Index>(names.size());
  VectorXd state(2 * n);
  state << Eigen::Map<const VectorXd>(q.data(), n), Eigen::Map<const VectorXd>(v.data(), n);
  return state;
}

/// An orbit and what the symmetries x -> A x + b have made of it so far.
class MovingOrbit {
 public:
  MovingOrbit(const extremal::Problem& problem, const Orbit& orbit)
      : orbit_(orbit),
        generators_(problem.symmetries),
        n_(problem.coordinates()),
        a_(MatrixXd::Identity(n_, n_)),
        b_(VectorXd::Zero(n_)) {}

  Eigen::Index parameters() const { return 1 + std::ssize(generators_); }

  VectorXd state(double by = 0) const {
    const double T = orbit_.period, wrapped = std::fmod(t_ + by, T);
    const VectorXd given = orbit_.state(std::min(wrapped < 0 ? wrapped + T : wrapped, T));
    VectorXd result(2 * n_);
    result << a_ * given.head(n_) + b_, a_ * given.tail(n_);
    return result;
  }

  /// Of the state, by time and by each generator.
  MatrixXd slopes() const {
    MatrixXd result(2 * n_, parameters());
    const double small = 1e-6 * orbit_.period;
    result.col(0) = (state(small) - state(-small)) / (2 * small);
    const VectorXd here = state();
    for (Eigen::Index j = 1; j < parameters(); ++j)
      result.col(j) << matrix(j) * here.head(n_) + shift(j), matrix(j) * here.tail(n_);
    return result;
  }

  /// By Cayley's formula, which does not leave the group of a quadratic form.
  void move(const VectorXd& by) {
    t_ += by[0];
    MatrixXd g = MatrixXd::Zero(n_, n_);
    VectorXd c = VectorXd::Zero(n_);
    for (Eigen::Index j = 1; j < parameters(); ++j) {
      g += by[j] * matrix(j);
      c += by[j] * shift(j);
    }
    const MatrixXd one = MatrixXd::Identity(n_, n_);
    const auto half = (one - g / 2).partialPivLu();
    a_ = half.solve((one + g / 2) * a_).eval();
    b_ = half.solve((one + g / 2) * b_ + c).eval();
  }

 private:
  MatrixXd matrix(Eigen::Index j) const {
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        generators_[j - 1].matrix.data(), n_, n_);
  }
  VectorXd shift(Eigen::Index j) const {
    return Eigen::Map<const VectorXd>(generators_[j - 1].shift.data(), n_);
  }

  const Orbit& orbit_;
  const std::vector<extremal::Generator>& generators_;
  Eigen::Index n_;
  double t_ = 0;
  MatrixXd a_;
  VectorXd b_;
};

}  // namespace

Orbit orbit_of(const extremal::Solution& solution) {
  const extremal::Trajectory& path = solution.trajectory;
  return {path.duration(), [&path](double t) {
            const auto n = static_cast<std::size_t>(path.coordinates);
            VectorXd state(2 * path.coordinates);
            path.at(t, {state.data(), n}, {state.data() + n, n});
            return state;
          }};
}

double distance_from_orbit(const std::string& csv, const extremal::Study& study, const Orbit& orbit) {
  constexpr int steps = 8;  // of Gauss and Newton, from a phase that is near
  const VectorXd wanted = first_state(csv, study.system.names);
  MovingOrbit moving(study.problem, orbit);
  for (int step = 0; step < steps; ++step)
    moving.move(moving.slopes().completeOrthogonalDecomposition().solve(wanted - moving.state()));
  return (wanted - moving.state()).norm();
}

}  // namespace bench
