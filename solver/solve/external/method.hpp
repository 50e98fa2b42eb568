#pragma once

/// \file Methods that take a guess nearer to an extremal before Newton's method refines it.

namespace extremal {

enum class Method {
  newton,  ///< Newton's method alone
  ceres,   ///< least squares of δS_h by Levenberg and Marquardt's method (Ceres Solver)
  ipopt,   ///< δS_h = 0 as constraints of an interior point method with a filter line search (Ipopt)
};

/// Its name, "newton", "ceres" or "ipopt".
const char* name(Method method);
/// In a few words.
const char* description(Method method);
/// Whether this build has it.
bool available(Method method);

}  // namespace extremal
