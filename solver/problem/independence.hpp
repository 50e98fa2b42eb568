#pragma once

#include <optional>
#include <utility>
#include <vector>

/// \file Whether a condition follows from others, and from which.

namespace extremal {

/// Σ_e coefficient x_e = value; entries ascending in e, none zero.
struct Row {
  int index;
  std::vector<std::pair<int, double>> entries;
  double value;
};

/// Rows made orthonormal one by one (Gram-Schmidt, twice), each with its combination of the rows given.
class Independence {
 public:
  /// Remainders below `threshold`, relative to the row they are left of, count as zero.
  explicit Independence(const std::vector<Row>& rows, double threshold);

  /// Adds the next of the rows and returns nothing; or, where it depends on those added before, the
  /// coefficients a with row = Σ_j a_j row_j over them.
  std::optional<std::vector<double>> add(const Row& row);

 private:
  double threshold_;
  std::vector<int> columns_;
  struct Direction {
    std::vector<double> entries, combination;
  };
  std::vector<Direction> basis_;
};

double length(const std::vector<double>& x);

}  // namespace extremal
