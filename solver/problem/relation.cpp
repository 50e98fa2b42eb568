#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "machine/roundoff.hpp"
#include "problem/independence.hpp"
#include "problem/limits.hpp"
#include "problem/problem.hpp"

/// \file Solves B0 q(0) + B1 q(T) = c. Rows with one end coordinate are taken first, in O(1) each. What then
/// remains falls into groups of rows that share no coordinate, and each group is solved densely.

namespace extremal {

namespace {

/// Values of dependent conditions that differ by more than this, relative to themselves, contradict each
/// other.
constexpr double consistency = 1e-10;

/// a − b, exactly zero where only the rounding of the two is left.
double subtract(double a, double b) {
  const double difference = a - b;
  const bool noise = std::abs(difference) <= 4 * machine_epsilon * std::abs(a);
  return noise ? 0 : difference;
}

/// Whether two values that ought to be equal are not.
bool differ(double a, double b) { return std::abs(a - b) > consistency * std::max(std::abs(a), std::abs(b)); }

double largest(const Row& row) {
  double found = 0;
  for (const auto& entry : row.entries) found = std::max(found, std::abs(entry.second));
  return found;
}

/// A sum and the sum of the magnitudes of its terms.
struct Sum {
  double value = 0, magnitude = 0;
  void add(double x) {
    value += x;
    magnitude += std::abs(x);
  }
};

void check_shape(const BoundaryRelation& relation) {
  const int ends = 2 * relation.coordinates;
  if (relation.coordinates < 1)
    throw std::invalid_argument(fmt::format("coordinates = {}; need at least 1", relation.coordinates));
  if (relation.rows < 0 || relation.value.size() != static_cast<std::size_t>(relation.rows))
    throw std::invalid_argument(
        fmt::format("boundary rows = {} with {} values", relation.rows, relation.value.size()));
  for (const Triplet& entry : relation.matrix) {
    if (entry.row < 0 || entry.row >= relation.rows || entry.column < 0 || entry.column >= ends)
      throw std::invalid_argument(fmt::format("boundary entry ({}, {}) outside {} rows of {} end coordinates",
                                              entry.row, entry.column, relation.rows, ends));
    if (!std::isfinite(entry.value))
      throw std::invalid_argument(
          fmt::format("boundary condition {} has a coefficient {}", entry.row, entry.value));
  }
  for (int row = 0; row < relation.rows; ++row)
    if (!std::isfinite(relation.value[row]))
      throw std::invalid_argument(
          fmt::format("boundary condition {} has the value {}", row, relation.value[row]));
}

/// The rows with repeated entries summed.
std::vector<Row> collect_rows(const BoundaryRelation& relation) {
  std::vector<Row> rows(relation.rows);
  for (int i = 0; i < relation.rows; ++i) rows[i] = {i, {}, relation.value[i]};
  for (const Triplet& entry : relation.matrix)
    rows[entry.row].entries.emplace_back(entry.column, entry.value);
  for (Row& row : rows) {
    auto& entries = row.entries;
    std::sort(entries.begin(), entries.end());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < entries.size();) {
      std::pair<int, double> sum = entries[i];
      for (++i; i < entries.size() && entries[i].first == sum.first; ++i)
        sum.second = subtract(sum.second, -entries[i].second);
      if (sum.second != 0) entries[kept++] = sum;
    }
    entries.resize(kept);
  }
  return rows;
}

/// A group of rows without fixed coordinates, as a dense matrix with c in its last column.
struct Group {
  std::vector<int> columns;  ///< end coordinates, descending: of equal pivots that of q(T) is taken
  std::vector<std::vector<double>> matrix;
};

Group make_group(const std::vector<Row>& rows) {
  Group group;
  for (const Row& row : rows)
    for (const auto& [e, coefficient] : row.entries) group.columns.push_back(e);
  std::sort(group.columns.begin(), group.columns.end(), std::greater<>());
  group.columns.erase(std::unique(group.columns.begin(), group.columns.end()), group.columns.end());
  for (const Row& row : rows) {
    std::vector<double> dense(group.columns.size() + 1, 0.0);
    const double size = largest(row);
    for (const auto& [e, coefficient] : row.entries)
      dense[std::lower_bound(group.columns.begin(), group.columns.end(), e, std::greater<>()) -
            group.columns.begin()] = coefficient / size;
    dense.back() = row.value / size;
    group.matrix.push_back(std::move(dense));
  }
  return group;
}

/// Gauss-Jordan with complete pivoting; returns the pivot column of each row. Rows are independent.
std::vector<std::size_t> eliminate(Group& group) {
  auto& matrix = group.matrix;
  std::vector<std::size_t> pivots;
  for (std::size_t step = 0; step < matrix.size(); ++step) {
    std::size_t row = step, column = 0;
    for (std::size_t i = step; i < matrix.size(); ++i)
      for (std::size_t j = 0; j < group.columns.size(); ++j)
        if (std::abs(matrix[i][j]) > std::abs(matrix[row][column])) row = i, column = j;
    std::swap(matrix[step], matrix[row]);
    pivots.push_back(column);
    const double pivot = matrix[step][column];
    for (double& x : matrix[step]) x /= pivot;
    for (std::size_t i = 0; i < matrix.size(); ++i) {
      const double factor = matrix[i][column];
      if (i == step || factor == 0) continue;
      for (std::size_t j = 0; j < matrix[i].size(); ++j)
        matrix[i][j] = subtract(matrix[i][j], factor * matrix[step][j]);
      matrix[i][column] = 0;
    }
  }
  return pivots;
}

/// The relation while it is being solved.
class Elimination {
 public:
  explicit Elimination(const BoundaryRelation& relation)
      : rows_(collect_rows(relation)),
        dependent_(2 * relation.coordinates),
        pin_(2 * relation.coordinates, -1) {
    map_.offset.assign(2 * relation.coordinates, 0.0);
    map_.fixed.assign(2 * relation.coordinates, 0);
  }

  EndMap solve() {
    for (const Row& row : rows_)
      if (row.entries.size() == 1) pin(row);
    for (const std::vector<int>& group : groups()) solve_group(group);
    number_free();
    return std::move(map_);
  }

 private:
  void pin(const Row& row) {
    const auto [e, coefficient] = row.entries.front();
    const double x = row.value / coefficient;
    if (pin_[e] >= 0) throw RelationError(row.index, differ(x, map_.offset[e]));
    pin_[e] = row.index;
    map_.fixed[e] = 1;
    map_.offset[e] = x;
  }

  /// The row without the coordinates that single rows fix.
  Row reduced(const Row& row) const {
    Row rest{row.index, {}, row.value};
    for (const auto& [e, coefficient] : row.entries)
      if (pin_[e] < 0)
        rest.entries.emplace_back(e, coefficient);
      else
        rest.value = subtract(rest.value, coefficient * map_.offset[e]);
    return rest;
  }

  /// Rows that are not single, gathered where they share a coordinate that is not fixed.
  std::vector<std::vector<int>> groups() const {
    std::vector<int> parent(pin_.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&parent](int e) {
      while (parent[e] != e) e = parent[e] = parent[parent[e]];
      return e;
    };
    std::vector<int> first(rows_.size(), -1);
    for (const Row& row : rows_)
      for (const auto& entry : row.entries) {
        if (row.entries.size() == 1 || pin_[entry.first] >= 0) continue;
        if (first[row.index] < 0) first[row.index] = entry.first;
        parent[root(entry.first)] = root(first[row.index]);
      }
    std::vector<std::vector<int>> found;
    std::vector<int> group_of(pin_.size(), -1);
    for (const Row& row : rows_) {
      if (row.entries.size() == 1) continue;
      if (first[row.index] < 0) {
        found.push_back({row.index});
        continue;
      }
      int& group = group_of[root(first[row.index])];
      if (group < 0) group = static_cast<int>(found.size()), found.emplace_back();
      found[group].push_back(row.index);
    }
    return found;
  }

  void solve_group(const std::vector<int>& members) {
    std::vector<Row> rows;
    for (const int index : members) rows.push_back(reduced(rows_[index]));
    Independence earlier(rows, limits::relation::dependence);
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (const auto combination = earlier.add(rows[i])) refuse(members, i, *combination);
    Group group = make_group(rows);
    const std::vector<std::size_t> pivots = eliminate(group);
    for (std::size_t i = 0; i < pivots.size(); ++i) {
      const int e = group.columns[pivots[i]];
      map_.offset[e] = group.matrix[i].back();
      map_.fixed[e] = 1;
      for (std::size_t j = 0; j < group.columns.size(); ++j)
        if (j != pivots[i] && group.matrix[i][j] != 0)
          dependent_[e].emplace_back(group.columns[j], -group.matrix[i][j]);
    }
  }

  /// Row i of the group is a combination of those before it and of single rows: names the last of all these.
  [[noreturn]] void refuse(const std::vector<int>& members, std::size_t i,
                           const std::vector<double>& combination) const {
    const Row& row = rows_[members[i]];
    Sum value{row.value, std::abs(row.value)};
    std::map<int, Sum> left;
    for (const auto& [e, coefficient] : row.entries) left[e].add(coefficient);
    const double size = largest(row);
    int last = row.index;
    for (std::size_t j = 0; j < combination.size(); ++j) {
      const Row& earlier = rows_[members[j]];
      if (std::abs(combination[j]) * largest(earlier) <= limits::relation::dependence * size) continue;
      last = std::max(last, earlier.index);
      value.add(-combination[j] * earlier.value);
      for (const auto& [e, coefficient] : earlier.entries) left[e].add(-combination[j] * coefficient);
    }
    for (const auto& [e, sum] : left) {
      if (pin_[e] < 0 || std::abs(sum.value) <= limits::relation::dependence * sum.magnitude) continue;
      last = std::max(last, pin_[e]);
      value.add(-sum.value * map_.offset[e]);
    }
    throw RelationError(last, std::abs(value.value) > consistency * value.magnitude);
  }

  /// Numbers the coordinates that no row was solved for; those that depend on them are not fixed.
  void number_free() {
    std::vector<int> number(pin_.size(), -1);
    for (std::size_t e = 0; e < pin_.size(); ++e)
      if (!map_.fixed[e]) {
        number[e] = map_.free++;
        map_.home.push_back(static_cast<int>(e));
      }
    for (std::size_t e = 0; e < pin_.size(); ++e) {
      if (number[e] >= 0) map_.z.push_back({static_cast<int>(e), number[e], 1.0});
      for (auto term = dependent_[e].rbegin(); term != dependent_[e].rend(); ++term)
        map_.z.push_back({static_cast<int>(e), number[term->first], term->second});
      if (!dependent_[e].empty()) map_.fixed[e] = 0;
    }
  }

  std::vector<Row> rows_;
  std::vector<std::vector<std::pair<int, double>>>
      dependent_;         ///< of each end coordinate: (free one, coefficient)
  std::vector<int> pin_;  ///< the single row that fixes it, or -1
  EndMap map_;
};

}  // namespace

void BoundaryRelation::fix(int coordinate, bool at_end, double x) {
  add(add_row(x), at_end ? coordinates + coordinate : coordinate, 1.0);
}

void BoundaryRelation::give_momentum(int coordinate, bool at_end, double p) {
  momenta.resize(2 * static_cast<std::size_t>(coordinates));
  momenta[at_end ? coordinates + coordinate : coordinate] = p;
}

int BoundaryRelation::add_row(double c) {
  value.push_back(c);
  return rows++;
}

bool EndMap::fixes(bool at_end) const {
  const auto n = static_cast<std::ptrdiff_t>(fixed.size() / 2);
  const auto begin = fixed.begin() + (at_end ? n : 0);
  return std::all_of(begin, begin + n, [](char f) { return f; });
}

EndMap solve_relation(const BoundaryRelation& relation) {
  check_shape(relation);
  return Elimination(relation).solve();
}

}  // namespace extremal
