#include "linear/sparse_pattern.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace extremal {

SparsePattern lower_triangle(int n, std::span<const int> rows, std::span<const int> columns) {
  std::vector<std::pair<int, int>> places;  // column, row
  for (std::size_t k = 0; k < rows.size(); ++k) places.emplace_back(std::minmax(rows[k], columns[k]));
  std::vector<std::pair<int, int>> sorted = places;
  for (int i = 0; i < n; ++i) sorted.emplace_back(i, i);
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  SparsePattern lower;
  lower.begin.assign(n + 1, 0);
  for (const auto& [column, row] : sorted) ++lower.begin[column + 1], lower.row.push_back(row);
  for (int j = 0; j < n; ++j) lower.begin[j + 1] += lower.begin[j];
  for (const auto& place : places)
    lower.slot.push_back(int(std::lower_bound(sorted.begin(), sorted.end(), place) - sorted.begin()));
  return lower;
}

SparsePattern both_triangles(const SparsePattern& lower) {
  const int n = int(lower.begin.size()) - 1;
  SparsePattern full;
  full.begin.assign(n + 1, 0);
  for (int j = 0; j < n; ++j)
    for (int p = lower.begin[j]; p < lower.begin[j + 1]; ++p) {
      ++full.begin[j + 1];
      if (lower.row[p] != j) ++full.begin[lower.row[p] + 1];
    }
  for (int j = 0; j < n; ++j) full.begin[j + 1] += full.begin[j];
  full.row.resize(full.begin[n]);
  full.slot.resize(full.begin[n]);
  std::vector<int> next(full.begin.begin(), full.begin.end() - 1);
  const auto put = [&](int row, int column, int p) {
    full.row[next[column]] = row;
    full.slot[next[column]++] = p;
  };
  for (int j = 0; j < n; ++j)  // column j has its upper entries from the columns before it: rows ascend
    for (int p = lower.begin[j]; p < lower.begin[j + 1]; ++p) {
      put(lower.row[p], j, p);
      if (lower.row[p] != j) put(j, lower.row[p], p);
    }
  return full;
}

}  // namespace extremal
