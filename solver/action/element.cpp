#include "action/element.hpp"

#include "action/elimination.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace base {
extern const Assembly assembly;
extern const Elimination elimination;
}  // namespace base
namespace v3 {
extern const Assembly assembly;
extern const Elimination elimination;
}  // namespace v3
namespace v4 {
extern const Assembly assembly;
extern const Elimination elimination;
}  // namespace v4

const Assembly& assembly() {
  switch (simd_level()) {
    case SimdLevel::base:
      return base::assembly;
    case SimdLevel::v3:
      return v3::assembly;
    default:
      return v4::assembly;
  }
}

const Elimination& elimination() {
  switch (simd_level()) {
    case SimdLevel::base:
      return base::elimination;
    case SimdLevel::v3:
      return v3::elimination;
    default:
      return v4::elimination;
  }
}

}  // namespace extremal
