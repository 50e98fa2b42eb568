#include "systems.hpp"

#include "scene/systems.hpp"
#include "study/model/modelling.hpp"

namespace bench {

std::shared_ptr<const extremal::Lagrangian> system(const std::string& name,
                                                   const std::map<std::string, double>& parameters) {
  extremal::SystemTable table = extremal::read_system({name, {}}, "");
  for (extremal::Assignment& p : table.parameters)
    if (const auto changed = parameters.find(p.name); changed != parameters.end())
      p.values.at(0).value = changed->second;
  return extremal::make_system(table).lagrangian;
}

extremal::Problem fixed_ends(const std::shared_ptr<const extremal::Lagrangian>& lagrangian,
                             const std::vector<double>& start, const std::vector<double>& end,
                             double duration) {
  extremal::Problem problem;
  problem.lagrangian = lagrangian;
  problem.boundary.coordinates = static_cast<int>(start.size());
  for (int a = 0; a < problem.coordinates(); ++a) {
    problem.boundary.fix(a, false, start[a]);
    problem.boundary.fix(a, true, end[a]);
  }
  problem.duration.value = duration;
  return make_problem(std::move(problem));
}

}  // namespace bench
