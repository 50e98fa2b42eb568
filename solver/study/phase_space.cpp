#include "study/phase_space.hpp"

#include <fmt/format.h>

#include <string>

#include "action/scheme.hpp"
#include "solve/adapt/options.hpp"

namespace extremal {

namespace {

[[noreturn]] void refuse_phase_space(const Location& at, const std::string& what) {
  throw SceneError(at,
                   "the second derivative of the Hamiltonian by the momenta is singular or changes its "
                   "signature: " +
                       what);
}

/// Rectangles have q and p at different ends of elements, whose length must be known.
void check_scheme_of_phase_space(const Scene& scene, Purpose purpose) {
  const Scheme named = scheme(scene.solve.scheme->value);
  const Location at = position(*scene.solve.scheme, 0);
  if (suits_phase_space(named)) return;
  const bool rectangle = named.quadrature == Quadrature::left || named.quadrature == Quadrature::right;
  if (!rectangle)
    refuse_phase_space(
        at, fmt::format("'{}' has more points in an element than its degree, so that q' cannot equal the "
                        "derivative of H at all of them; use midpoint or gauss(s), or a rectangle",
                        named.name));
  const bool family = scene.continuation && purpose == Purpose::family;
  if (!scene.solve.elements || scene.boundary.free || scene.boundary.periodic || family)
    refuse_phase_space(
        at, fmt::format("'{}' is then available with 'elements', a duration that is a number, and "
                        "ends that are not periodic, and not for families; use midpoint or gauss(s)",
                        named.name));
}

}  // namespace

void check_phase_space(const Scene& scene, const ExtendedScene& parts, Purpose purpose) {
  const auto& refuse = refuse_phase_space;
  if (parts.extended)
    refuse(
        scene.boundary.at,
        "nonlinear conditions and waypoints are not available with it; give coordinates or momenta at both "
        "ends");
  if (scene.boundary.infinite)
    refuse(scene.boundary.at, "an end at infinity is not available with it; give a duration");
  if (scene.search)
    refuse(scene.search->solutions.at,
           "[search] is not available with it; leave it out, and give a guess for each solution");
  if (scene.fit) refuse(scene.fit->data.at, "[fit] is not available with it; leave it out");
  if (scene.solve.method && scene.solve.method->value != name(Method::newton))
    refuse(position(*scene.solve.method, 0), "leave 'method' out: Newton's method solves it");
  if (scene.solve.scheme) check_scheme_of_phase_space(scene, purpose);
}

}  // namespace extremal
