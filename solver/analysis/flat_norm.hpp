#pragma once

#include <complex>
#include <vector>

/// \file The flat norm of measures of points on the line (Müller-Ortiz, Definition 3.1).

namespace extremal {

/// weight · δ(at).
struct PointMass {
  double at = 0;
  std::complex<double> weight;
};

/// sup |Σ weight f(at)| over real f with |f| ≤ 1 and |f(x) − f(y)| ≤ |x − y|: (3.1) for signed measures, and
/// a norm of complex ones. ‖δ_a‖ = 1, ‖δ_a − δ_b‖ = min(|a − b|, 2). Exact but for roundoff, in O(n²) for
/// each corner of the set of values; a signed measure has one. Throws std::invalid_argument for what is not
/// finite.
double flat_norm(std::vector<PointMass> measure);

}  // namespace extremal
