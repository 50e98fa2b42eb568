#include <cmath>
#include <stdexcept>

#include "solve/external/curve_fit.hpp"

namespace extremal {

const char* name(Loss loss) {
  switch (loss) {
    case Loss::huber:
      return "huber";
    case Loss::cauchy:
      return "cauchy";
    default:
      return "squared";
  }
}

std::optional<Loss> find_loss(std::string_view wanted) {
  for (const Loss loss : {Loss::squared, Loss::huber, Loss::cauchy})
    if (wanted == name(loss)) return loss;
  return std::nullopt;
}

LossValue evaluate(Loss loss, double s) {
  switch (loss) {
    case Loss::huber:
      return s <= 1 ? LossValue{s, 1} : LossValue{2 * std::sqrt(s) - 1, 1 / std::sqrt(s)};
    case Loss::cauchy:
      return {std::log1p(s), 1 / (1 + s)};
    default:
      return {s, 1};
  }
}

#ifdef EXTREMAL_CERES
bool can_fit() { return true; }
#else
bool can_fit() { return false; }

CurveFitReport minimise(const CurveFit&, std::vector<double>&, const Deadline&) {
  throw std::invalid_argument("this build has no Ceres, which fits need");
}
#endif

}  // namespace extremal
