#include "analysis/spectrum.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// The window is (1 − cos 2πt/T)³: a line is 4 bins of 2π/T wide, and at Δ bins from another leaks Δ⁻⁷ of it.
constexpr int window_power = 3;
/// Two lines closer than this, in bins, are not told apart.
constexpr double least_distance = 1.5;
/// All lines are fitted together where the new one is closer to another than this, in bins, ...
constexpr double near = 2 * (window_power + 1);
/// ... and where their number has grown by this factor since they were last.
constexpr double growth = 1.25;
/// Changes after which waves are refined no further: while others are still to be found, and in the end.
constexpr double good_enough = 1e-9, roundoff = 1e-13;
/// Steps with one matrix.
constexpr int matrix_steps = 3;
/// Samples at a time.
constexpr Eigen::Index chunk = 2048;
/// Beyond so many bins the window leaks less than roundoff; sums that are nearer need no more points than
/// this.
constexpr double farthest = 64;
constexpr Eigen::Index most_points = 4 * 64;

/// a cos ωτ + b sin ωτ, τ from the middle of the signal: there the three hardly depend on each other.
struct Wave {
  double frequency = 0, a = 0, b = 0;
  double amplitude() const { return std::hypot(a, b); }
};

/// cos ωτ and sin ωτ at equal steps of τ: exact at every 32nd, turned from there by angles of a table, which
/// rounds once more and costs a tenth.
class Turns {
 public:
  Turns(double frequency, double step) : frequency_(frequency), step_(step) {
    for (int k = 0; k < length; ++k) {
      cosine_[k] = std::cos(frequency * (step * k));
      sine_[k] = std::sin(frequency * (step * k));
    }
  }
  /// At tau, tau + step, …, as many as there are places.
  void fill(double tau, Eigen::Index count, double* cosine, double* sine) const {
    for (Eigen::Index first = 0; first < count; first += length) {
      const double angle = frequency_ * (tau + step_ * static_cast<double>(first));
      const double c = std::cos(angle), s = std::sin(angle);
      const Eigen::Index last = std::min<Eigen::Index>(count - first, length);
      for (Eigen::Index k = 0; k < last; ++k) {
        cosine[first + k] = c * cosine_[k] - s * sine_[k];
        sine[first + k] = s * cosine_[k] + c * sine_[k];
      }
    }
  }

 private:
  static constexpr int length = 32;
  double frequency_, step_, cosine_[length], sine_[length];
};

/// Of the window, which is even: Σ w (cos Ωτ, u sin Ωτ, u² cos Ωτ) with u = τ over half the signal.
struct Moments {
  double plain = 0, odd = 0, square = 0;
};

class Fit {
 public:
  Fit(std::span<const double> samples, double step);

  /// 2π/T.
  double bin() const { return 2 * pi / (step_ * static_cast<double>(count_ - 1)); }
  double middle() const { return step_ * static_cast<double>(count_ - 1) / 2; }
  double residual() const { return std::sqrt((weights_.array() * left_.array().square()).sum()); }
  /// The largest line of what is left, not yet taken away.
  Wave largest();
  /// Takes a wave away from what is left.
  void take(const Wave& wave);
  /// Leaves all but these.
  void leave(const std::vector<Wave>& waves);
  /// Corrects waves until what they leave is least, to changes of `goal`, and takes them away. False where a
  /// step is not finite.
  bool refine(std::vector<Wave>& waves, double goal);

 private:
  /// One Gauss-Newton step for `waves`, which `values` is to be the sum of, with the matrix of the step
  /// before unless `anew`; the largest change, in units of the bin and relative to the largest amplitude.
  double step(std::vector<Wave>& waves, const VectorXd& values, bool anew);
  Moments moments(double frequency) const;
  /// Sums over the samples of products of x = cos ωτ, y = sin ωτ and u (b x − a y) of each wave with those of
  /// each other: by products of angles they are moments of the window, and most of them vanish.
  MatrixXd normal_matrix(const std::vector<Wave>& waves) const;

  Eigen::Index count_;
  double step_;
  VectorXd values_, weights_, left_;
  VectorXd moment_places_, moment_weights_;  ///< u, and w there
  std::vector<std::complex<double>> transformed_;
  std::vector<double> windowed_;
  VectorXd unit_;  ///< of the columns of the matrix
  Eigen::LDLT<MatrixXd> factors_;
  Eigen::FFT<double> fft_;
};

Fit::Fit(std::span<const double> samples, double step)
    : count_(static_cast<Eigen::Index>(samples.size())),
      step_(step),
      values_(Eigen::Map<const VectorXd>(samples.data(), count_)),
      weights_(count_),
      left_(values_),
      windowed_(std::bit_ceil(samples.size())) {
  for (Eigen::Index j = 0; j < count_; ++j)
    weights_[j] = std::pow(1 - std::cos(2 * pi * static_cast<double>(j) / static_cast<double>(count_ - 1)),
                           window_power);
  weights_ /= weights_.sum();
  const Eigen::Index points = std::min(count_ - 1, most_points);
  moment_places_ = VectorXd::LinSpaced(points + 1, -1, 1);
  moment_weights_ = (1 + (pi * moment_places_.array()).cos()).pow(window_power);
  moment_weights_ /= moment_weights_.sum();
}

/// w u^k is smooth, also where it ends, so few points serve. Samples do not tell Ω from Ω + 2π/step.
Moments Fit::moments(double frequency) const {
  const double turns = frequency * step_ / (2 * pi), whole = std::round(turns);
  const double bins = (turns - whole) * static_cast<double>(count_ - 1);
  Moments m;
  if (std::abs(bins) > farthest) return m;
  for (Eigen::Index j = 0; j < moment_places_.size(); ++j) {
    const double u = moment_places_[j], c = moment_weights_[j] * std::cos(pi * bins * u);
    m.plain += c;
    m.odd += moment_weights_[j] * u * std::sin(pi * bins * u);
    m.square += c * u * u;
  }
  const bool reversed = count_ % 2 == 0 && std::remainder(whole, 2) != 0;
  return reversed ? Moments{-m.plain, -m.odd, -m.square} : m;
}

MatrixXd Fit::normal_matrix(const std::vector<Wave>& waves) const {
  const auto count = static_cast<Eigen::Index>(waves.size());
  MatrixXd normal(3 * count, 3 * count);
  for (Eigen::Index k = 0; k < count; ++k)
    for (Eigen::Index l = 0; l <= k; ++l) {
      const auto& [omega, a, b] = waves[static_cast<std::size_t>(k)];
      const auto& [other, c, d] = waves[static_cast<std::size_t>(l)];
      const Moments sum = moments(omega + other), difference = moments(omega - other);
      const double even = (difference.plain + sum.plain) / 2, uneven = (difference.plain - sum.plain) / 2;
      const double xy = (sum.odd - difference.odd) / 2, yx = (sum.odd + difference.odd) / 2;
      normal.block<3, 3>(3 * k, 3 * l) << even, 0, -c * xy,  //
          0, uneven, d * yx,                                 //
          -a * yx, b * xy,
          (b * d * (difference.square + sum.square) + a * c * (difference.square - sum.square)) / 2;
    }
  return MatrixXd(normal.selfadjointView<Eigen::Lower>());
}

Wave Fit::largest() {
  std::fill(windowed_.begin(), windowed_.end(), 0);
  for (Eigen::Index j = 0; j < count_; ++j) windowed_[j] = weights_[j] * left_[j];
  fft_.fwd(transformed_, windowed_);
  std::size_t peak = 0;
  for (std::size_t k = 0; k <= windowed_.size() / 2; ++k)
    if (std::norm(transformed_[k]) > std::norm(transformed_[peak])) peak = k;
  std::vector<Wave> wave{
      {2 * pi * static_cast<double>(peak) / (step_ * static_cast<double>(windowed_.size()))}};
  // A line within a bin of zero is a constant: a period longer than the signal cannot be told.
  for (int k = 0; k < 20; ++k) {
    if (wave[0].frequency < bin()) wave[0].frequency = 0;
    if (step(wave, left_, true) < 1e-9) break;
  }
  return wave[0];
}

double Fit::step(std::vector<Wave>& waves, const VectorXd& values, bool anew) {
  const Eigen::Index columns = 3 * static_cast<Eigen::Index>(waves.size()), most = std::min(chunk, count_);
  MatrixXd cosine(most, columns / 3), sine(most, columns / 3);
  MatrixXd normal = anew ? normal_matrix(waves) : MatrixXd();
  VectorXd right = VectorXd::Zero(columns), left(most), tau(most);
  const double scale = middle();
  std::vector<Turns> turns;
  for (const Wave& wave : waves) turns.emplace_back(wave.frequency, step_);
  for (Eigen::Index from = 0; from < count_; from += chunk) {
    const Eigen::Index n = std::min(chunk, count_ - from);
    const double first = step_ * static_cast<double>(from) - middle();
    left.head(n) = values.segment(from, n);
    for (std::size_t w = 0; w < waves.size(); ++w) {
      const auto k = static_cast<Eigen::Index>(w);
      turns[w].fill(first, n, cosine.col(k).data(), sine.col(k).data());
      left.head(n) -= waves[w].a * cosine.col(k).head(n) + waves[w].b * sine.col(k).head(n);
    }
    left.head(n).array() *= weights_.segment(from, n).array();
    tau.head(n) = VectorXd::LinSpaced(n, first, first + step_ * static_cast<double>(n - 1)) / scale;
    for (std::size_t w = 0; w < waves.size(); ++w) {
      const auto k = static_cast<Eigen::Index>(w);
      const auto& [omega, a, b] = waves[w];
      const auto x = cosine.col(k).head(n), y = sine.col(k).head(n);
      const auto by_frequency = tau.head(n).cwiseProduct(b * x - a * y);
      right[3 * k] += x.dot(left.head(n));
      right[3 * k + 1] += y.dot(left.head(n));
      right[3 * k + 2] += by_frequency.dot(left.head(n));
    }
  }
  // A constant has no sine and no frequency, and a wave without amplitude no frequency yet.
  for (std::size_t w = 0; w < waves.size(); ++w)
    for (Eigen::Index c = 3 * static_cast<Eigen::Index>(w) + 1, k = 0; k < 2; ++k, ++c)
      if (waves[w].frequency == 0 || (k == 1 && waves[w].amplitude() == 0)) {
        right[c] = 0;
        if (!anew) continue;
        normal.row(c).setZero();
        normal.col(c).setZero();
        normal(c, c) = 1;
      }
  // Columns of waves differ by their amplitudes: scaled to unit diagonal, the matrix is near the unit matrix.
  if (anew) {
    unit_ = normal.diagonal().cwiseSqrt().cwiseInverse();
    factors_.compute(unit_.asDiagonal() * normal * unit_.asDiagonal());
  }
  const VectorXd change = unit_.asDiagonal() * factors_.solve(unit_.asDiagonal() * right);
  double largest = 0, amplitude = 0;
  for (std::size_t w = 0; w < waves.size(); ++w) {
    const Eigen::Index c = 3 * static_cast<Eigen::Index>(w);
    waves[w].a += change[c];
    waves[w].b += change[c + 1];
    waves[w].frequency += change[c + 2] / scale;
    amplitude = std::max(amplitude, waves[w].amplitude());
  }
  for (std::size_t w = 0; w < waves.size(); ++w) {
    const Eigen::Index c = 3 * static_cast<Eigen::Index>(w);
    largest = std::max({largest, std::hypot(change[c], change[c + 1]) / amplitude,
                        std::abs(change[c + 2]) / (scale * bin()) * (waves[w].amplitude() / amplitude)});
  }
  return largest;
}

void Fit::take(const Wave& wave) {
  const Turns turns(wave.frequency, step_);
  VectorXd cosine(std::min(chunk, count_)), sine(cosine.size());
  for (Eigen::Index from = 0; from < count_; from += chunk) {
    const Eigen::Index n = std::min(chunk, count_ - from);
    turns.fill(step_ * static_cast<double>(from) - middle(), n, cosine.data(), sine.data());
    left_.segment(from, n) -= wave.a * cosine.head(n) + wave.b * sine.head(n);
  }
}

bool Fit::refine(std::vector<Wave>& waves, double goal) {
  bool converged = false;
  for (int k = 0; k < 10 && !converged; ++k) {
    const double change = step(waves, values_, k % matrix_steps == 0);
    if (!std::isfinite(change)) return false;
    converged = change < goal;
  }
  leave(waves);
  return true;
}

void Fit::leave(const std::vector<Wave>& waves) {
  left_ = values_;
  for (const Wave& wave : waves) take(wave);
}

/// Of frequency −ω: the same with the sine reversed.
SpectralLine spectral_line(const Wave& wave, double middle) {
  const double sign = std::copysign(1.0, wave.frequency);
  const double phase = std::atan2(-sign * wave.b, wave.a) - std::abs(wave.frequency) * middle;
  const double turned = std::remainder(phase, 2 * pi);
  return {std::abs(wave.frequency), wave.amplitude(), turned > -pi ? turned : pi};
}

Spectrum sorted(std::vector<SpectralLine> lines, double residual) {
  std::stable_sort(lines.begin(), lines.end(),
                   [](const SpectralLine& a, const SpectralLine& b) { return a.amplitude > b.amplitude; });
  return {std::move(lines), residual};
}

std::size_t limit(SpectrumGoal goal) { return goal.lines > 0 ? goal.lines : most_spectral_lines; }

void check(std::span<const double> samples, double length, const char* what) {
  if (samples.size() < least_spectral_samples)
    throw std::invalid_argument(fmt::format("{} samples; a spectrum needs at least {}: take more elements",
                                            samples.size(), least_spectral_samples));
  if (!(length > 0)) throw std::invalid_argument(fmt::format("{} = {}; must be positive", what, length));
  for (std::size_t j = 0; j < samples.size(); ++j)
    if (!std::isfinite(samples[j]))
      throw std::invalid_argument(fmt::format("sample {} is not finite", j + 1));
}

}  // namespace

Spectrum line_spectrum(std::span<const double> samples, double step, SpectrumGoal goal) {
  check(samples, step, "step");
  Fit fit(samples, step);
  std::vector<Wave> waves;
  double fitted = 0;  // so many together
  while (waves.size() < limit(goal)) {
    const Wave wave = fit.largest();
    if (!(wave.amplitude() > goal.amplitude)) break;
    double distance = INFINITY;
    for (const Wave& other : waves)
      distance =
          std::min(distance, std::abs(std::abs(wave.frequency) - std::abs(other.frequency)) / fit.bin());
    if (distance < least_distance) break;
    std::vector<Wave> more = waves;
    more.push_back(wave);
    const bool enough_for_now = distance > near && static_cast<double>(more.size()) < growth * fitted;
    const double before = fit.residual();
    if (enough_for_now) {
      fit.take(wave);
    } else if (fit.refine(more, good_enough) && fit.residual() < before) {
      fitted = static_cast<double>(more.size());
    } else {
      fit.leave(waves);
      break;
    }
    waves = std::move(more);
  }
  if (!waves.empty()) fit.refine(waves, roundoff);
  std::vector<SpectralLine> lines;
  for (const Wave& wave : waves) lines.push_back(spectral_line(wave, fit.middle()));
  return sorted(std::move(lines), fit.residual());
}

Spectrum fourier_spectrum(std::span<const double> samples, double period, SpectrumGoal goal) {
  check(samples, period, "period");
  std::vector<std::complex<double>> signal(samples.begin(), samples.end()), coefficients;
  Eigen::FFT<double>().fwd(coefficients, signal);
  const std::size_t n = samples.size();
  std::vector<SpectralLine> lines;
  for (std::size_t k = 0; k <= n / 2; ++k) {
    const std::complex<double> c = coefficients[k] / static_cast<double>(n);
    const double amplitude = (k == 0 || 2 * k == n ? 1 : 2) * std::abs(c);
    lines.push_back({2 * pi * static_cast<double>(k) / period, amplitude, std::arg(c)});
  }
  Spectrum result = sorted(std::move(lines), 0);
  const auto enough = [&](std::size_t k) {
    return k == limit(goal) || !(result.lines[k].amplitude > goal.amplitude);
  };
  std::size_t kept = 0;
  while (kept < result.lines.size() && !enough(kept)) ++kept;
  for (std::size_t k = kept; k < result.lines.size(); ++k) {
    const double a = result.lines[k].amplitude;
    result.residual += result.lines[k].frequency > 0 ? a * a / 2 : a * a;
  }
  result.residual = std::sqrt(result.residual);
  result.lines.resize(kept);
  return result;
}

}  // namespace extremal
