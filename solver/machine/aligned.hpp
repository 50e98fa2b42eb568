#pragma once

#include <cstddef>
#include <new>
#include <vector>

/// \file Memory for kernels: groups of `lanes` doubles start at multiples of 64 bytes.

namespace extremal {

template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t(64)));
  }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(64)); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

using AlignedDoubles = std::vector<double, AlignedAllocator<double>>;

}  // namespace extremal
