#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "machine/deadline.hpp"

/// \file Nonlinear least squares with few unknowns, by Ceres.

namespace extremal {

/// ρ(s) of Ceres: s; s up to 1 and then 2√s − 1; log(1 + s).
enum class Loss { squared, huber, cauchy };

/// "squared", "huber", "cauchy".
const char* name(Loss loss);
std::optional<Loss> find_loss(std::string_view name);

/// ρ(s) and ρ'(s).
struct LossValue {
  double value, slope;
};
LossValue evaluate(Loss loss, double s);

/// Minimise ½ Σ ρ(r_i(x)²).
struct CurveFit {
  int residuals = 0;
  Loss loss = Loss::squared;
  /// r(x) and, unless `jacobian` is empty, ∂r/∂x by rows. False where they do not exist.
  std::function<bool(std::span<const double> x, std::span<double> r, std::span<double> jacobian)> evaluate;
  /// Called after each iteration with ½ Σ ρ; false ends them. May be empty.
  std::function<bool(int iteration, double cost)> count = {};
  /// The first trust region: JᵀJ + diag(JᵀJ)/radius gives the first step.
  double radius = 1e4;
};

struct CurveFitReport {
  bool converged = false;
  std::string failure;  ///< why not
  int iterations = 0;
};

/// Whether this build has Ceres.
bool can_fit();

/// Takes x to a minimum near it, by the method of Levenberg and Marquardt. Throws std::invalid_argument where
/// this build lacks Ceres.
CurveFitReport minimise(const CurveFit& fit, std::vector<double>& x, const Deadline& deadline);

}  // namespace extremal
