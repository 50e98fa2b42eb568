#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "scene/source.hpp"
#include "study/study.hpp"

namespace bench {

/// The solution of the scene of this text, with medians of the seconds of as many runs as take about 0.3 s.
/// Throws std::runtime_error where it does not converge.
inline extremal::Solution repeated_solve(const std::string& text) {
  using namespace extremal;
  const Study study = load(std::make_shared<const Source>(Source{"scene", text}), {}, Purpose::solution);
  const Solution warm = run(study);
  if (!warm.converged()) throw std::runtime_error(warm.message);
  return run(study, static_cast<int>(0.3 / (warm.seconds_solve + warm.seconds_analyse)) + 3);
}

}  // namespace bench
