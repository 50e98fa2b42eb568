#include "study/guess/guess_momenta.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Samples at which momenta are looked for; between them they are linear.
constexpr int fit_places = 64;
constexpr int most_fit_steps = 30;
/// Damping relative to the largest derivative, at first and at most; a residual that has fallen so far.
constexpr double first_fit_damping = 1e-3, most_fit_damping = 1e6, fit_enough = 1e-10;

/// Least squares of ∂H/∂p − v, and of H − E, by the method of Levenberg and Marquardt.
class MomentumFit {
 public:
  MomentumFit(const Lagrangian& hamiltonian, const std::vector<GuessKnows>& known,
              std::optional<double> energy)
      : hamiltonian_(hamiltonian), energy_(energy) {
    for (std::size_t a = 0; a < known.size(); ++a) {
      if (known[a] == GuessKnows::velocity) free_.push_back(static_cast<Eigen::Index>(a));
      if (known[a] != GuessKnows::momentum) moving_.push_back(static_cast<Eigen::Index>(a));
    }
  }

  /// Improves p; false where H is not finite.
  bool run(const VectorXd& q, const VectorXd& v, double t, VectorXd& p) {
    if (!evaluate(q, v, t, p)) return false;
    double damping = first_fit_damping;
    for (int step = 0; step < most_fit_steps && residual_.norm() > fit_enough * v.norm(); ++step) {
      const MatrixXd slopes = slopes_;
      const VectorXd before = residual_, point = p;
      const double scale = slopes.cwiseAbs().maxCoeff();
      if (!(scale > 0)) return true;
      MatrixXd normal = slopes.transpose() * slopes;
      normal.diagonal().array() += damping * scale * scale;
      const VectorXd change = solved(normal, -slopes.transpose() * before);
      for (std::size_t k = 0; k < free_.size(); ++k) p[free_[k]] += change[static_cast<Eigen::Index>(k)];
      if (evaluate(q, v, t, p) && residual_.norm() < before.norm()) {
        damping *= 0.1;
        continue;
      }
      p = point;
      evaluate(q, v, t, p);
      damping *= 10;
      if (damping > most_fit_damping) break;
    }
    return true;
  }

 private:
  bool evaluate(const VectorXd& q, const VectorXd& v, double t, const VectorXd& p) {
    const auto n = q.size(), moving = std::ssize(moving_), rows = moving + energy_.has_value();
    const auto span = [](const VectorXd& x) { return std::span(x.data(), std::size_t(x.size())); };
    const PointValues at = evaluate_at(hamiltonian_, span(q), span(p), t, Order::hessian, scratch_);
    const Eigen::Map<const MatrixXd> mass(at.vv.data(), n, n);
    residual_.resize(rows);
    slopes_.resize(rows, std::ssize(free_));
    const Eigen::Map<const VectorXd> velocity(at.dv.data(), n);
    for (Eigen::Index k = 0; k < moving; ++k) residual_[k] = velocity[moving_[k]] - v[moving_[k]];
    if (energy_) residual_[moving] = at.value - *energy_;
    for (Eigen::Index k = 0; k < slopes_.cols(); ++k) {
      for (Eigen::Index j = 0; j < moving; ++j) slopes_(j, k) = mass(moving_[j], free_[k]);
      if (energy_) slopes_(moving, k) = velocity[free_[k]];
    }
    return residual_.allFinite() && slopes_.allFinite();
  }

  const Lagrangian& hamiltonian_;
  const std::optional<double> energy_;
  std::vector<Eigen::Index> free_, moving_;  ///< momenta that are looked for, velocities that are known
  VectorXd residual_;
  MatrixXd slopes_;
  Scratch scratch_;
};

/// Rows of samples, (q, p) each.
class Samples {
 public:
  explicit Samples(Problem& problem)
      : guess_(problem.guess), n_(problem.coordinates() / 2), duration_(problem.duration.value) {}

  int last() const { return static_cast<int>(guess_.tau.size()) - 1; }
  double time(int k) const { return guess_.tau[k] * duration_; }
  Eigen::Map<VectorXd> q(int k) { return {row(k), n_}; }
  Eigen::Map<VectorXd> p(int k) { return {row(k) + n_, n_}; }
  VectorXd velocity(int k) {
    const int before = std::max(k - 1, 0), after = std::min(k + 1, last());
    return (q(after) - q(before)) / (time(after) - time(before));
  }

 private:
  double* row(int k) { return guess_.q.data() + static_cast<std::size_t>(k) * 2 * n_; }

  Guess& guess_;
  Eigen::Index n_;
  double duration_;
};

}  // namespace

void complete_momenta(const LagrangianGraph& hamiltonian, const std::vector<GuessKnows>& known,
                      Problem& problem) {
  if (std::ranges::find(known, GuessKnows::velocity) == known.end() || !problem.guess.given()) return;
  const std::shared_ptr<const Lagrangian> h = make_lagrangian(hamiltonian);
  MomentumFit fit(*h, known, problem.duration.energy);
  Samples samples(problem);
  const auto n = samples.q(0).size();
  VectorXd moved = VectorXd::Zero(n), moved_before = moved;  // from what the samples have
  for (int place = 0, before = 0; place <= fit_places; ++place) {
    const int k = static_cast<int>(static_cast<long>(samples.last()) * place / fit_places);
    const VectorXd v = samples.velocity(k);
    VectorXd p = samples.p(k) + moved;
    if (!fit.run(samples.q(k), v, samples.time(k), p)) {
      // Where H is not smooth at rest.
      p = samples.p(k);
      for (Eigen::Index a = 0; a < n; ++a)
        if (known[a] == GuessKnows::velocity) p[a] += v[a];
      if (!fit.run(samples.q(k), v, samples.time(k), p)) p = samples.p(k) + moved;
    }
    moved_before = moved;
    moved = p - samples.p(k);
    if (place == 0) moved_before = moved;
    for (int j = before + (place > 0); j <= k; ++j) {
      const double share = k > before ? static_cast<double>(j - before) / (k - before) : 1;
      samples.p(j) += (1 - share) * moved_before + share * moved;
    }
    before = k;
  }
}

}  // namespace extremal
