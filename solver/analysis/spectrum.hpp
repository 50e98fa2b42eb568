#pragma once

#include <span>
#include <vector>

/// \file Lines of a signal: frequencies, amplitudes and phases.

namespace extremal {

/// A cos(ω t + φ), where t = 0 is the first sample.
struct SpectralLine {
  double frequency = 0;  ///< ω ≥ 0, in radians per unit of time
  double amplitude = 0;  ///< A ≥ 0
  double phase = 0;      ///< φ in (−π, π]
};

struct Spectrum {
  std::vector<SpectralLine> lines;  ///< by falling amplitude
  double residual = 0;              ///< root mean square, in the window, of what the lines leave
};

/// When enough lines are found.
struct SpectrumGoal {
  int lines = 0;         ///< so many; 0: as many as the amplitude below asks for, at most `most_lines`
  double amplitude = 0;  ///< lines with less are left out, in units of the signal
};

inline constexpr int most_spectral_lines = 32;
inline constexpr std::size_t least_spectral_samples = 16;

/// Of samples that are `step` apart, the last included. The largest line of what is left is added until the
/// goal is met; all are then fitted together by least squares in a window that vanishes at both ends with
/// five derivatives. Lines closer than one and a half of 2π/duration are taken for one. Throws
/// std::invalid_argument for fewer than 16 samples, a step that is not positive, or a sample that is not
/// finite.
Spectrum line_spectrum(std::span<const double> samples, double step, SpectrumGoal goal);

/// Of one period of a motion that repeats, the sample at its end left out: the lines are multiples of
/// 2π/period.
Spectrum fourier_spectrum(std::span<const double> samples, double period, SpectrumGoal goal);

}  // namespace extremal
