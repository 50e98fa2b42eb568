#include "solve/search/deflation.hpp"

#include <algorithm>
#include <cmath>

#include "solve/mesh/resolution.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::deflation;

DeflatedNewton::DeflatedNewton(const Problem& problem, Path& path, Workspace& workspace,
                               std::function<bool()> count)
    : problem_(problem), path_(path), w_(workspace), count_(std::move(count)) {}

/// Where the known extremals are at the nodes of the path.
void DeflatedNewton::sample(const std::vector<Solution>& known) {
  const std::size_t n = problem_.coordinates();
  std::vector<double> v(n);
  known_.clear();
  for (const Solution& solution : known) {
    Known each{std::vector<double>(path_.nodes().size()), solution.duration()};
    for (std::size_t k = 0; k < path_.mesh().size(); ++k)
      solution.trajectory.at(path_.mesh()[k] * each.duration, {each.nodes.data() + k * n, n}, v);
    known_.push_back(std::move(each));
  }
}

double DeflatedNewton::dot(const std::vector<double>& nodes, const std::vector<double>& others) const {
  double sum = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) sum += nodes[k] * others[k];
  return sum / (scale_ * scale_ * static_cast<double>(nodes.size()));
}

/// τ. With r² = |x − x_i|² the gradient of log(1/r² + 1) is −2 (x − x_i)/(r² (1 + r²)).
double DeflatedNewton::stretch(const Step& step) {
  const double unit = path_.duration();
  double slope = 0;
  for (const Known& each : known_) {
    away_.assign(path_.nodes().begin(), path_.nodes().end());
    for (std::size_t k = 0; k < away_.size(); ++k) away_[k] -= each.nodes[k];
    const double longer = (path_.duration() - each.duration) / unit;
    const double square = dot(away_, away_) + longer * longer;
    if (square == 0) continue;
    slope -= 2 * (dot(away_, step.nodes) + longer * step.duration / unit) / (square * (1 + square));
  }
  return slope == 1 ? INFINITY : 1 / (1 - slope);
}

/// To where the plain step is short.
bool DeflatedNewton::run(const ElementTables& tables, const std::vector<Solution>& known) {
  sample(known);
  w_.iteration.reset(problem_, tables, path_.elements());
  const double first = scale_ = scales(path_, tables).q;
  if (scale_ == 0) scale_ = 1;
  const auto take = [&](bool solved) {
    if (!solved) return Progress::failed;
    const double duration = path_.duration();
    const double size = std::hypot(std::sqrt(dot(step_.nodes, step_.nodes)), step_.duration / duration);
    if (!std::isfinite(size)) return Progress::failed;
    if (size == 0) return Progress::arrived;
    const double factor = stretch(step_), allowed = longest / size;
    if (std::abs(factor) * size < short_step && size < short_step) return Progress::arrived;
    const double taken = std::clamp(factor, -allowed, allowed);
    if (!(duration + taken * step_.duration > 0)) return Progress::failed;
    path_.add(step_.nodes, step_.inner, taken);
    if (step_.duration != 0) path_.set_duration(duration + taken * step_.duration);
    path_.load_ends();
    scale_ = std::max(scale_, scales(path_, tables).q);
    return first > 0 && scale_ > runaway * first ? Progress::failed : Progress::more;
  };
  return newton_loop([this](Factors) { return solve(); }, most_steps, take) == Progress::arrived;
}

bool DeflatedNewton::solve() {
  if (!count_() || !w_.iteration.factor_quickly(path_)) return false;
  w_.iteration.model().solve(w_.iteration.action(), w_.iteration.closing(path_), step_);
  return true;
}

}  // namespace extremal
