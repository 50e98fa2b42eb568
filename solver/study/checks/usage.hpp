#pragma once

#include "scene/scene.hpp"
#include "study/model/naming.hpp"

/// \file Whether what a scene gives has an effect.

namespace extremal {

/// Throws UnknownName at a parameter, written in the scene or by --set, that no formula of the scene or of
/// its system names, and that is not continued. Parameters of a system file are not the scene's.
void check_parameters_used(const Scene& scene);

/// What `read` makes of the scene, checked so. Its errors of names and formulas are told first, and
/// parameters that nothing uses before its others, which may follow from them.
template <class Read>
auto with_parameters_used(const Scene& scene, const Read& read) {
  try {
    auto result = read();
    check_parameters_used(scene);
    return result;
  } catch (const FaultyFormula&) {
    throw;
  } catch (const UnknownName&) {
    throw;
  } catch (const SceneError&) {
    check_parameters_used(scene);
    throw;
  }
}

}  // namespace extremal
