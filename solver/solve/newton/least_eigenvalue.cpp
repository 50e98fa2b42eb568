#include "solve/newton/least_eigenvalue.hpp"

#include <cmath>
#include <random>
#include <vector>

namespace extremal {

std::optional<double> least_eigenvalue(NewtonIteration& newton, const Path& path) {
  Step direction;
  return least_eigenvalue(newton, path, direction);
}

std::optional<double> least_eigenvalue(NewtonIteration& newton, const Path& path, Step& direction,
                                       unsigned draw) {
  SecondVariationModel* const model = newton.second_variation();
  if (!model || newton.action().tables().unknowns() > most_dense_unknowns || path.elements() < 2)
    return std::nullopt;
  const Chain& chain = newton.action().nodes.chain;
  const std::size_t n = chain.size(), blocks = chain.blocks();
  std::vector<double> load((blocks + 2) * n, 0);
  std::minstd_rand random(draw);
  std::uniform_real_distribution<double> component(-1, 1);
  const auto diagonal = [&](std::size_t i) {
    return std::abs(chain.diagonal(static_cast<int>(i / n) - 1)[i % n * (n + 1)]);
  };
  for (std::size_t i = n; i < load.size() - n; ++i) load[i] = diagonal(i) * component(random);
  ClosingEquation closed;
  const ClosingEquation* const closing = newton.closing(path);
  if (closing) closed = *closing;
  closed.value = 0;
  model->respond(newton.action(), closing ? &closed : nullptr, load, direction);
  double product = 0, square = 0;
  for (std::size_t i = n; i < load.size() - n; ++i) {
    product += load[i] * direction.nodes[i];
    square += diagonal(i) * direction.nodes[i] * direction.nodes[i];
  }
  const double eigenvalue = product / square;
  return std::isfinite(eigenvalue) ? std::optional(eigenvalue) : std::nullopt;
}

}  // namespace extremal
