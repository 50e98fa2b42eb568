#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/systems.hpp"
#include "study/checks/derivatives.hpp"
#include "study/study.hpp"

/// \file What was found in a scene, and what there is to write in one.

namespace extremal {

/// The structure of L = ½ q'ᵀMq' + q'ᵀCq + aᵀq' + R and the tapes of R.
struct Inspection {
  bool autonomous = true;
  bool quadratic = false;      ///< M, C, a are constant
  bool velocity_free = false;  ///< R does not depend on q'
  int mass_entries = 0, gyroscopic_entries = 0;
  int qq = 0, vq = 0, vv = 0;   ///< Hessian entries of R in (q, q), (q', q), (q', q'), lower triangle
  bool momenta_solved = false;  ///< of a Hamiltonian, at each point; the tapes are then those of H
  int kinks = 0;                ///< surfaces on which L is not smooth
  struct Tape {
    std::string order;  ///< "value", "gradient", "Hessian"
    int kernels = 0, instructions = 0;
    long long played = 0;  ///< instructions a point, over all rows of sums
  };
  std::vector<Tape> tapes;  ///< none for a Lagrangian that is not a tape
  DerivativeCheck derivatives;
  std::vector<std::string> unknowns = {}, waypoints = {};  ///< of the problem, as text
  bool forces_autonomous = true;                           ///< forces, if there are any, do not depend on t
  std::optional<DerivativeCheck> with_forces = {};  ///< of the Lagrangian of two copies of the coordinates
};
Inspection inspect(const Study& study);

/// A name that a scene may use, and what it means.
struct CatalogueEntry {
  std::string name, help;
};
struct Catalogue {
  std::vector<CatalogueEntry> systems, schemes, methods;
};
/// System files, schemes and methods from their own records.
Catalogue catalogue();

/// One system file, whose name was given to `command`. Throws SceneError for an unknown name, with what lists
/// the names, and the system or scene that may be meant.
SystemDescription describe(const std::string& system, const std::string& command);

/// A scene of the library that exists, as an example: its path, or "scene.toml" where no library is found.
std::string example_scene();

}  // namespace extremal
