#include "study/fit/fitted_scene.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "problem/copies.hpp"
#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "study/checks/continuity.hpp"
#include "study/model/boundary.hpp"
#include "study/model/dependence.hpp"
#include "study/model/modelling.hpp"
#include "study/model/naming.hpp"

namespace extremal {
namespace {

/// Formulas of numbers are differentiated by central differences of fourth order over steps of this part of a
/// parameter: their errors and roundoff are near 1e-12.
constexpr double part = 1e-3;
/// Slopes of constraints that are smaller, relative to the largest, determine no coordinate.
constexpr double least_slope = 1e-6;
constexpr std::array<double, 4> places = {-2, -1, 1, 2};
constexpr std::array<double, 4> quotient_weights = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12};

double size_of(double value) { return value == 0 ? 1 : std::abs(value); }

bool depends(const BoundaryTable& boundary, const std::set<std::string>& names) {
  return names_any(boundary.start, names) || names_any(boundary.end, names) ||
         names_any(boundary.map, names) || names_any(boundary.duration, names) ||
         (boundary.energy && names_any(*boundary.energy, names)) ||
         (boundary.where && names_any(boundary.where->value, names)) ||
         std::ranges::any_of(boundary.conditions, [&](const Text& t) { return names_any(t.value, names); });
}

double size_of_ends(const EndPoints& ends) {
  double largest = 0;
  for (const std::vector<double>* end : {&ends.start, &ends.end})
    for (const double x : *end) largest = std::max(largest, std::abs(x));
  return size_of(largest);
}

bool same_matrix(const std::vector<Triplet>& a, const std::vector<Triplet>& b) {
  return std::ranges::equal(a, b, [](const Triplet& x, const Triplet& y) {
    return x.row == y.row && x.column == y.column && x.value == y.value;
  });
}

}  // namespace

FittedScene::FittedScene(const Scene& scene, const System& system, const Problem& problem, ProblemOf load)
    : scene_(scene),
      load_(std::move(load)),
      made_anew_(problem.extension || stiffness_jumps(problem) ||
                 (problem.manifold && problem.manifold->parts().only_minimal)),
      fit_(*scene.fit),
      table_(scene.system),
      boundary_(scene.boundary),
      system_(system),
      problem_(problem) {
  if (!scene.boundary.unknowns.empty())
    throw SceneError(fit_.at,
                     "a fit finds parameters by the data, and unknowns are found by 'where'; name them in "
                     "'parameters' of [fit] instead, or leave it out");
  if (problem.extension && !problem.extension->conditions.empty())
    throw SceneError(fit_.at,
                     "a fit leaves open ends to the data, which nonlinear conditions are not available with; "
                     "give the ends, or leave [fit] out");
  if (problem.initial)
    throw SceneError(
        fit_.at,
        "a fit needs conditions at both ends, and 'start' gives initial data; leave what is to be "
        "found out of 'start', the fit finds it at both ends");
  read_parameters(scene, system);
  find_dependent(scene);
  find_open(system);
  if (problem.manifold) near_ = end_points(problem);
  problem_.guess = {};
  problem_.reduction = nullptr;
  if (!made_anew_) check_dependence();
}

void FittedScene::read_parameters(const Scene& scene, const System& system) {
  for (const Text& text : fit_.parameters) {
    const std::string& name = text.value;
    const auto known = system.parameters.find(name);
    if (known == system.parameters.end()) {
      std::vector<std::string> names;
      for (const auto& [other, value] : system.parameters) names.push_back(other);
      throw UnknownChoice(position(text, 0), fmt::format("unknown parameter '{}'", name), name, names);
    }
    if (known->second.list)
      throw SceneError(position(text, 0),
                       fmt::format("'{}' is a list; a fitted parameter must be one number", name));
    if (std::ranges::find(parameters_, name) != parameters_.end())
      throw SceneError(position(text, 0), fmt::format("'{}' is named twice", name));
    const auto given = std::ranges::find(scene.system.parameters, name, &Assignment::name);
    if (given->values.front().formula())
      throw SceneError(position(text, 0),
                       fmt::format("'{}' is computed by a formula; fit the parameters in it", name));
    parameters_.push_back(name);
  }
}

/// What depends on the parameters through formulas; numbers among it are active parameters as well.
void FittedScene::find_dependent(const Scene& scene) {
  dependent_ = with_dependent({parameters_.begin(), parameters_.end()}, table_);
  active_ = parameters_;
  for (const Assignment& parameter : table_.parameters) {
    if (!dependent_.contains(parameter.name) || std::ranges::count(parameters_, parameter.name) > 0) continue;
    if (parameter.list)
      throw SceneError(fit_.at, fmt::format("the list '{}' is computed from a fitted parameter; write its "
                                            "elements as parameters or definitions of their own",
                                            parameter.name));
    active_.push_back(parameter.name);
  }
  boundary_depends_ = depends(scene.boundary, dependent_);
}

/// Whether near the guess constraints leave an end coordinate no freedom, of those that the relation leaves
/// open at its end and that come before it.
bool FittedScene::determined_by_constraints(int e, const Guess& guess) const {
  if (!problem_.manifold) return false;
  const int n = problem_.coordinates();
  std::vector<double> q(n);
  guess.at(e < n ? 0 : 1, q);
  const Eigen::MatrixXd slopes = problem_.manifold->at(q, e < n ? 0 : problem_.duration.value).slopes;
  // Columns of what is still to be determined: a basis among them stays with the constraints.
  const auto rank = [&](const std::vector<int>& columns) {
    Eigen::MatrixXd part(slopes.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k)
      part.col(static_cast<Eigen::Index>(k)) = slopes.col(columns[k]);
    if (part.size() == 0) return Eigen::Index{0};
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(part);
    qr.setThreshold(least_slope);
    return qr.rank();
  };
  std::vector<int> left;
  for (const int other : ends_left_)
    if ((other < n) == (e < n) && !is_open(other)) left.push_back(other % n);
  std::vector<int> without = left;
  std::erase(without, e % n);
  return rank(without) < rank(left);
}

bool FittedScene::is_open(int e) const { return std::ranges::find(open_, e, &OpenEnd::e) != open_.end(); }

/// End coordinates that neither the relation, constraints nor a momentum determines. Closed orbits have none.
void FittedScene::find_open(const System& system) {
  if (problem_.periodic) return;
  const PlacedRelation placed = read_relation(boundary_, system);
  const int n = problem_.coordinates();
  ends_left_ = problem_.manifold ? solve_relation(placed.relation).home : problem_.ends.home;
  std::ranges::sort(ends_left_);
  for (const int e : ends_left_) {
    if (!placed.momentum_given.empty() && placed.momentum_given[e]) continue;
    if (determined_by_constraints(e, problem_.guess))
      determined_.push_back(e);
    else
      open_.push_back({e, fmt::format("{}({})", system.names[e % n], e < n ? "0" : "T")});
  }
}

void FittedScene::check_dependence() const {
  if (!boundary_depends_) return;
  std::vector<double> values = start();
  for (const OpenEnd& open : open_) {
    const int n = problem_.coordinates();
    values.push_back(!problem_.manifold ? 0 : open.e < n ? near_.start[open.e] : near_.end[open.e - n]);
  }
  const Numbers here = numbers(values);
  for (std::size_t j = 0; j < parameters_.size(); ++j) {
    double step = 0;
    for (const Numbers& there : around(values, j, step)) {
      if (!same_matrix(here.relation.matrix, there.relation.matrix))
        throw SceneError(
            fit_.at,
            fmt::format("coefficients of the boundary relation depend on '{}'; only right-hand sides "
                        "may",
                        parameters_[j]));
      if (!boundary_.free && there.duration.value != here.duration.value &&
          !problem_.motion().structure().autonomous)
        throw SceneError(
            boundary_.duration.at,
            fmt::format("the duration depends on '{}', and L depends on t; give the duration as a "
                        "number",
                        parameters_[j]));
    }
  }
}

std::vector<double> FittedScene::start() const {
  std::vector<double> values;
  for (const std::string& name : parameters_) values.push_back(system_.parameters.at(name).value.front());
  return values;
}

SystemTable FittedScene::table_at(std::span<const double> values) const {
  SystemTable table = table_;
  for (std::size_t j = 0; j < parameters_.size(); ++j)
    std::ranges::find(table.parameters, parameters_[j], &Assignment::name)->values.front().value = values[j];
  return table;
}

FittedScene::Numbers FittedScene::numbers(std::span<const double> values) const {
  System system = system_;
  system.parameters = system_text(table_at(values)).parameters;
  Numbers numbers;
  numbers.relation = read_relation(boundary_, system).relation;
  for (std::size_t k = 0; k < open_.size(); ++k) {
    const int row = numbers.relation.add_row(values[parameters_.size() + k]);
    numbers.relation.add(row, open_[k].e, 1);
  }
  numbers.duration = read_duration(boundary_, system);
  if (problem_.manifold) complete_by_constraints(table_at(values), numbers);
  for (const std::string& name : active_) numbers.active.push_back(system.parameters.at(name).value.front());
  return numbers;
}

/// The other coordinates of the ends follow from the constraints, near the first path.
void FittedScene::complete_by_constraints(const SystemTable& table, Numbers& numbers) const {
  Problem ends = problem_;
  ends.boundary = numbers.relation;
  ends.ends = solve_relation(ends.boundary);
  if (!ends.duration.free) ends.duration.value = numbers.duration.value;
  put_manifold_like(*problem_.manifold, table, make_system(table), ends);
  EndPoints near = near_;
  if (!complete_ends(scene_, near, ends)) refuse_partly_free(scene_, ends);
  // At some points the natural conditions are those on the manifold with these coordinates free as well.
  const int n = problem_.coordinates();
  for (const int e : determined_)
    if (!ends.ends.fixed[e]) ends.boundary.fix(e % n, e >= n, e < n ? near.start[e] : near.end[e - n]);
  numbers.relation = std::move(ends.boundary);
}

/// Everything that may depend on a parameter, but for what closes a duration by a function.
std::vector<double> FittedScene::Numbers::list() const {
  std::vector<double> list = active;
  list.insert(list.end(), relation.value.begin(), relation.value.end());
  list.insert(list.end(), relation.momenta.begin(), relation.momenta.end());
  list.push_back(duration.value);
  list.push_back(duration.energy.value_or(0));
  return list;
}

std::vector<FittedScene::Numbers> FittedScene::around(std::span<const double> values, std::size_t unknown,
                                                      double& step) const {
  step = part * (unknown < parameters_.size() ? size_of(values[unknown]) : size_of_ends(near_));
  std::vector<Numbers> result;
  std::vector<double> moved(values.begin(), values.end());
  for (const double place : places) {
    moved[unknown] = values[unknown] + place * step;
    result.push_back(numbers(moved));
  }
  return result;
}

ObservedFormulas FittedScene::formulas(const SystemTable& table) const {
  ObservedFormulas formulas;
  SystemText text = system_text(table);
  text.hamiltonian.reset();
  text.active = active_;
  for (const Definition& observation : fit_.observe)
    formulas.push_back(placed(observation.formula, [&](const std::string& formula) {
      text.lagrangian = formula;
      return compile(text).lagrangian;
    }));
  return formulas;
}

Problem FittedScene::inner_problem(const Numbers& numbers, const SystemTable& table,
                                   const std::vector<std::string>& active) const {
  Problem inner = problem_;
  const System system = make_system(table, active);
  inner.lagrangian = system.lagrangian;
  inner.copies = system.copies;
  if (problem_.manifold) constrain_like(*problem_.manifold, table, system, inner, active);
  inner.pair = nullptr;
  inner.boundary = numbers.relation;
  inner.ends = solve_relation(inner.boundary);
  const double value = inner.duration.value;
  inner.duration = numbers.duration;
  if (inner.duration.free) inner.duration.value = value;
  return inner;
}

FittedProblem FittedScene::at(std::span<const double> values) const {
  const SystemTable table = table_at(values);
  const Numbers numbers = this->numbers(values);
  const Problem inner = inner_problem(numbers, table, active_);
  FittedProblem result;
  for (std::size_t j = 0; j < values.size(); ++j) result.changes.push_back(change(values, inner, j));
  result.problem = inner;
  result.curved = inner.manifold && !open_.empty();
  if (inner.copies) {
    result.problem = pair_of(inner);
    result.problem.symmetries = problem_.pair->symmetries;
  }
  result.formulas = formulas(table);
  return result;
}

/// The scene with these values; open ends are given.
Scene FittedScene::scene_at(std::span<const double> values) const {
  Scene scene = scene_;
  scene.fit.reset();
  scene.system = table_at(values);
  for (std::size_t k = 0; k < open_.size(); ++k) {
    const int n = problem_.coordinates(), e = open_[k].e;
    const double value = values[parameters_.size() + k];
    const Location& at = boundary_.at;
    if (!boundary_.conditions.empty())
      scene.boundary.conditions.push_back({fmt::format("{} = {:.17g}", open_[k].name, value), at});
    else
      (e < n ? scene.boundary.start : scene.boundary.end)
          .push_back({system_.names[e % n], at, {{value, at}}, false, at});
  }
  return scene;
}

Problem FittedScene::problem(std::span<const double> values, const Guess& guess, double duration) const {
  if (made_anew_) {
    Problem problem = load_(scene_at(values), guess, duration);
    problem.reduction = nullptr;
    return problem;
  }
  Problem problem = inner_problem(numbers(values), table_at(values), {});
  problem.guess = guess;
  if (problem.duration.free) problem.duration.value = duration;
  if (problem.manifold) project_guess(scene_, near_, problem);
  problem = make_problem(std::move(problem));
  // Data may be those of another member of the family than one with a symmetry.
  problem.reduction = nullptr;
  return problem;
}

void FittedScene::put_relation_change(const Problem& inner, BoundaryRelation by,
                                      ProblemChange& change) const {
  if (!inner.copies) {
    change.ends = solve_relation(by).offset;
    change.momenta = std::move(by.momenta);
    return;
  }
  Problem moved = inner;
  moved.boundary = std::move(by);
  const Problem pair = pair_of(moved);
  change.ends = pair.ends.offset;
  change.momenta = pair.boundary.momenta;
}

ProblemChange FittedScene::change(std::span<const double> values, const Problem& inner,
                                  std::size_t unknown) const {
  ProblemChange result;
  result.parameters.assign(active_.size(), 0);
  BoundaryRelation by = inner.boundary;
  std::ranges::fill(by.value, 0.0);
  std::ranges::fill(by.momenta, 0.0);
  if (unknown >= parameters_.size() && !inner.manifold) {
    by.value[by.rows - open_.size() + unknown - parameters_.size()] = 1;
    put_relation_change(inner, std::move(by), result);
    return result;
  }
  const bool parameter = unknown < parameters_.size();
  if (parameter) result.parameters[unknown] = 1;
  if (boundary_depends_ || active_.size() > parameters_.size() || inner.manifold) {
    double step = 0;
    const std::vector<Numbers> numbers = around(values, unknown, step);
    std::vector<double> slopes(numbers.front().list().size(), 0);
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!same_matrix(numbers[k].relation.matrix, inner.boundary.matrix))
        throw SceneError(boundary_.at,
                         "constraints determine other coordinates of the ends for parameters nearby");
      const std::vector<double> list = numbers[k].list();
      for (std::size_t i = 0; i < list.size(); ++i) slopes[i] += quotient_weights[k] * list[i] / step;
    }
    auto next = slopes.begin();
    const auto take = [&](std::vector<double>& to) {
      for (double& x : to) x = *next++;
    };
    take(result.parameters);
    std::fill_n(result.parameters.begin(), parameters_.size(), 0.0);
    if (parameter) result.parameters[unknown] = 1;
    take(by.value);
    take(by.momenta);
    if (!inner.duration.free) result.duration = *next;
    ++next;
    result.energy = *next;
    if (inner.duration.where && boundary_depends_) {
      const std::size_t n = inner.coordinates();
      result.where = [numbers, step, n](std::span<const double> start, std::span<const double> end) {
        std::vector<double> gradient(2 * n);
        double slope = 0;
        for (std::size_t k = 0; k < places.size(); ++k)
          slope +=
              quotient_weights[k] * numbers[k].duration.where(start.first(n), end.first(n), gradient) / step;
        return slope;
      };
    }
  }
  put_relation_change(inner, std::move(by), result);
  return result;
}

}  // namespace extremal
