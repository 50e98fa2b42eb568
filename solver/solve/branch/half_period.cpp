#include "solve/branch/half_period.hpp"

#include <vector>

namespace extremal {

namespace {

std::optional<ClosingMap> half_of(const ProblemFamily& family, double varied) {
  if (family.half) return family.half(varied);
  if (!family.problem.periodic || !closing_map(family.problem).identity()) return std::nullopt;
  return closing_map(family.problem);
}

}  // namespace

std::optional<double> alternation(const ProblemFamily& family, double varied, const Trajectory& a,
                                  const Trajectory& b) {
  constexpr int samples = 128;
  const std::optional<ClosingMap> half = half_of(family, varied);
  if (!half) return std::nullopt;
  const std::size_t n = a.coordinates;
  Eigen::VectorXd q(n), later(n), of_a(n);
  std::vector<double> v(n);
  double sum = 0;
  for (int k = 0; k < samples; ++k) {
    for (const Trajectory* path : {&a, &b}) {
      const double t = path->duration() * k / (2 * samples);
      path->at(t, {q.data(), n}, v);
      path->at(t + path->duration() / 2, {later.data(), n}, v);
      q = later - (half->r * q + half->c);
      if (path == &a) of_a = q;
    }
    sum += q.dot(of_a) / samples;
  }
  return sum;
}

bool has_half_period(const ProblemFamily& family, double varied, const Trajectory& path, double distance) {
  const std::optional<double> square = alternation(family, varied, path, path);
  return square && *square <= distance * distance;
}

}  // namespace extremal
