#include "action/element.hpp"

#include "action/elimination.hpp"
#include "machine/simd.hpp"

namespace extremal {

const Assembly& assembly() {
  static const Assembly chosen = at_simd_level(EXTREMAL_AT_EACH_LEVEL(assembly_kernels))();
  return chosen;
}

const Elimination& elimination() {
  static const Elimination chosen = at_simd_level(EXTREMAL_AT_EACH_LEVEL(elimination_kernels))();
  return chosen;
}

}  // namespace extremal
