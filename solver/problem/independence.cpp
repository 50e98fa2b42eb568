#include "problem/independence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace extremal {

namespace {

/// y −= factor · x over the entries of x.
void subtract_multiple(std::vector<double>& y, double factor, const std::vector<double>& x) {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] -= factor * x[i];
}

}  // namespace

double length(const std::vector<double>& x) {
  double largest = 0, sum = 0;
  for (const double a : x) largest = std::max(largest, std::abs(a));
  if (largest == 0) return 0;
  for (const double a : x) sum += (a / largest) * (a / largest);
  return largest * std::sqrt(sum);
}

Independence::Independence(const std::vector<Row>& rows, double threshold) : threshold_(threshold) {
  for (const Row& row : rows)
    for (const auto& entry : row.entries) columns_.push_back(entry.first);
  std::sort(columns_.begin(), columns_.end());
  columns_.erase(std::unique(columns_.begin(), columns_.end()), columns_.end());
}

std::optional<std::vector<double>> Independence::add(const Row& row) {
  std::vector<double> rest(columns_.size(), 0.0), combination(basis_.size() + 1, 0.0);
  for (const auto& [e, coefficient] : row.entries)
    rest[std::lower_bound(columns_.begin(), columns_.end(), e) - columns_.begin()] = coefficient;
  const double before = length(rest);
  for (int pass = 0; pass < 2; ++pass)
    for (const Direction& known : basis_) {
      const double along = std::inner_product(rest.begin(), rest.end(), known.entries.begin(), 0.0);
      subtract_multiple(rest, along, known.entries);
      subtract_multiple(combination, along, known.combination);
    }
  const double left = length(rest);
  if (left <= threshold_ * before) {
    combination.pop_back();
    for (double& a : combination) a = -a;
    return combination;
  }
  combination.back() = 1;
  for (double& x : rest) x /= left;
  for (double& a : combination) a /= left;
  basis_.push_back({std::move(rest), std::move(combination)});
  return std::nullopt;
}

}  // namespace extremal
