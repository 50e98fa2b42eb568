#include "solve/guess/loop.hpp"
#include "solve/guess/limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "action/discrete_action.hpp"
#include "linear/dense.hpp"

namespace extremal {

using namespace limits::loop;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// R x + c = x + d with R d = d: paths that close in the simplest way are x + τ d. The x nearest to `mean`.
struct SimplePath {
  VectorXd centre, drift;
};
SimplePath simple_path(const ClosingMap& map, const VectorXd& mean) {
  const MatrixXd a = MatrixXd::Identity(map.r.rows(), map.r.cols()) - map.r;
  const VectorXd drift = map.c - a * least_norm(a, map.c);
  return {mean - least_norm(a, a * mean - (map.c - drift)), drift};
}

/// Extents that are alike for all coordinates that R mixes, so that they commute with R.
void level(const MatrixXd& r, std::vector<double>& extent) {
  for (bool changed = true; changed;) {
    changed = false;
    for (Eigen::Index a = 0; a < r.rows(); ++a)
      for (Eigen::Index b = 0; b < r.cols(); ++b)
        if (r(a, b) != 0 && extent[a] != extent[b]) {
          extent[a] = extent[b] = std::max(extent[a], extent[b]);
          changed = true;
        }
  }
}

}  // namespace

ClosedNoise::ClosedNoise(const Problem& problem) {
  const int n = problem.coordinates();
  if (!problem.periodic || n > most_coordinates) return;
  const ClosingMap map = closing_map(problem);
  std::vector<double> phases;
  const auto add = [&](const Eigen::VectorXcd& vector, std::complex<double> value) {
    if (std::abs(std::abs(value) - 1) > unit_modulus) return;
    vectors_.push_back(vector);
    phases.push_back(std::arg(value));
  };
  if (map.r.isIdentity(0)) {
    for (int a = 0; a < n; ++a) add(Eigen::VectorXcd::Unit(n, a), 1);
  } else {
    const ComplexEigen eigen = complex_eigen(map.r, same_frequency);
    for (int k = 0; k < n; ++k) add(eigen.vectors.col(k), eigen.values[k]);
  }
  for (std::size_t v = 0; v < vectors_.size(); ++v)
    for (int k = -most_turns; k <= most_turns; ++k) {
      const double omega = phases[v] + 2 * pi * k;  // −ω belongs to the complex conjugate
      if (omega > -same_frequency) modes_.push_back({v, omega, 0, 0});
    }
  std::stable_sort(modes_.begin(), modes_.end(),
                   [](const Mode& a, const Mode& b) { return a.omega < b.omega - same_frequency; });
  double before = 0;
  int rank = 0;
  for (Mode& mode : modes_) {
    if (mode.omega > before + same_frequency) ++rank;
    before = mode.omega;
    mode.rank = rank;
  }
}

void ClosedNoise::draw(unsigned seed, int frequencies, double decay) {
  Noise noise(seed);
  for (drawn_ = 0; drawn_ < modes_.size() && modes_[drawn_].rank <= frequencies; ++drawn_) {
    Mode& mode = modes_[drawn_];
    const double size = mode.rank == 0 ? offset : std::pow(mode.rank, -decay);
    const double real = noise(), imaginary = noise();
    mode.amplitude = size * std::complex<double>(real, imaginary);
  }
}

void ClosedNoise::at(double tau, std::span<double> q) const {
  std::fill(q.begin(), q.end(), 0.0);
  for (std::size_t m = 0; m < drawn_; ++m) {
    const std::complex<double> factor = modes_[m].amplitude * std::polar(1.0, modes_[m].omega * tau);
    const Eigen::VectorXcd& vector = vectors_[modes_[m].vector];
    for (std::size_t a = 0; a < q.size(); ++a) q[a] += (factor * vector[static_cast<Eigen::Index>(a)]).real();
  }
}

bool bend_closed(const Problem& problem, const Bend& bend, const ElementTables& tables, Path& path) {
  ClosedNoise noise(problem);
  if (!noise.usable()) return false;
  std::vector<double> extent = extents(path, negligible_extent[bend.seed % 2]), q(extent.size());
  level(closing_map(problem).r, extent);
  noise.draw(bend.seed, bend.modes, 1);
  const std::size_t n = extent.size();
  const auto add = [&](double tau, double* point) {
    noise.at(tau, q);
    for (std::size_t a = 0; a < n; ++a) point[a] += bend.size * extent[a] * q[a];
  };
  std::vector<double> ends(path.node(0), path.node(0) + n);
  ends.insert(ends.end(), path.node(path.elements()), path.node(path.elements()) + n);
  add(0, ends.data());
  add(1, ends.data() + n);
  fill_path(ends, tables, path, add);
  return true;
}

Loops::Loops(const Problem& problem, const Problem& like) : problem_(problem), noise_(problem) {
  if (!usable()) return;
  const int n = problem.coordinates();
  const ClosingMap map = closing_map(problem);
  VectorXd mean = VectorXd::Zero(n), q(n), low = VectorXd::Constant(n, INFINITY), high = -low;
  scaled_ = like.guess.given();
  const VectorXd drift = simple_path(closing_map(like), mean).drift;
  for (int k = 0; k < samples && scaled_; ++k) {
    const double tau = (k + 0.5) / samples;
    like.guess.at(tau, {q.data(), static_cast<std::size_t>(n)});
    q -= tau * drift;
    mean += q / samples;
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  const SimplePath simple = simple_path(map, mean);
  centre_ = simple.centre;
  drift_ = simple.drift;
  const VectorXd range = scaled_ ? VectorXd((high - low) / 2) : VectorXd::Ones(n);
  const double most = range.maxCoeff();
  for (int kind = 0; kind < 2; ++kind) {
    for (double x : range)
      extents_[kind].push_back(most > 0 ? (x < negligible_extent[kind] * most ? most : x) : 1);
    level(map.r, extents_[kind]);
  }
}

void Loops::draw(unsigned seed) {
  constexpr int frequencies[] = {3, 2, 5, 4, 8, 1, 6};
  constexpr double decays[] = {1, 0.5, 1.5, 0};
  noise_.draw(seed, frequencies[seed % std::size(frequencies)], decays[(seed / 2) % std::size(decays)]);
  extent_ = extents_[seed % 2];
  // Its largest range becomes that of the guess.
  const std::size_t n = extent_.size();
  std::vector<double> q(n), low(n, INFINITY), high(n, -INFINITY);
  for (int k = 0; k < samples; ++k) {
    noise_.at(static_cast<double>(k) / samples, q);
    for (std::size_t a = 0; a < n; ++a) {
      low[a] = std::min(low[a], q[a]);
      high[a] = std::max(high[a], q[a]);
    }
  }
  double most = 0;
  for (std::size_t a = 0; a < n; ++a) most = std::max(most, (high[a] - low[a]) / 2);
  for (double& x : extent_) x /= most > 0 ? most : 1;
  size_ = 1;
  duration_ = problem_.duration.value;
}

void Loops::fill(const ElementTables& tables, Path& path) const {
  const std::size_t n = extent_.size();
  path.set_duration(duration_);
  const auto at = [&](double tau, double* q) {
    noise_.at(tau, {q, n});
    for (std::size_t a = 0; a < n; ++a)
      q[a] = centre_[static_cast<Eigen::Index>(a)] + tau * drift_[static_cast<Eigen::Index>(a)] +
             size_ * extent_[a] * q[a];
  };
  std::vector<double> ends(2 * n);
  at(0, ends.data());
  at(1, ends.data() + n);
  fill_path(ends, tables, path, at);
}

/// S of the loop with `size`. Where the energy E is given, S + E T at the best duration: of
/// S = K/T + G − V T, as for all L of second degree in q', K/T² = E − V. NaN where there is none.
double Loops::reduced_action(DiscreteAction& action, const ElementTables& tables, Path& path, double size) {
  size_ = size;
  const auto at = [&](double duration) {
    duration_ = duration;
    fill(tables, path);
    action.evaluate_plain(path);
    return action.action();
  };
  const double T = problem_.duration.value;
  if (!problem_.duration.free || !problem_.duration.energy) return at(T);
  const double s1 = at(T), s2 = at(2 * T), s4 = at(4 * T);
  // Differences leave out G: a = s2 − s1 = −K/2T − VT, b = s4 − s2 = −K/4T − 2VT.
  const double a = s2 - s1, b = s4 - s2;
  const double K = T * (4 * (b - 2 * a) / 3), V = -(a + K / (2 * T)) / T;
  const double speed = *problem_.duration.energy - V;
  if (!(K > 0 && speed > 0)) return NAN;
  duration_ = std::sqrt(K / speed);
  return 2 * std::sqrt(K * speed) + s1 - K / T + V * T;
}

double Loops::fit_size(DiscreteAction& action, const ElementTables& tables, Path& path) {
  const int steps = steps_an_octave * (scaled_ ? octaves_of_guess : most_octaves);
  const auto size_at = [](double k) { return std::pow(2.0, k / steps_an_octave); };
  double found = 0, nearest = INFINITY, x = NAN, y = NAN;
  for (int k = -steps; k <= steps; ++k) {
    const double z = reduced_action(action, tables, path, size_at(k));
    // Through three points there is a parabola.
    if ((y - x) * (z - y) < 0 && std::abs(k - 1) < nearest) {
      nearest = std::abs(k - 1);
      found = k - 1 + 0.5 * (x - z) / (x - 2 * y + z);
    }
    x = y;
    y = z;
  }
  size_ = 1;
  duration_ = problem_.duration.value;
  if (nearest < INFINITY && std::isnan(reduced_action(action, tables, path, size_at(found)))) {
    size_ = 1;
    duration_ = problem_.duration.value;
  }
  return duration_;
}

}  // namespace extremal
