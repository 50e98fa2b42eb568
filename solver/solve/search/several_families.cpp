#include <algorithm>
#include <memory>

#include "solve/homotopy/duration_homotopy.hpp"
#include "solve/homotopy/end_homotopy.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/several.hpp"

/// \file Other extremals along the families of those found.

namespace extremal {

using namespace limits::several;

/// Makes the path a solution, on the elements of a family.
void Several::load(const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  const std::size_t n = trajectory.coordinates;
  const ElementTables& tables = w_.levels.at(family_degree);
  std::vector<double> mesh;
  for (double t : trajectory.times) mesh.push_back(t / trajectory.duration());
  path_.reset(tables, mesh, trajectory.duration());
  std::vector<double> q((family_degree + 1) * n), v(n);
  for (int k = 0; k < trajectory.elements(); ++k) {
    const double from = trajectory.times[k], h = trajectory.times[k + 1] - from;
    for (int j = 0; j <= family_degree; ++j)
      trajectory.at(std::min(from + tables.scheme().lobatto[j] * h, trajectory.duration()),
                    {q.data() + j * n, n}, v);
    path_.set_element(k, q.data());
  }
  path_.load_ends();
}

/// The family number 0 is that of other durations, the next those of other values in each row of the boundary
/// relation. From the extremal that the path is; null if it cannot be left.
std::unique_ptr<Homotopy> Several::leave(int family, bool onward) {
  const auto count = [this] { return pursuit_.count_step(); };
  const ElementTables& tables = w_.levels.at(family_degree);
  if (family == 0) {
    auto curve = std::make_unique<DurationHomotopy>(problem_, path_, w_, count);
    if (curve->leave(tables, onward)) return curve;
  } else {
    const double extent = scales(path_, tables).q;
    auto curve = std::make_unique<EndHomotopy>(problem_, path_, w_, count,
                                               unit_displacement(problem_.boundary, family - 1), extent);
    if (curve->leave(tables, onward)) return curve;
  }
  return nullptr;
}

/// All extremals that the family comes by, both ways; of those it need not be traced again.
void Several::trace_family(std::size_t solution, int family) {
  const char* strategy =
      family == 0 ? "family of extremals of other durations" : "family of extremals with other ends";
  for (bool onward : {false, true}) {
    load(found_[solution]);
    const std::unique_ptr<Homotopy> curve = leave(family, onward);
    for (int met = 0; curve && wanted() && curve->reach(); ++met) {
      const int number = refine_and_keep(w_.levels.at(family_degree), strategy);
      if (number >= 0) traced_[number][family] = 1;
      if (number == static_cast<int>(solution) && met > 0) return;  // a closed curve
      curve->resume();
    }
  }
}

/// The next family of the first extremal that has one; false if all have been traced.
bool Several::trace_families() {
  const bool durations = !problem_.duration.free && problem_.lagrangian->structure().autonomous;
  for (int family = durations ? 0 : 1; family < families_; ++family)
    for (std::size_t k = 0; k < found_.size(); ++k)
      if (!traced_[k][family]) {
        traced_[k][family] = 1;
        ++traced_count_;
        trace_family(k, family);
        return true;
      }
  return false;
}

}  // namespace extremal
