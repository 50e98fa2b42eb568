#include "problem/phase_space.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXd;

/// Of the largest value: a smaller range is the roundoff of what is constant.
constexpr double roundoff_of_constant = 1e-10;
/// √(wv) by the duration. An eigenvalue −1/w of the second variation A, as H_pp = 1 makes it where w = 1, is
/// one of 0 of A + A W A: durations, masses and frequencies that are simple numbers must not make it.
constexpr double weight_by_duration = 1.0594630943592953;

/// What coordinates and momenta extend over.
struct Extents {
  double q = 0, p = 0;
};

/// Of the guess: the largest range of any, else the largest value.
Extents extents_of_guess(const Guess& guess, std::size_t n) {
  std::vector<double> low(2 * n, INFINITY), high(2 * n, -INFINITY);
  for (std::size_t k = 0; k < guess.q.size(); ++k) {
    low[k % (2 * n)] = std::min(low[k % (2 * n)], guess.q[k]);
    high[k % (2 * n)] = std::max(high[k % (2 * n)], guess.q[k]);
  }
  const auto extent = [&](std::size_t first) {
    double range = 0, size = 0;
    for (std::size_t a = first; a < first + n; ++a) {
      range = std::max(range, high[a] - low[a]);
      size = std::max({size, std::abs(low[a]), std::abs(high[a])});
    }
    return range > roundoff_of_constant * size ? range : size;
  };
  return {extent(0), extent(n)};
}

/// Of initial data: how fast they change, else their size.
Extents extents_of_start(const Lagrangian& hamiltonian, const std::vector<double>& state) {
  const std::size_t n = state.size() / 2;
  std::vector<double> rate(2 * n);
  Scratch scratch;
  hamilton_equations(hamiltonian, state, 0, rate, scratch);
  const auto extent = [&](std::size_t first) {
    double speed = 0, size = 0;
    for (std::size_t a = first; a < first + n; ++a) {
      speed = std::max(speed, std::abs(rate[a]));
      size = std::max(size, std::abs(state[a]));
    }
    return std::pair(speed, size);
  };
  const auto [q_speed, q_size] = extent(0);
  const auto [p_speed, p_size] = extent(n);
  if (q_speed > 0 && p_speed > 0 && std::isfinite(q_speed) && std::isfinite(p_speed))
    return {q_speed, p_speed};
  return {q_size, p_size};
}

/// √(wv) is about the duration; w/v makes the squares alike.
PhaseWeights weights_of(const Problem& problem, const Lagrangian& hamiltonian) {
  Extents extents = problem.initial ? extents_of_start(hamiltonian, problem.initial->q)
                                    : extents_of_guess(problem.guess, problem.coordinates() / 2);
  if (!(extents.q > 0)) extents.q = 1;
  if (!(extents.p > 0)) extents.p = extents.q;
  // A power of two: what is equal for q and p stays so to the last digit.
  const double ratio = std::exp2(std::round(std::log2(extents.p / extents.q)));
  const double scale = weight_by_duration * problem.duration.value;
  return {.velocity = scale * ratio, .force = scale / ratio};
}

/// Closed paths have the symmetric form, but for those that are shifted.
bool closes_linearly(const Problem& problem) {
  const std::vector<double>& shift = problem.boundary.value;
  return problem.periodic && std::ranges::all_of(shift, [](double x) { return x == 0; });
}

}  // namespace

void hamilton_equations(const Lagrangian& hamiltonian, std::span<const double> state, double t,
                        std::span<double> rate, Scratch& scratch) {
  const std::size_t n = state.size() / 2;
  const PointValues at =
      evaluate_at(hamiltonian, state.first(n), state.subspan(n), t, Order::gradient, scratch);
  for (std::size_t a = 0; a < n; ++a) {
    rate[a] = at.dv[a];
    rate[n + a] = -at.dq[a];
  }
}

void set_phase_space(const LagrangianGraph& hamiltonian, Problem& problem, const PhaseSpace* like) {
  PhaseSpace space;
  space.formula = std::make_shared<const LagrangianGraph>(hamiltonian);
  space.hamiltonian = make_lagrangian(hamiltonian);
  if (like) {
    space.weights = like->weights;
  } else {
    space.weights = weights_of(problem, *space.hamiltonian);
    space.weights.symmetric = closes_linearly(problem);
  }
  problem.lagrangian = phase_lagrangian(hamiltonian, space.weights);
  space.bare =
      phase_lagrangian(hamiltonian, {.velocity = 0, .force = 0, .symmetric = space.weights.symmetric});
  problem.phase = std::make_shared<const PhaseSpace>(std::move(space));
}

Problem with_shift(const Problem& problem, double shift) {
  PhaseSpace space = *problem.phase;
  space.weights.shift = shift;
  Problem result = problem;
  result.lagrangian = phase_lagrangian(*space.formula, space.weights);
  result.phase = std::make_shared<const PhaseSpace>(std::move(space));
  return result;
}

std::vector<Generator> phase_symmetries(Problem problem, const SymmetrySearch& search) {
  problem.lagrangian = problem.phase->bare;
  const std::vector<Generator> found = continuous_symmetries(problem, search);
  const Eigen::Index n = problem.coordinates(), count = std::ssize(found);
  if (count == 0) return found;
  constexpr double zero = 1e-6;
  MatrixXd linear(n * n, count), shifts(n, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Map<const MatrixXd> transposed(found[k].matrix.data(), n, n);
    linear.col(k) = transposed.transpose().reshaped();
    shifts.col(k) = Eigen::Map<const Eigen::VectorXd>(found[k].shift.data(), n);
  }
  // Combinations with G = 0.
  const SingularValues by_linear = singular_value_decomposition(linear);
  const double scale = std::max(linear.norm(), 1e-300);
  const auto vanishing = [&](const SingularValues& s, Eigen::Index k) {
    return k >= s.values.size() || s.values[k] <= zero * scale;
  };
  std::vector<Eigen::VectorXd> kept;
  MatrixXd translations(n, 0);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!vanishing(by_linear, k)) continue;
    kept.push_back(by_linear.v.col(k));
    translations.conservativeResize(n, translations.cols() + 1);
    translations.rightCols(1) = shifts * kept.back();
  }
  const MatrixXd span = translations.cols() > 0 ? orthonormal(translations) : translations;
  for (Eigen::Index k = 0; k < count; ++k) {
    auto matrix = linear.col(k).reshaped(n, n);
    matrix -= (span * (span.transpose() * matrix)).eval();
  }
  const SingularValues across = singular_value_decomposition(linear);
  for (Eigen::Index k = 0; k < count; ++k)
    if (!vanishing(across, k)) kept.push_back(across.v.col(k));
  std::vector<Generator> result;
  for (const Eigen::VectorXd& combination : kept) {
    Generator generator{std::vector<double>(n * n, 0), std::vector<double>(n, 0)};
    for (Eigen::Index k = 0; k < count; ++k) {
      for (Eigen::Index i = 0; i < n * n; ++i) generator.matrix[i] += combination[k] * found[k].matrix[i];
      for (Eigen::Index i = 0; i < n; ++i) generator.shift[i] += combination[k] * found[k].shift[i];
    }
    constexpr double roundoff = 1e-12;  // where it leaves a path as it is, roundoff would move it
    for (std::vector<double>* entries : {&generator.matrix, &generator.shift})
      for (double& x : *entries)
        if (std::abs(x) < roundoff) x = 0;
    result.push_back(std::move(generator));
  }
  return result;
}

}  // namespace extremal
