#include "action/element.hpp"

#include "machine/simd.hpp"

namespace extremal {

namespace base {
extern const ElementKernels element_kernels;
}
namespace v3 {
extern const ElementKernels element_kernels;
}
namespace v4 {
extern const ElementKernels element_kernels;
}

const ElementKernels& element_kernels() {
  switch (simd_level()) {
    case SimdLevel::base:
      return base::element_kernels;
    case SimdLevel::v3:
      return v3::element_kernels;
    default:
      return v4::element_kernels;
  }
}

}  // namespace extremal
