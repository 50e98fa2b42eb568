#include "solve/search/continuum.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "action/rule.hpp"
#include "linear/dense.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/newton/limits.hpp"
#include "solve/newton/zero_eigenvalue.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::continuum;

namespace {

/// A change of a path: the step, and its values at the Lobatto nodes of all elements.
struct FamilyDirection {
  Step step;
  Eigen::VectorXd values;
};

/// The range of a path, or one of a path at the origin.
double unit_of(const Path& path, const ElementTables& tables) {
  const double range = scales(path, tables).q;
  return range > 0 ? range : 1;
}

class Continuum {
 public:
  Continuum(const Problem& problem, const std::function<bool()>& count)
      : problem_(problem), count_(count), model_(make_condensed_model()) {}

  /// Binds to elements; `guess` is the path that is to be near.
  void reset(const ElementTables& tables, const Path& guess) {
    tables_ = &tables;
    elements_ = guess.elements();
    n_ = guess.coordinates();
    action_.reset(*problem_.lagrangian, tables, elements_, false);
    model_->reset(problem_, tables, elements_);
    model_->set_phases(nullptr);
    guess_ = values(guess);
    const int points = guess.degree() + 1;
    const Rule rule = lobatto_rule(points);
    weights_.resize(guess_.size());
    for (Eigen::Index k = 0; k < weights_.size(); ++k) {
      const auto point = k / n_;
      weights_[k] = guess.lengths()[point / points] * rule.weights[point % points];
    }
  }

  /// Directions of the least eigenvalues, those that stand apart from the others by `apart`: by inverse
  /// iteration in a subspace of one more than can be null. At least so many.
  bool find_null(const Path& path, double apart, int least = 0) {
    null_.clear();
    model_->set_phases(nullptr);
    // Singular to the last digit: a little beside the path, or in another time, it is not.
    if (!model_->evaluate(action_, path, nullptr) && !model_->evaluate(action_, bumped(path), nullptr))
      return false;
    // There are at most as many null directions as coordinates.
    const int size = n_ + 1;
    std::vector<FamilyDirection> found;
    const Eigen::VectorXd eigenvalues = subspace(path, size, found);
    if (eigenvalues.size() == 0) return false;
    // The widest gap between eigenvalues that follow each other.
    int small = 0;
    double widest = apart;
    for (int j = 1; j < size; ++j)
      if (const double ratio = eigenvalues[j - 1] / eigenvalues[j]; ratio <= widest) {
        widest = ratio;
        small = j;
      }
    found.resize(std::max(small, least));
    null_ = std::move(found);
    orthonormalise();
    return true;
  }
  int dimension() const { return static_cast<int>(null_.size()); }

  /// One step across the null directions, and, if `to_guess`, along them to where the distance from the guess
  /// is stationary. Its largest value, or infinity.
  double step(Path& path, bool to_guess) {
    hold();
    if (!model_->evaluate(action_, path, nullptr) || !action_.finite()) return INFINITY;
    FamilyDirection change;
    model_->solve(action_, nullptr, change.step);
    change.values = applied(path, change.step, 1) - values(path);
    if (!change.values.allFinite()) return INFINITY;
    const Eigen::VectorXd away = values(path) + change.values - guess_;
    for (const FamilyDirection& null : null_) {
      const double along = product(null.values, to_guess ? away : change.values);
      add(change, null, -along);
    }
    const double size = change.values.cwiseAbs().maxCoeff(),
                 allowed = longest_family_step * unit_of(path, *tables_);
    path.add(change.step.nodes, change.step.inner, size > allowed ? allowed / size : 1);
    path.load_ends();
    return count_() ? size : INFINITY;
  }

  /// Steps until they are roundoff.
  bool converge(Path& path, bool to_guess) {
    const double unit = unit_of(path, *tables_);
    double before = INFINITY;
    for (int k = 0; k < most_family_steps; ++k) {
      const double size = step(path, to_guess);
      if (!std::isfinite(size)) return false;
      if (size <= arrived * unit || (size <= nearly * unit && size > 0.5 * before)) return true;
      before = size;
    }
    return false;
  }

  /// The force along the null directions, relative to the largest momentum: zero on a family.
  double force(const Path& path) {
    action_.evaluate_plain(path);
    const double momentum = action_.momentum_scale();
    hold();
    if (!model_->evaluate(action_, path, nullptr)) return INFINITY;
    double largest = 0;
    for (const FamilyDirection& null : null_) {
      double along = 0;
      for (std::size_t k = n_; k < null.step.nodes.size() - n_; ++k)
        along += action_.nodes.gradient[k] * null.step.nodes[k];
      largest = std::max(largest, std::abs(along) / null.values.cwiseAbs().maxCoeff());
    }
    if (momentum > 0) return largest / momentum;
    return largest > 0 ? INFINITY : 0;
  }

  /// Whether members of the family are on both sides.
  bool extends(const Path& path) {
    const double unit = unit_of(path, *tables_);
    for (const FamilyDirection& null : null_)
      for (const double sign : {1.0, -1.0}) {
        Path moved = path;
        moved.add(null.step.nodes, null.step.inner, sign * aside * unit / null.values.cwiseAbs().maxCoeff());
        moved.load_ends();
        if (!converge(moved, false) || !(force(moved) <= no_force)) return false;
      }
    return true;
  }

  /// Of the second variation across the family.
  int index(const Path& path) {
    hold();
    return model_->evaluate(action_, path, nullptr) ? model_->inertia(zero_eigenvalue).negative : 0;
  }

 private:
  Eigen::VectorXd values(const Path& path) const {
    const Eigen::Index size = static_cast<Eigen::Index>(path.degree() + 1) * n_;
    Eigen::VectorXd result(size * path.elements());
    for (int k = 0; k < path.elements(); ++k) path.element(k, result.data() + k * size);
    return result;
  }
  Path bumped(const Path& path) const {
    Path moved = path;
    const double unit = beside * unit_of(path, *tables_);
    for (int k = 1; k < elements_; ++k)
      for (int a = 0; a < n_; ++a)
        moved.set_node(k, a, path.node(k)[a] + unit * std::sin(k * (a + 1.0) + path.mesh()[k]));
    moved.load_ends();
    moved.set_duration(path.duration() * (1 + beside));
    return moved;
  }
  Eigen::VectorXd applied(const Path& path, const Step& step, double factor) const {
    Path moved = path;
    moved.add(step.nodes, step.inner, factor);
    moved.load_ends();
    return values(moved);
  }
  double product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
    return (x.array() * y.array() * weights_.array()).sum();
  }
  static void add(FamilyDirection& to, const FamilyDirection& other, double factor) {
    for (std::size_t k = 0; k < to.step.nodes.size(); ++k) to.step.nodes[k] += factor * other.step.nodes[k];
    for (std::size_t k = 0; k < to.step.inner.size(); ++k) to.step.inner[k] += factor * other.step.inner[k];
    to.values += factor * other.values;
  }
  void scale(FamilyDirection& x, double factor) const {
    for (double& value : x.step.nodes) value *= factor;
    for (double& value : x.step.inner) value *= factor;
    x.values *= factor;
  }
  void orthonormalise() {
    for (std::size_t j = 0; j < null_.size(); ++j) {
      for (int pass = 0; pass < 2; ++pass)
        for (std::size_t i = 0; i < j; ++i)
          add(null_[j], null_[i], -product(null_[i].values, null_[j].values));
      scale(null_[j], 1 / std::sqrt(product(null_[j].values, null_[j].values)));
    }
  }

  /// The step of every mesh node has the length of the time around it as its weight.
  std::vector<double> weighed(const Path& path, const std::vector<double>& nodes) const {
    std::vector<double> result = nodes;
    const std::span<const double> mesh = path.mesh();
    for (int k = 0; k <= elements_; ++k)
      for (int a = 0; a < n_; ++a)
        result[k * n_ + a] *= k == 0 || k == elements_ ? 0 : 0.5 * (mesh[k + 1] - mesh[k - 1]);
    return result;
  }

  /// Least eigenvalues by modulus, ascending, and their directions, by inverse iteration of so many vectors.
  Eigen::VectorXd subspace(const Path& path, int size, std::vector<FamilyDirection>& found) {
    const Eigen::Index nodes = static_cast<Eigen::Index>(elements_ + 1) * n_;
    Eigen::MatrixXd x(nodes, size);
    for (Eigen::Index j = 0; j < size; ++j)
      for (Eigen::Index k = 0; k < nodes; ++k) {
        const double tau = path.mesh()[k / n_];
        x(k, j) = std::sin(std::numbers::pi * (1 + j / n_) * tau) * ((k + j) % n_ == 0 ? 1 : 0.3) +
                  0.1 * std::sin(std::numbers::pi * (2 + j) * tau);
      }
    Eigen::VectorXd eigenvalues;
    for (int pass = 0; pass < inverse_iterations; ++pass) {
      Eigen::MatrixXd loads(nodes, size), answers(nodes, size);
      std::vector<FamilyDirection> answer(size);
      x = orthonormal(x);
      for (int j = 0; j < size; ++j) {
        const std::vector<double> column(x.col(j).begin(), x.col(j).end()), load = weighed(path, column);
        model_->respond(action_, nullptr, load, answer[j].step);
        loads.col(j) = Eigen::Map<const Eigen::VectorXd>(load.data(), nodes);
        answers.col(j) = Eigen::Map<const Eigen::VectorXd>(answer[j].step.nodes.data(), nodes);
      }
      if (!answers.allFinite()) return {};
      const Eigen::MatrixXd form = x.transpose() * weighed_all(path, answers), mass = x.transpose() * loads;
      const Eigen::MatrixXd inverse = solved(mass, form);
      const GeneralEigen eigen = general_eigen(inverse);
      std::vector<int> order(size);
      for (int j = 0; j < size; ++j) order[j] = j;
      std::sort(order.begin(), order.end(),
                [&](int a, int b) { return std::abs(eigen.values[a]) > std::abs(eigen.values[b]); });
      eigenvalues.resize(size);
      for (int j = 0; j < size; ++j) eigenvalues[j] = 1 / std::abs(eigen.values[order[j]]);
      found.assign(size, {});
      for (int j = 0; j < size; ++j) {
        found[j].step.nodes.assign(nodes, 0);
        found[j].step.inner.assign(answer[0].step.inner.size(), 0);
        found[j].values = Eigen::VectorXd::Zero(guess_.size());
        const double unit = 1 / std::abs(eigen.values[order[j]]);
        for (int i = 0; i < size; ++i) {
          const double factor = unit * eigen.vectors(i, order[j]);
          for (Eigen::Index k = 0; k < nodes; ++k) found[j].step.nodes[k] += factor * answer[i].step.nodes[k];
          for (std::size_t k = 0; k < found[j].step.inner.size(); ++k)
            found[j].step.inner[k] += factor * answer[i].step.inner[k];
        }
        found[j].values = applied(path, found[j].step, 1) - values(path);
        x.col(j) = Eigen::Map<const Eigen::VectorXd>(found[j].step.nodes.data(), nodes);
      }
      if (!x.allFinite()) return {};
    }
    return eigenvalues;
  }
  Eigen::MatrixXd weighed_all(const Path& path, const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd result = x;
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      const std::vector<double> column = weighed(path, {x.col(j).begin(), x.col(j).end()});
      result.col(j) = Eigen::Map<const Eigen::VectorXd>(column.data(), x.rows());
    }
    return result;
  }

  /// Steps leave out the null directions.
  void hold() {
    phases_ = {};
    for (const FamilyDirection& null : null_) {
      std::vector<double> load = null.step.nodes;
      phases_.add(load);
    }
    model_->set_phases(null_.empty() ? nullptr : &phases_);
  }

  const Problem& problem_;
  const std::function<bool()>& count_;
  std::unique_ptr<SecondVariationModel> model_;
  const ElementTables* tables_ = nullptr;
  DiscreteAction action_;
  PhaseConditions phases_;
  int elements_ = 0, n_ = 0;
  Eigen::VectorXd guess_, weights_;
  std::vector<FamilyDirection> null_;  ///< orthonormal in L2
};

/// Goes to the member that is nearest to the guess. The null directions of the guess may be others: they are
/// found again where steps across them have led.
bool reach_member(Continuum& continuum, Path& path, double unit) {
  if (!continuum.find_null(path, softer, 1)) return false;
  for (int round = 0; round < most_null_rounds; ++round) {
    if (round > 0 && !continuum.find_null(path, null_eigenvalue)) return false;
    // Far from an extremal no direction need be null: a few whole steps lead nearer.
    if (continuum.dimension() == 0) {
      if (round == most_null_rounds - 1) return false;
      for (int k = 0; k < whole_steps; ++k)
        if (!(continuum.step(path, false) > near_extremal * unit)) break;
      continue;
    }
    const double size = continuum.step(path, true);
    if (round > 0 && size <= nearly * unit) return continuum.converge(path, true);
    if (!std::isfinite(size) || !continuum.converge(path, true)) return false;
  }
  return false;
}

/// Whether elements of a higher degree find the same member; `moved` becomes by how much theirs differs.
bool confirmed_by_higher_degree(const Problem& problem, Workspace& w, const Path& path, const Path& guess,
                                int dimension, const std::function<bool()>& count, double& moved) {
  const ElementTables& finer = w.levels.at(family_degree + raised);
  const std::vector<double>& up = w.levels.raise(family_degree, family_degree + raised);
  Path higher, higher_guess;
  higher.interpolate_from(path, finer, up);
  higher_guess.interpolate_from(guess, finer, up);
  Continuum check(problem, count);
  check.reset(finer, higher_guess);
  if (!check.find_null(higher, null_eigenvalue) || check.dimension() != dimension) return false;
  if (!check.converge(higher, true)) return false;
  moved = 0;
  for (std::size_t k = 0; k < path.nodes().size(); ++k)
    moved = std::max(moved, std::abs(higher.nodes()[k] - path.nodes()[k]));
  return true;
}

std::vector<double> halves_of(const std::vector<double>& mesh) {
  std::vector<double> halves{0};
  for (std::size_t k = 1; k < mesh.size(); ++k) {
    halves.push_back(0.5 * (mesh[k - 1] + mesh[k]));
    halves.push_back(mesh[k]);
  }
  return halves;
}

}  // namespace

bool nearest_of_family(const Problem& problem, const SolveOptions& options, Workspace& w,
                       std::vector<double> mesh, const FillGuess& fill, const FillGuess& start,
                       const std::function<bool()>& count, Outcome& outcome) {
  const ElementTables& tables = w.levels.at(family_degree);
  if (w.levels.at(family_degree + raised).unknowns() > most_dense_unknowns) return false;
  while (mesh.size() < 5) mesh = halves_of(mesh);
  Path guess, path;
  for (int halving = 0; halving <= most_family_halvings; ++halving) {
    if (halving > 0) mesh = halves_of(mesh);
    if (static_cast<int>(mesh.size()) > most_family_elements) return false;
    fill(tables, mesh, guess);
    if (halving == 0) {
      start(tables, mesh, path);
    } else {
      const Path before = path;
      path.resample_from(before, tables, mesh);
    }
    const double unit = unit_of(path, tables);
    Continuum continuum(problem, count);
    continuum.reset(tables, guess);
    if (!reach_member(continuum, path, unit)) return false;
    w.resolution.measure(path, tables);
    const Scales size = scales(path, tables);
    const Resolution::Error error = w.resolution.at(family_degree);
    const double allowed = family_share * options.tolerance;
    if (error.q > allowed * size.q || error.v > momentum_tolerances * allowed * size.v) continue;
    double moved = 0;
    if (!(continuum.force(path) <= no_force) || !continuum.extends(path)) return false;
    if (!confirmed_by_higher_degree(problem, w, path, guess, continuum.dimension(), count, moved))
      return false;
    if (moved > allowed * size.q) continue;
    outcome.index_across = continuum.index(path);
    outcome.family = continuum.dimension();
    outcome.tables = &tables;
    outcome.error = error.q + moved;
    outcome.tolerance = options.tolerance * size.q;
    outcome.path = std::move(path);
    outcome.message =
        "converged; the ends are conjugate, and this is one of a family of extremals with these ends, the "
        "nearest to the guess";
    return true;
  }
  return false;
}

}  // namespace extremal
