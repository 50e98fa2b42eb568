#pragma once

#include <algorithm>
#include <complex>
#include <vector>

/// \file The stability of a periodic orbit as data.

namespace extremal {

/// Eigenvalues of the linearised flow over [0, T] of a periodic orbit, after R⁻¹ where q(T) = R q(0) + c,
/// with (q, p) as variables. They come as λ, 1/λ: on the unit circle, real, or four together λ, 1/λ and
/// conjugates.
///
/// Every continuous symmetry, as the shift in time, makes λ = 1 (or −1, where R reverses it) a double
/// eigenvalue with one eigenvector. An error δ of the matrix moves such an eigenvalue by √δ, but μ = λ + 1/λ
/// by δ only. Where μ cannot be told from ±2 the pair is given as exactly ±1, and counts as trivial: pairs
/// nearer to ±1 than √δ are not resolved. The pair of the shift in time is known, and given as 1.
///
/// With forces the flow is not symplectic, and the eigenvalues do not come in pairs; those of an orbit that
/// can be shifted in time have one 1 among them.
struct Floquet {
  bool paired = true;                             ///< as they are without forces
  std::vector<std::complex<double>> multipliers;  ///< 2n, largest modulus first, then by |argument|, + first
  /// Beside them: sign of i vᴴJv of the eigenvector v = (q, p), J = (0 I; −I 0), for multipliers on the unit
  /// circle; 0 off it and for trivial ones.
  std::vector<int> krein;
  /// Beside them: eigenvectors (q, p) at t = 0, 2n, of length one; for a double one with one eigenvector
  /// twice that. Left out along branches, and where the second variation between fixed ends is singular.
  std::vector<std::vector<std::complex<double>>> vectors;
  double symplectic_defect = 0;  ///< largest |λ·λ' − 1| of pairs that are not trivial
  int trivial_pairs = 0, circle_pairs = 0, real_pairs = 0, quadruples = 0;

  /// Those outside of the unit circle, of multipliers that do not come in pairs: by more than their errors.
  int outside() const {
    constexpr double error = 1e-8;
    const auto far = [](const auto& x) { return std::abs(x) > 1 + error; };
    return static_cast<int>(std::ranges::count_if(multipliers, far));
  }
  /// None outside of the unit circle.
  bool stable() const { return paired ? real_pairs == 0 && quadruples == 0 : outside() == 0; }
};

}  // namespace extremal
