#include "solve/search/family.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "action/rule.hpp"
#include "linear/dense.hpp"
#include "machine/simd.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/newton/agreement.hpp"
#include "solve/newton/limits.hpp"
#include "solve/newton/zero_eigenvalue.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::continuum;

namespace {

void add(FamilyDirection& to, const FamilyDirection& other, double factor) {
  for (std::size_t k = 0; k < to.step.nodes.size(); ++k) to.step.nodes[k] += factor * other.step.nodes[k];
  for (std::size_t k = 0; k < to.step.inner.size(); ++k) to.step.inner[k] += factor * other.step.inner[k];
  to.values += factor * other.values;
}

}  // namespace

double unit_of(const Path& path, const ElementTables& tables) {
  const double size = scales(path, tables).q;
  return size > 0 ? size : 1;
}

ExtremalFamily::ExtremalFamily(const Problem& problem, const std::function<bool()>& count)
    : problem_(problem), count_(count), model_(make_condensed_model()) {}

void ExtremalFamily::reset(const ElementTables& tables, const Path& guess) {
  tables_ = &tables;
  elements_ = guess.elements();
  n_ = guess.coordinates();
  action_.reset(*problem_.lagrangian, tables, elements_, false);
  action_.give_momenta(problem_.boundary.momenta);
  action_.give_costs(problem_.boundary.costs);
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

bool ExtremalFamily::find_null(const Path& path, double apart, int least) {
  null_.clear();
  model_->set_phases(nullptr);
  model_->set_null_below(0);
  // Singular to the last digit: a little beside the path, or in another time, it is not.
  if (!answers_all(path) && !answers_all(bumped(path, beside, unit_of(path, *tables_)))) return false;
  // Jacobi fields have 2n constants, n where one end alone tells n conditions.
  const int size = (problem_.ends.free > 0 ? 2 : 1) * n_ + 1;
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
  stiffness_ = eigenvalues[std::min(std::max(small, least), size - 1)];
  found.resize(std::max(small, least));
  for (FamilyDirection& null : found) scale(null, 1 / std::sqrt(product(null.values, null.values)));
  null_ = std::move(found);
  orthonormalise(null_);
  return true;
}

double ExtremalFamily::step(Path& path, bool to_guess) { return step_along(path, to_guess, false); }

double ExtremalFamily::slide(Path& path) { return step_along(path, true, true); }

double ExtremalFamily::step_along(Path& path, bool to_guess, bool relaxed) {
  hold();
  if (!model_->evaluate(action_, path, nullptr) || !action_.finite()) return INFINITY;
  FamilyDirection change;
  model_->solve(action_, nullptr, change.step);
  if (problem_.paired) make_agree(change.step, n_);
  change.values = applied(path, change.step, 1) - values(path);
  if (!change.values.allFinite()) return INFINITY;
  for (const FamilyDirection& null : null_) add(change, null, -product(null.values, change.values));
  if (to_guess) {
    const Eigen::VectorXd away = guess_ - values(path);
    Eigen::VectorXd along = Eigen::VectorXd::Zero(away.size());
    for (const FamilyDirection& null : null_) along += product(null.values, away) * null.values;
    const double factor = relaxed ? relaxation(along) : 1;
    for (const FamilyDirection& null : null_) add(change, null, factor * product(null.values, away));
  }
  const double size = change.values.cwiseAbs().maxCoeff(),
               allowed = longest_family_step * unit_of(path, *tables_);
  path.add(change.step.nodes, change.step.inner, size > allowed ? allowed / size : 1);
  path.load_ends();
  return count_() ? size : INFINITY;
}

/// Steps along the family are those to the projection of the guess on its tangents. A family that is curved
/// makes them too long or too short by a factor, which follows from two steps (Aitken).
double ExtremalFamily::relaxation(const Eigen::VectorXd& along) {
  if (last_along_.size() == along.size()) {
    const Eigen::VectorXd change = along - last_along_;
    const double factor = -product(last_along_, change) / product(change, change);
    relaxation_ = std::isfinite(factor) && factor > 0
                      ? std::clamp(relaxation_ * factor, least_relaxation, largest_relaxation)
                      : 1;
  }
  last_along_ = along;
  return relaxation_;
}

bool ExtremalFamily::converge(Path& path, bool to_guess) {
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

double ExtremalFamily::force(const Path& path) {
  action_.evaluate_plain(path);
  // A path at rest has no momenta: there it is the force that another direction answers with.
  const double other = stiffness_ * unit_of(path, *tables_) * path.duration();
  const double momentum =
      action_.momentum_scale() > roundoff_of_guess * other ? action_.momentum_scale() : other;
  hold();
  if (!model_->evaluate(action_, path, nullptr)) return INFINITY;
  const std::size_t n = n_;
  double largest = 0;
  for (const FamilyDirection& null : null_) {
    double along = 0;
    for (std::size_t k = 0; k < null.step.nodes.size(); ++k)
      along += action_.nodes.gradient[k] * null.step.nodes[k];
    for (std::size_t e = 0; e < action_.nodes.end_parts.size(); ++e)
      along += action_.nodes.end_parts[e] * null.step.nodes[e < n ? e : null.step.nodes.size() - 2 * n + e];
    largest = std::max(largest, std::abs(along) / null.values.cwiseAbs().maxCoeff());
  }
  if (momentum > 0) return largest / momentum;
  return largest > 0 ? INFINITY : 0;
}

/// The null directions along which all copies of the coordinates move alike.
std::vector<FamilyDirection> ExtremalFamily::tangents() const {
  std::vector<FamilyDirection> result = null_;
  if (!problem_.paired) return result;
  for (FamilyDirection& direction : result) {
    make_agree(direction.step, n_);
    for (Eigen::Index point = 0; point < direction.values.size(); point += n_) {
      auto first = direction.values.segment(point, n_ / 2),
           second = direction.values.segment(point + n_ / 2, n_ / 2);
      first = second = (0.5 * (first + second)).eval();
    }
  }
  orthonormalise(result);
  return result;
}

int ExtremalFamily::dimension() const { return static_cast<int>(tangents().size()); }

bool ExtremalFamily::extends(const Path& path, double no_force, std::optional<Path>& closer) {
  const double unit = unit_of(path, *tables_), here = distance(path);
  double least = here - nearer * unit * unit * path.duration();
  closer.reset();
  for (const FamilyDirection& tangent : tangents())
    for (const double sign : {1.0, -1.0}) {
      Path moved = path;
      moved.add(tangent.step.nodes, tangent.step.inner,
                sign * aside * unit / tangent.values.cwiseAbs().maxCoeff());
      moved.load_ends();
      if (!converge(moved, false) || !(force(moved) <= no_force)) return false;
      if (const double there = distance(moved); there < least) {
        least = there;
        closer = moved;
      }
    }
  return true;
}

double ExtremalFamily::no_force(const Path& path) const {
  if (problem_.infinite || problem_.periodic) return largest_no_force;
  const std::vector<double>& nodes = tables_->scheme().lobatto;
  const Eigen::Index points = std::ssize(nodes), last = guess_.size() / n_ - 1;
  const auto slope = [&](const FamilyDirection& null, Eigen::Index point) {
    const Eigen::Index node = point % points;
    const double dt = path.lengths()[point / points] * (nodes[node + 1] - nodes[node]);
    return (null.values.segment((point + 1) * n_, n_) - null.values.segment(point * n_, n_)).norm() / dt;
  };
  double least = largest_no_force;
  for (const FamilyDirection& null : null_) {
    double steepest = 0;
    for (Eigen::Index point = 0; point < last; ++point)
      if ((point + 1) % points != 0) steepest = std::max(steepest, slope(null, point));
    const double turned = std::max(slope(null, 0), slope(null, last - 1)) / steepest,
                 moved = std::max(null.values.head(n_).norm(), null.values.tail(n_).norm()) /
                         null.values.cwiseAbs().maxCoeff(),
                 at_ends = std::max(turned, moved);
    least = std::min(least, part_of_force * at_ends * at_ends);
  }
  return least > roundoff_of_force ? least : 0;
}

int ExtremalFamily::index(const Path& path) {
  hold();
  return model_->evaluate(action_, path, nullptr) ? model_->inertia(zero_eigenvalue).negative : 0;
}

Eigen::VectorXd ExtremalFamily::values(const Path& path) const {
  const Eigen::Index size = static_cast<Eigen::Index>(path.degree() + 1) * n_;
  Eigen::VectorXd result(size * path.elements());
  for (int k = 0; k < path.elements(); ++k) path.element(k, result.data() + k * size);
  return result;
}

Eigen::VectorXd ExtremalFamily::applied(const Path& path, const Step& step, double factor) const {
  Path moved = path;
  moved.add(step.nodes, step.inner, factor);
  moved.load_ends();
  return values(moved);
}

double ExtremalFamily::product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
  return (x.array() * y.array() * weights_.array()).sum();
}
double ExtremalFamily::distance(const Path& path) const {
  const Eigen::VectorXd away = values(path) - guess_;
  return product(away, away);
}

void ExtremalFamily::scale(FamilyDirection& x, double factor) const {
  for (double& value : x.step.nodes) value *= factor;
  for (double& value : x.step.inner) value *= factor;
  x.values *= factor;
}
/// Those that depend on others are dropped.
void ExtremalFamily::orthonormalise(std::vector<FamilyDirection>& directions) const {
  std::vector<FamilyDirection> kept;
  const auto norm = [&](const FamilyDirection& x) { return std::sqrt(product(x.values, x.values)); };
  while (!directions.empty()) {
    const auto longest = std::ranges::max_element(directions, {}, norm);
    if (!kept.empty() && !(norm(*longest) > dependent)) break;
    kept.push_back(std::move(*longest));
    directions.erase(longest);
    scale(kept.back(), 1 / norm(kept.back()));
    for (FamilyDirection& other : directions)
      for (int pass = 0; pass < 2; ++pass)
        add(other, kept.back(), -product(kept.back().values, other.values));
  }
  directions = std::move(kept);
}

/// The step that a force causes: K·step = ∫ force · φ dt.
FamilyDirection ExtremalFamily::response(const Path& path, const Eigen::VectorXd& force) {
  const int lanes = simd_lanes(), points = path.degree() + 1;
  load_.assign(static_cast<std::size_t>(path.batches()) * lanes * points * n_, 0);
  for (Eigen::Index k = 0; k < force.size(); ++k) {
    const Eigen::Index element = k / (points * n_), local = k % (points * n_);
    load_[(element / lanes * points * n_ + local) * lanes + element % lanes] = -weights_[k] * force[k];
  }
  model_->put_load(action_, path, load_, 0);
  FamilyDirection result;
  model_->solve(action_, nullptr, result.step);
  result.values = applied(path, result.step, 1) - values(path);
  return result;
}

/// Whether the factors at a path answer a force along every direction, null ones too.
bool ExtremalFamily::answers_all(const Path& path) {
  if (!model_->evaluate(action_, path, nullptr)) return false;
  Step step;
  model_->solve(action_, nullptr, step);
  return model_->left_out() == 0;
}

/// Smooth, and in general position: at the ends too, where these are free.
Eigen::MatrixXd ExtremalFamily::first_directions(const Path& path, int size) const {
  Eigen::MatrixXd x(guess_.size(), size);
  const std::vector<double>& nodes = tables_->scheme().lobatto;
  const Eigen::Index points = std::ssize(nodes);
  for (Eigen::Index k = 0; k < x.rows(); ++k) {
    const auto [element, j] = std::div(static_cast<int>(k / n_), static_cast<int>(points));
    const double tau = path.mesh()[element] + nodes[j] * (path.mesh()[element + 1] - path.mesh()[element]);
    for (Eigen::Index c = 0; c < size; ++c)
      x(k, c) = std::sin(std::numbers::pi * (1 + c / n_) * tau) * ((k + c) % n_ == 0 ? 1 : 0.3) +
                0.1 * std::cos(std::numbers::pi * (1.3 + c) * tau);
  }
  return x;
}

/// Least eigenvalues by modulus, ascending, and their directions, by inverse iteration of so many vectors.
Eigen::VectorXd ExtremalFamily::subspace(const Path& path, int size, std::vector<FamilyDirection>& found) {
  Eigen::MatrixXd x = first_directions(path, size);
  Eigen::VectorXd eigenvalues(size);
  for (int pass = 0; pass < inverse_iterations; ++pass) {
    x = orthonormal(x);
    std::vector<FamilyDirection> answer(size);
    Eigen::MatrixXd answers(x.rows(), size);
    for (int j = 0; j < size; ++j) {
      answer[j] = response(path, x.col(j));
      answers.col(j) = answer[j].values;
    }
    if (!answers.allFinite()) return {};
    const Eigen::MatrixXd weighed = weights_.asDiagonal() * x;
    const Eigen::MatrixXd inverse = solved(weighed.transpose() * x, weighed.transpose() * answers);
    const GeneralEigen eigen = general_eigen(inverse);
    std::vector<int> order(size);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, std::greater{}, [&](int j) { return std::abs(eigen.values[j]); });
    found.assign(size, {});
    for (int j = 0; j < size; ++j) {
      eigenvalues[j] = 1 / std::abs(eigen.values[order[j]]);
      found[j].step.nodes.assign(answer[0].step.nodes.size(), 0);
      found[j].step.inner.assign(answer[0].step.inner.size(), 0);
      found[j].values = Eigen::VectorXd::Zero(x.rows());
      for (int i = 0; i < size; ++i) add(found[j], answer[i], eigenvalues[j] * eigen.vectors(i, order[j]));
      x.col(j) = found[j].values;
    }
    if (!x.allFinite()) return {};
  }
  return eigenvalues;
}

/// Steps leave out the null directions.
void ExtremalFamily::hold() {
  model_->set_null_below(zero_eigenvalue);
  phases_ = {};
  for (const FamilyDirection& null : null_) {
    std::vector<double> load = null.step.nodes;
    phases_.add(load);
  }
  model_->set_phases(null_.empty() ? nullptr : &phases_);
}

}  // namespace extremal
