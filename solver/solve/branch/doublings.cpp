#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>

#include "analysis/symplectic.hpp"
#include "problem/closing.hpp"
#include "solve/branch/branch_point.hpp"
#include "solve/branch/root.hpp"
#include "solve/periodic/orbit_index.hpp"
#include "solve/periodic/stability.hpp"

/// \file Points of a step where orbits of twice the period begin.

namespace extremal {

namespace {

double product(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 1.0, std::multiplies());
}

/// All tests at points of a step, by how far along the tangent.
using DoublingSamples = std::map<double, DoublingTests>;

/// How many tests of a step are followed: one, the product of all, where pairs of multipliers have met or
/// parted.
std::size_t test_count(const BranchStep& step) {
  const std::size_t count = step.from.doubling.values.size();
  return count == step.to.doubling.values.size() ? count : 1;
}

/// Test k of so many.
double test_of(const DoublingTests& tests, std::size_t k, std::size_t count) {
  if (tests.values.size() == count) return tests.values[k];
  return count == 1 ? product(tests.values) : NAN;
}

/// Whether by the index more pairs of multipliers pass −1 between two points than tests change their signs.
bool hides_doublings(const DoublingTests& a, const DoublingTests& b, std::size_t count) {
  if (!a.index || !b.index) return false;
  int seen = 0;
  for (std::size_t k = 0; k < count; ++k) seen += changes_sign(test_of(a, k, count), test_of(b, k, count));
  return std::abs(*a.index - *b.index) >= seen + 2;
}

/// Test k before and on a step, and at points of it.
std::vector<Sample> tests_on(const BranchStep& step, std::size_t k, const DoublingSamples& between) {
  const std::size_t count = test_count(step);
  const auto test = [&](const auto& state) { return test_of(state.doubling, k, count); };
  std::vector<Sample> samples = samples_on(step, test, test(step.to));
  for (const auto& [at, tests] : between)
    if (const double value = test_of(tests, k, count); std::isfinite(value))
      samples.insert(samples.end() - 1, {at, value});
  return samples;
}

/// Points of a step between which the signs of the tests explain how the index changes, as far as points
/// tell; its ends as well.
DoublingSamples divided_by_index(Tracker& tracker, const BranchStep& step) {
  const std::size_t count = test_count(step);
  DoublingSamples all = {{0, step.from.doubling}, {step.length, step.to.doubling}};
  while (all.size() < most_samples) {
    const auto hides = [&](const auto& a, const auto& b) {
      return hides_doublings(a.second, b.second, count);
    };
    const auto low = std::ranges::adjacent_find(all, hides);
    if (low == all.end()) break;
    const double at = 0.5 * (low->first + std::next(low)->first);
    if (!tracker.reach(step.from, at)) break;
    all[at] = read_doubling_tests(tracker);
  }
  return all;
}

/// Where two multipliers pass −1 and each other between two points, so that no test changes its sign: there
/// the index changes by two, and the root of the product of all tests, of the sign that the index tells,
/// passes zero: down to the roundoff of the product, and from there the index alone tells the place. NaN if
/// it is not found.
double find_passing_pair(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
                         const DoublingSamples::value_type& low, const DoublingSamples::value_type& high) {
  const double middle = 0.5 * (*low.second.index + *high.second.index);
  const auto test = [&](const DoublingTests& tests) {
    if (!tests.index) return double(NAN);
    return std::copysign(std::sqrt(std::abs(product(tests.values)) + sum_accuracy), *tests.index - middle);
  };
  return root(
      tracker, from, {low.first, test(low.second)}, {high.first, test(high.second)}, std::nullopt,
      [&] { return test(read_doubling_tests(tracker)); },
      [&](double, double change) { return is_located(tracker, family, change); });
}

}  // namespace

DoublingTests read_doubling_tests(Tracker& tracker) {
  const Problem& problem = tracker.branch().problem();
  const Trajectory trajectory = trajectory_of(tracker.state.path);
  SecondVariation& variation = tracker.workspace().variation;
  const ClosingMap closed = closing_map(problem);
  if (!variation.assemble(problem.lagrangian, trajectory, tracker.condensed(), &closed,
                          problem.paired ? Definite::paired : Definite::positive))
    return {{NAN}};
  const std::optional<Floquet> found =
      multipliers_of(problem, variation, closed_orbit(problem, trajectory, 0));
  return {found ? doubling_tests(*found) : std::vector<double>{NAN}, doubling_index(problem, variation)};
}

bool may_double(const BranchStep& step) {
  const std::size_t count = test_count(step);
  if (hides_doublings(step.from.doubling, step.to.doubling, count)) return true;
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<Sample> samples = tests_on(step, k, {});
    if (changes_sign(samples.end()[-2].value, samples.back().value) || may_dip(samples)) return true;
  }
  return false;
}

/// Test by test, in their order; all together where pairs of multipliers have met or parted. Where the index
/// does not tell, samples look for two zeros of a test; where it changes without any zero, two multipliers
/// pass −1 at once.
std::vector<Event> find_doublings(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const auto& from = step.from;
  const std::size_t count = test_count(step);
  std::vector<Event> found;
  const auto add = [&](double at, int passing) {
    BranchPoint point = read_point(tracker, PointKind::period_doubling);
    found.push_back(
        {at,
         {std::move(point), branch_start(tracker, search, PointKind::period_doubling, from, at, passing)}});
  };
  const DoublingSamples divided = divided_by_index(tracker, step);
  DoublingSamples between(std::next(divided.begin()), std::prev(divided.end()));
  const bool by_index = !between.empty();
  for (std::size_t k = 0; k < count; ++k) {
    const auto test = [&] { return test_of(read_doubling_tests(tracker), k, count); };
    std::vector<Sample> samples = tests_on(step, k, by_index ? between : DoublingSamples{});
    if (!by_index)
      resolve(samples, [&](double at) {
        if (const auto known = between.find(at); known != between.end())
          return test_of(known->second, k, count);
        if (between.size() == most_samples || !tracker.reach(from, at)) return double(NAN);
        return test_of(between[at] = read_doubling_tests(tracker), k, count);
      });
    find_roots(tracker, search.family, from, samples, std::nullopt, test, [&](double at) { add(at, 1); });
  }
  for (auto low = divided.begin(), high = std::next(low); high != divided.end(); ++low, ++high)
    if (hides_doublings(low->second, high->second, count))
      if (const double at = find_passing_pair(tracker, search.family, from, *low, *high); std::isfinite(at))
        add(at, 2);
  return found;
}

}  // namespace extremal
