#include "linear/sparse_pattern.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace extremal {

namespace {

/// Indices of `keys` (0 … n − 1), taken in the order `given`, so that keys ascend; equal ones keep their
/// order.
std::vector<int> sorted_by(int n, const std::vector<int>& keys, const std::vector<int>& given) {
  std::vector<int> next(n + 1, 0), result(given.size());
  for (int key : keys) ++next[key + 1];
  for (int i = 0; i < n; ++i) next[i + 1] += next[i];
  for (int k : given) result[next[keys[k]]++] = k;
  return result;
}

}  // namespace

SparsePattern lower_triangle(int n, std::span<const int> rows, std::span<const int> columns) {
  // The diagonal first, then the entries.
  const std::size_t count = n + rows.size();
  std::vector<int> row(count), column(count), order(count);
  std::iota(order.begin(), order.end(), 0);
  for (int i = 0; i < n; ++i) row[i] = column[i] = i;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    row[n + k] = std::max(rows[k], columns[k]);
    column[n + k] = std::min(rows[k], columns[k]);
  }
  SparsePattern lower;
  lower.begin.assign(n + 1, 0);
  lower.slot.resize(rows.size());
  int before = -1;
  for (int k : sorted_by(n, column, sorted_by(n, row, order))) {
    if (before < 0 || row[k] != row[before] || column[k] != column[before]) {
      lower.row.push_back(row[k]);
      ++lower.begin[column[k] + 1];
    }
    if (k >= n) lower.slot[k - n] = int(lower.row.size()) - 1;
    before = k;
  }
  for (int j = 0; j < n; ++j) lower.begin[j + 1] += lower.begin[j];
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
