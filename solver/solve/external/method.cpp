#include "solve/external/method.hpp"

namespace extremal {

const char* name(Method method) {
  switch (method) {
    case Method::ceres:
      return "ceres";
    case Method::ipopt:
      return "ipopt";
    default:
      return "newton";
  }
}

const char* description(Method method) {
  switch (method) {
    case Method::ceres:
      return "least squares";
    case Method::ipopt:
      return "an interior point method";
    default:
      return "Newton's method";
  }
}

bool available([[maybe_unused]] Method method) {
#ifndef EXTREMAL_CERES
  if (method == Method::ceres) return false;
#endif
#ifndef EXTREMAL_IPOPT
  if (method == Method::ipopt) return false;
#endif
  return true;
}

}  // namespace extremal
