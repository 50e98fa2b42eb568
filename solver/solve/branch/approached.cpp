#include "solve/branch/approached.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "machine/largest.hpp"
#include "problem/point_range.hpp"
#include "problem/rest_point.hpp"
#include "solve/branch/limits.hpp"

namespace extremal {

namespace {

double length_of(const Path& path, int k) { return path.mesh()[k + 1] - path.mesh()[k]; }

/// Of the chords over the elements, n each.
std::vector<double> velocities(const Path& path) {
  std::vector<double> v;
  for (int k = 0; k < path.elements(); ++k)
    for (int a = 0; a < path.coordinates(); ++a)
      v.push_back((path.node(k + 1)[a] - path.node(k)[a]) / (length_of(path, k) * path.duration()));
  return v;
}

std::vector<double> speeds(const Path& path) {
  const std::vector<double> v = velocities(path);
  const std::size_t n = path.coordinates();
  std::vector<double> result;
  for (std::size_t k = 0; k < v.size(); k += n) {
    double square = 0;
    for (std::size_t a = k; a < k + n; ++a) square += v[a] * v[a];
    result.push_back(std::sqrt(square));
  }
  return result;
}

}  // namespace

double grading(const Path& path) {
  double shortest = 1, longest = 0;
  for (int k = 0; k < path.elements(); ++k) {
    shortest = std::min(shortest, length_of(path, k));
    longest = std::max(longest, length_of(path, k));
  }
  return longest / shortest;
}

double share_at_rest(const Path& path) {
  const std::vector<double> speed = speeds(path);
  const double fastest = largest(speed);
  double share = 0;
  for (int k = 0; k < path.elements(); ++k)
    if (speed[k] < limits::approached::slow * fastest) share += length_of(path, k);
  return share;
}

bool passes_saddle(const Problem& problem, const Path& path, double rate) {
  using namespace limits::approached;
  const std::vector<double> speed = speeds(path);
  const auto slowest = std::ranges::min_element(speed) - speed.begin();
  const auto n = static_cast<std::size_t>(path.coordinates());
  try {
    const RestPoint rest = rest_point(*problem.lagrangian, {path.node(static_cast<int>(slowest)), n}, 0);
    if (rest.distance > beside_rest * largest_range(path.nodes(), n)) return false;
    const Eigen::VectorXcd exponents = exponents_of_motion(*problem.lagrangian, rest.q, problem.paired);
    return !exponents.allFinite() ||
           (exponents.real().minCoeff() < 0 && fastest_approach * exponents.real().maxCoeff() >= rate);
  } catch (const std::invalid_argument&) {
    return true;
  }
}

bool near_singularity(const Problem& problem, const Path& path) {
  using namespace limits::approached;
  if (grading(path) < singular_grading) return false;
  const std::vector<double> v = velocities(path);
  const auto n = static_cast<std::size_t>(path.coordinates());
  Scratch scratch;
  const auto at = [&](int k, Order order) {
    return evaluate_at(*problem.lagrangian, {path.node(k), n}, {v.data() + k * n, n},
                       path.mesh()[k] * path.duration(), order, scratch);
  };
  int strongest = 0;
  double most = 0;
  for (int k = 0; k < path.elements(); ++k)
    if (const double force = largest(at(k, Order::gradient).dq); force > most) {
      most = force;
      strongest = k;
    }
  return most < singular_length * largest_range(path.nodes(), n) * largest(at(strongest, Order::hessian).qq);
}

}  // namespace extremal
