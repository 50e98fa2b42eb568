#include "study/quantity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace extremal {

namespace {

constexpr int amplitude_samples = 16;  ///< of each element, to which its extremes are told
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Of each point, that of one coordinate: the one that has the largest on the branch.
struct Amplitudes {
  std::size_t coordinate = 0;
  std::vector<double> values;
};

Amplitudes largest_amplitudes(const FollowedBranch& branch) {
  std::vector<std::vector<double>> all;
  for (const BranchPoint& point : branch.points) all.push_back(amplitudes(point.solution.trajectory));
  Amplitudes largest;
  double most = -1;
  for (const std::vector<double>& each : all) {
    const auto widest = std::max_element(each.begin(), each.end());
    if (*widest <= most) continue;
    most = *widest;
    largest.coordinate = static_cast<std::size_t>(widest - each.begin());
  }
  for (const std::vector<double>& each : all) largest.values.push_back(each[largest.coordinate]);
  return largest;
}

EndQuantity read(const Study& study, const std::string& formula) {
  return end_quantity(formula, study.system,
                      {{"duration", 0}, {"energy", 0}, {"action", 0}, {"amplitude", 0}}, "quantity");
}

BranchQuantity of_formula(const Study& study, const FollowedBranch& branch, const std::string& formula,
                          const Amplitudes& amplitudes) {
  const EndQuantity value = read(study, formula);
  BranchQuantity quantity{formula, {}};
  std::array<std::vector<double>, 4> ends;
  for (std::vector<double>& each : ends) each.resize(branch.names.size());
  for (std::size_t k = 0; k < branch.points.size(); ++k) {
    const Solution& solution = branch.points[k].solution;
    solution.trajectory.at(0, ends[0], ends[1]);
    solution.trajectory.at(solution.duration(), ends[2], ends[3]);
    std::map<std::string, double> numbers{{"duration", solution.duration()},
                                          {"energy", solution.energy.value_or(unknown)},
                                          {"action", solution.action},
                                          {"amplitude", amplitudes.values[k]}};
    std::erase_if(numbers, [&](const auto& each) { return study.system.parameters.contains(each.first); });
    numbers[branch.parameter] = branch.points[k].parameter;
    quantity.values.push_back(value({ends[0], ends[1], ends[2], ends[3]}, numbers));
  }
  return quantity;
}

}  // namespace

std::vector<double> amplitudes(const Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates;
  std::vector<double> q(n), v(n), low(n, std::numeric_limits<double>::infinity()), high(n, -low[0]);
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int j = 0; j <= amplitude_samples; ++j) {
      trajectory.in_element(k, static_cast<double>(j) / amplitude_samples, q, v);
      for (std::size_t a = 0; a < n; ++a) {
        low[a] = std::min(low[a], q[a]);
        high[a] = std::max(high[a], q[a]);
      }
    }
  for (std::size_t a = 0; a < n; ++a) high[a] = (high[a] - low[a]) / 2;
  return high;
}

void check_quantity(const Study& study, const std::string& formula) { read(study, formula); }

BranchQuantity quantity(const Study& study, const FollowedBranch& branch, const std::string& formula) {
  const Amplitudes amplitudes = largest_amplitudes(branch);
  if (!formula.empty()) return of_formula(study, branch, formula, amplitudes);
  if (branch.parameter == "energy") return of_formula(study, branch, "duration", amplitudes);
  if (branch.parameter == "duration") return of_formula(study, branch, "energy", amplitudes);
  return {"amplitude of " + branch.names[amplitudes.coordinate], amplitudes.values};
}

}  // namespace extremal
