#include "solve/bordered/determinacy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "problem/independence.hpp"
#include "problem/manifold.hpp"
#include "solve/bordered/bordered_equations.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

/// The derivatives of the equations with entries of size one: each is divided by the largest sum of terms of
/// its column, then of its row. What is left where terms cancel counts as zero, and so does a row of a target
/// that the path changes by less than the roundoff of its terms.
class Equilibrated {
 public:
  /// `path` is the size of the path.
  Equilibrated(const BorderedEquations& equations, double path) {
    const Eigen::Index size = equations.unknowns();
    values_ = equations.matrix();
    BorderedEquations::Matrix terms(size, size);
    std::vector<Eigen::Triplet<double>> entries = equations.entries();
    for (auto& e : entries) e = {e.row(), e.col(), std::abs(e.value())};
    terms.setFromTriplets(entries.begin(), entries.end());
    Eigen::VectorXd least = Eigen::VectorXd::Zero(size), column = least, row = least;
    const std::vector<int> targets = equations.target_rows();
    for (std::size_t i = 0; i < targets.size(); ++i)
      least[targets[i]] = target_roundoff * equations.target_sizes()[i] / path;
    const auto each = [&](const auto& visit) {
      for (Eigen::Index j = 0; j < size; ++j)
        for (BorderedEquations::Matrix::InnerIterator t(terms, j), x(values_, j); t; ++t, ++x)
          if (t.value() > least[t.row()])
            visit(t.row(), j, t.value(), x.valueRef());
          else
            x.valueRef() = 0;
    };
    each([&](auto, auto j, double t, double&) { column[j] = std::max(column[j], t); });
    each([&](auto i, auto j, double t, double&) { row[i] = std::max(row[i], t / column[j]); });
    each([&](auto i, auto j, double, double& x) {
      x /= row[i] * column[j];
      if (std::abs(x) <= structural) x = 0;
    });
    rows_ = values_.transpose();
  }

  Row row(int i) const { return line(rows_, i); }
  Row column(int j) const { return line(values_, j); }

 private:
  static Row line(const BorderedEquations::Matrix& matrix, int j) {
    Row line{j, {}, 0};
    for (BorderedEquations::Matrix::InnerIterator x(matrix, j); x; ++x)
      if (x.value() != 0) line.entries.emplace_back(static_cast<int>(x.row()), x.value());
    return line;
  }

  BorderedEquations::Matrix values_, rows_;
};

/// The first line that is made of those before it, and which ones take part.
std::optional<std::pair<int, std::vector<int>>> first_dependent(const std::vector<Row>& lines) {
  Independence earlier(lines, structural);
  for (int k = 0; k < std::ssize(lines); ++k) {
    const std::optional<std::vector<double>> combination = earlier.add(lines[k]);
    if (!combination) continue;
    std::vector<int> parts;
    for (int j = 0; j < std::ssize(*combination); ++j)
      if (std::abs((*combination)[j]) > takes_part) parts.push_back(j);
    return std::pair{k, parts};
  }
  return std::nullopt;
}

std::optional<Indeterminacy> of_rows(const BorderedEquations& equations, const Equilibrated& matrix) {
  std::vector<Row> rows;
  for (const int row : equations.target_rows()) rows.push_back(matrix.row(row));
  const auto found = first_dependent(rows);
  if (!found) return std::nullopt;
  using Kind = Indeterminacy::Kind;
  const int k = found->first, integrals = equations.extension().multipliers(),
            given = integrals + equations.conditions();
  if (k < integrals) return Indeterminacy{Kind::integral, k, {}, {}};
  if (k < given) return Indeterminacy{Kind::condition, k - integrals, {}, {}};
  return Indeterminacy{Kind::where, k - given, {}, {}};
}

/// Multipliers first: what integrals and conditions leave open has nothing to do with constants.
std::optional<Indeterminacy> of_columns(const BorderedEquations& equations, const Equilibrated& matrix) {
  const int first = equations.first_constant(), unknowns = equations.extension().unknowns(),
            integrals = equations.extension().multipliers(), multipliers = integrals + equations.conditions();
  std::vector<Row> columns;
  for (int j = 0; j < multipliers; ++j) columns.push_back(matrix.column(first + unknowns + j));
  for (int k = 0; k < unknowns; ++k) columns.push_back(matrix.column(first + k));
  const auto found = first_dependent(columns);
  if (!found) return std::nullopt;
  using Kind = Indeterminacy::Kind;
  const int last = found->first;
  if (last < integrals) return Indeterminacy{Kind::integral, last, {}, {}};
  if (last < multipliers) return Indeterminacy{Kind::condition, last - integrals, {}, {}};
  Indeterminacy result{Kind::constant, last - multipliers, {}, {}};
  for (const int j : found->second) {
    if (j < integrals) result.integrals.push_back(j);
    if (j >= multipliers) result.constants.push_back(j - multipliers);
  }
  result.constants.push_back(result.last);
  return result;
}

/// States in general position about the guess.
class NearbyStates {
 public:
  explicit NearbyStates(const Problem& problem) : problem_(problem), extension_(*problem.extension) {
    all_.bind(extension_.lagrangian);
    own_.bind(problem.lagrangian);
    mesh_.first.push_back(0);
    for (const WaypointCondition& w : extension_.waypoints)
      times_.push_back(w.free ? w.time * problem.duration.value : w.time);
    times_.push_back(problem.duration.value);
    for (std::size_t l = 0; l < times_.size(); ++l) {
      mesh_.parts.insert(mesh_.parts.end(), elements_of_state, 1.0 / elements_of_state);
      mesh_.first.push_back(static_cast<int>(mesh_.parts.size()));
    }
  }

  /// The equations there, and the size of the path; none if they are not finite.
  std::optional<double> evaluate(double distance, unsigned seed, BorderedEquations& equations) {
    const ElementTables &all = all_.at(degree), &own = own_.at(degree);
    Noise noise(seed);
    std::vector<double> constants = extension_.guess;
    constants.resize(extension_.constants(), 0);
    for (double& c : constants) c += distance * (c != 0 ? std::abs(c) : 1) * noise();
    Path path;
    const std::vector<double> lengths = element_lengths(mesh_, times_);
    path.reset(own, mesh_nodes(lengths), times_.back(), lengths);
    const std::vector<double> ends = moved_ends(problem_, starting_ends(problem_), distance, seed);
    start_path(problem_, ends, own, path);
    if (!put_waves(distance, constants, noise, own, path)) return std::nullopt;
    BorderedState state{{}, mesh_, times_, std::vector<double>(extension_.conditions.size())};
    with_constants(path, all, constants, state.path);
    equations.reset(problem_, all, own, mesh_);
    const double size = path_size(state, problem_.coordinates()).value;
    if (!equations.evaluate(state, false)) return std::nullopt;
    put_multipliers(equations, size, noise, state.multipliers);
    if (!equations.evaluate(state, true)) return std::nullopt;
    return size;
  }

 private:
  /// Of conditions r: η ∂r/∂q is about as large as momenta, so that the equations of the ends tell constants
  /// apart that r alone contains in one combination.
  void put_multipliers(const BorderedEquations& equations, double path, Noise& noise,
                       std::vector<double>& multipliers) const {
    for (std::size_t i = 0; i < multipliers.size(); ++i) {
      const double terms = equations.target_sizes()[extension_.multipliers() + i];
      multipliers[i] = terms > 0 ? noise() * equations.momentum() * path / terms : noise();
    }
  }

  /// On the manifold, where there are constraints. False if it cannot be reached.
  bool put_waves(double distance, const std::vector<double>& constants, Noise& noise,
                 const ElementTables& own, Path& path) const {
    const int n = problem_.coordinates();
    const std::vector<double> extent = extents(path, negligible_extent[0]);
    std::vector<double> amplitudes(static_cast<std::size_t>(waves) * n);
    for (std::size_t i = 0; i < amplitudes.size(); ++i) {
      const double size = extent[i % n];
      amplitudes[i] = distance * (size > 0 ? size : 1) * noise();
    }
    const std::shared_ptr<const Manifold> manifold =
        extension_.manifold_at ? extension_.manifold_at(constants) : problem_.manifold;
    bool reached = true;
    const auto moved = [&](double tau, double* point) {
      for (int m = 0; m < waves; ++m)
        for (int a = 0; a < n; ++a)
          point[a] +=
              amplitudes[static_cast<std::size_t>(m) * n + a] * std::sin((m + 1) * std::numbers::pi * tau);
      const std::span<double> q{point, static_cast<std::size_t>(n)};
      reached = reached && (!manifold || manifold->project(q, tau * times_.back()));
    };
    std::vector<double> ends = ends_of(path);
    moved(0, ends.data());
    moved(1, ends.data() + n);
    fill_path(ends, own, path, moved);
    return reached;
  }

  static constexpr int waves = 3;
  const Problem& problem_;
  const Extension& extension_;
  Levels all_, own_;
  LegMesh mesh_;
  std::vector<double> times_;
};

}  // namespace

std::optional<Indeterminacy> indeterminacy(const Problem& problem) {
  NearbyStates states(problem);
  BorderedEquations equations;
  std::optional<Indeterminacy> found;
  unsigned seed = 0;
  int evaluated = 0;
  for (const double distance : state_distances) {
    const std::optional<double> size = states.evaluate(distance, seed++, equations);
    if (!size) continue;
    ++evaluated;
    const Equilibrated matrix(equations, *size);
    found = of_rows(equations, matrix);
    if (!found) found = of_columns(equations, matrix);
    if (!found) return std::nullopt;
  }
  return evaluated > 1 ? found : std::nullopt;
}

}  // namespace extremal
