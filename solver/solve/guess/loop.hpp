#pragma once

#include <Eigen/Dense>
#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "problem/closing.hpp"
#include "problem/problem.hpp"
#include "solve/guess/first_path.hpp"

/// \file Random paths that close as a periodic problem asks.

namespace extremal {

class DiscreteAction;

/// Smooth deterministic noise with δ(t + T) = R δ(t): Σ c u exp(iωt/T), real parts, over the eigenvectors u
/// of R, R u = exp(iφ) u, and ω = φ + 2πk. So a permutation of n bodies gives Fourier series of period nT on
/// a common curve.
class ClosedNoise {
 public:
  explicit ClosedNoise(const Problem& problem);
  static constexpr int most_coordinates = 256;
  /// Not for a problem that is not periodic, or has more coordinates.
  bool usable() const { return !vectors_.empty(); }

  /// Draws amplitudes for so many of the lowest distinct frequencies (but ω = 0), which fall like
  /// 1/rank^decay, and for ω = 0.
  void draw(unsigned seed, int frequencies, double decay);
  /// δ at τ = t/T, n entries.
  void at(double tau, std::span<double> q) const;

 private:
  struct Mode {
    std::size_t vector;
    double omega;
    int rank;  ///< of ω among the distinct frequencies; 0 for ω = 0
    std::complex<double> amplitude;
  };
  std::vector<Eigen::VectorXcd> vectors_;
  std::vector<Mode> modes_;  ///< by rank
  std::size_t drawn_ = 0;
};

/// Adds noise that leaves a path closed, its ends moved as well. False if the problem is not periodic, or has
/// too many coordinates.
bool bend_closed(const Problem& problem, const Bend& bend, const ElementTables& tables, Path& path);

/// Random loops of the size that forces give them.
class Loops {
 public:
  /// Of `problem`, about as large as the guess of `like`.
  Loops(const Problem& problem, const Problem& like);
  bool usable() const { return noise_.usable(); }

  void draw(unsigned seed);
  unsigned count = 0;  ///< drawn so far
  /// Fills `path`, which has the problem's duration or another.
  void fill(const ElementTables& tables, Path& path) const;
  /// Size, and duration where that is free, at which the action is stationary against both: that of the path
  /// in `path`, which is filled in the course. Bodies under gravitation then obey the theorem of the virial.
  /// Where there is no such size near that of the guess, that of the guess.
  double fit_size(DiscreteAction& action, const ElementTables& tables, Path& path);

 private:
  double reduced_action(DiscreteAction& action, const ElementTables& tables, Path& path, double size);

  const Problem& problem_;
  ClosedNoise noise_;
  Eigen::VectorXd centre_, drift_;  ///< a path with q(T) = R q(0) + c: centre + τ drift
  std::vector<double> extent_;      ///< by which noise is multiplied, commutes with R
  std::vector<double> extents_[2];
  bool scaled_ = false;  ///< by a guess
  double size_ = 1, duration_ = 0;
};

}  // namespace extremal
