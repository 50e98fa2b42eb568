#include "shooting.hpp"

#include "chain.hpp"
#include "newton.hpp"
#include "systems.hpp"

namespace bench::shooting {
namespace {

/// Calls `use` with the system itself.
template <class Use>
auto with_system(const SystemChoice& choice, const Use& use) {
  const double* const p = choice.parameters.data();
  switch (choice.name) {
    case SystemName::pendulum:
      return use(Pendulum(p));
    case SystemName::kepler:
      return use(Kepler(p));
    case SystemName::henon_heiles:
      return use(HenonHeiles(p));
    case SystemName::double_pendulum:
      return use(DoublePendulum(p));
    case SystemName::restricted_three_body:
      return use(RestrictedThreeBody(p));
    default:
      return use(Chain(choice.coordinates, p));
  }
}

template <class System>
std::unique_ptr<Shooter> shooter(const System& system, const BoundaryProblem& problem,
                                 const Setting& setting) {
  return std::make_unique<NewtonShooter<System, false>>(system, problem, setting);
}

/// Here the duration may be free.
std::unique_ptr<Shooter> shooter(const RestrictedThreeBody& system, const BoundaryProblem& problem,
                                 const Setting& setting) {
  if (!problem.free_duration) return shooter<RestrictedThreeBody>(system, problem, setting);
  return std::make_unique<NewtonShooter<RestrictedThreeBody, true>>(system, problem, setting);
}

}  // namespace

std::unique_ptr<Shooter> make_shooter(const SystemChoice& choice, const BoundaryProblem& problem,
                                      const Setting& setting) {
  return with_system(choice, [&](const auto& system) { return shooter(system, problem, setting); });
}

std::vector<double> acceleration(const SystemChoice& choice, std::span<const double> q,
                                 std::span<const double> v) {
  std::vector<double> result(q.size());
  with_system(choice,
              [&](const auto& system) { system.acceleration(q.data(), v.data(), result.data(), nullptr); });
  return result;
}

}  // namespace bench::shooting
