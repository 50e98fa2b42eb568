#include "solve/branch/motion_sign.hpp"

#include <map>
#include <vector>

#include "linear/determinant.hpp"

namespace extremal {

namespace {

class MotionMatrix {
 public:
  MotionMatrix(const Problem& problem, const DiscreteAction& action, const Path& path)
      : action_(action),
        all_(path.coordinates()),
        n_(all_ / 2),
        elements_(path.elements()),
        rows_((elements_ - 1) * n_) {
    for (const Triplet& z : problem.ends.z) {
      if (z.row % all_ >= n_) continue;
      const auto [at, added] = columns_.emplace(z.column, rows_);
      rows_ += added;
      ends_.push_back({z.row, at->second, z.value});
    }
  }

  /// Rows of the difference of the copies, columns of their mean. Exchanging the copies changes the sign of
  /// the Hessian, so that the rows of the first copy do.
  void add_elements() {
    for (int k = 0; k < elements_; ++k)
      for (int row = 0; row < 2 * n_; ++row)
        for (int column = 0; column < 2 * n_; ++column) {
          const int i = local(row), j = local(column);
          const double value = form(k, i, j) + form(k, i, j + n_);
          for (const Share& r : shares(k, row))
            for (const Share& c : shares(k, column))
              entries_.emplace_back(r.unknown, c.unknown, r.factor * c.factor * value);
        }
  }

  /// A free duration is one more column; what closes it one more row.
  void add_duration(const ClosingEquation& closing, std::span<const double> phase) {
    const int last = rows_++;
    spread(action_.nodes.border, last, true);
    if (closing.row.empty()) {
      spread(phase, last, false);
      return;
    }
    for (const Triplet& z : ends_)
      entries_.emplace_back(last, z.column, z.value * (closing.row[z.row] + closing.row[z.row + n_]));
  }

  void add_symmetry(std::span<const double> direction) {
    const int last = rows_++;
    spread(direction, last, true);
    spread(direction, last, false);
  }

  /// Of the first copy at all nodes.
  bool moves_first(std::span<const double> direction) const {
    for (std::size_t i = 0; i < direction.size(); ++i)
      if (static_cast<int>(i % all_) < n_ && direction[i] != 0) return true;
    return false;
  }

  int sign() const { return determinant_sign(entries_, rows_); }

 private:
  struct Share {
    int unknown;
    double factor;
  };
  int local(int row) const { return row < n_ ? row : row - n_ + all_; }
  double form(int k, int i, int j) const {
    return i >= j ? action_.condensed(k, i, j) : action_.condensed(k, j, i);
  }
  std::vector<Share> shares(int element, int row) const { return shares_of(element + (row >= n_), row % n_); }
  std::vector<Share> shares_of(int node, int a) const {
    if (node > 0 && node < elements_) return {{(node - 1) * n_ + a, 1}};
    std::vector<Share> result;
    for (const Triplet& z : ends_)
      if (z.row == (node == 0 ? a : all_ + a)) result.push_back({z.column, z.value});
    return result;
  }
  void spread(std::span<const double> nodes, int last, bool as_column) {
    for (int node = 0; node <= elements_; ++node)
      for (int a = 0; a < n_; ++a)
        for (const Share& share : shares_of(node, a)) {
          const double value = share.factor * nodes[static_cast<std::size_t>(node) * all_ + a];
          entries_.emplace_back(as_column ? share.unknown : last, as_column ? last : share.unknown, value);
        }
  }

  const DiscreteAction& action_;
  const int all_, n_, elements_;
  int rows_;
  std::map<int, int> columns_;  ///< of free unknowns of the ends
  std::vector<Triplet> ends_;   ///< of the first copy: end, unknown, factor
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

int motion_sign(const Problem& problem, const DiscreteAction& action, const ElementTables& tables,
                const Path& path, const ClosingEquation* closing) {
  if (tables.unknowns() > most_dense_unknowns) return 0;
  MotionMatrix matrix(problem, action, path);
  matrix.add_elements();
  PhaseConditions phases;
  measure_phases(problem, path, tables.scheme(), true, phases);
  const bool by_phase = closing && closing->row.empty();
  if (by_phase && phases.count == 0) return 0;
  if (closing) matrix.add_duration(*closing, by_phase ? phases.direction(0) : std::span<const double>());
  for (int j = by_phase; j < phases.count; ++j)
    if (matrix.moves_first(phases.direction(j))) matrix.add_symmetry(phases.direction(j));
  return matrix.sign();
}

}  // namespace extremal
