#include "solve/mesh/levels.hpp"

namespace extremal {

void Levels::bind(std::shared_ptr<const Lagrangian> lagrangian) {
  if (lagrangian == lagrangian_) return;
  if (lagrangian_ && uses_gauss(*lagrangian_) != uses_gauss(*lagrangian))
    for (auto& level : levels_) level.reset();
  lagrangian_ = std::move(lagrangian);
  for (Ladder* ladder : {&levels_, &finer_})
    for (auto& level : *ladder)
      if (level) level->bound = false;
}

const ElementTables& Levels::bound(Level& level) {
  if (!level.bound) {
    level.tables.bind(*level.scheme, *lagrangian_);
    level.tables.end_at(lagrangian_->kinks());
    level.bound = true;
  }
  return level.tables;
}

const ElementTables& Levels::at(int degree) {
  auto& level = levels_[degree];
  if (!level) level = std::make_unique<Level>(Level{.scheme = &SchemeTables::of_order(degree, *lagrangian_)});
  return bound(*level);
}

const ElementTables& Levels::finer(const SchemeTables& rule) {
  auto& level = finer_[rule.degree];
  const int points = rule.points + rule.degree;
  if (!level || level->scheme->points != points) {
    Scheme scheme = gauss(rule.degree);
    scheme.points = points;
    auto own = std::make_unique<SchemeTables>(scheme);
    const SchemeTables* const tables = own.get();
    level = std::make_unique<Level>(Level{.scheme = tables, .own = std::move(own)});
  }
  return bound(*level);
}

const std::vector<double>& Levels::raise(int from, int to) {
  std::vector<double>& matrix = raise_[from * (max_degree + 1) + to];
  if (matrix.empty()) matrix = interpolation_matrix(from, lobatto_barycentric(to).nodes);
  return matrix;
}

const std::vector<double>& Levels::halve(int degree) {
  std::vector<double>& matrix = halve_[degree];
  if (matrix.empty()) {
    const std::vector<double>& nodes = lobatto_barycentric(degree).nodes;
    std::vector<double> points;
    for (int j = 0; j < degree; ++j) points.push_back(0.5 * nodes[j]);
    for (int j = 0; j <= degree; ++j) points.push_back(0.5 + 0.5 * nodes[j]);
    matrix = interpolation_matrix(degree, points);
  }
  return matrix;
}

}  // namespace extremal
