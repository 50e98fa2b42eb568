#include "linear/supernodes.hpp"

#include <cholmod.h>

#include <algorithm>
#include <memory>
#include <new>

namespace extremal {

namespace {

struct Common : cholmod_common {
  Common() {
    cholmod_start(this);
    print = 0;
    error_handler = nullptr;
    supernodal = CHOLMOD_SUPERNODAL;
    nmethods = 1;
    method[0].ordering = CHOLMOD_AMD;
    postorder = 1;
  }
  ~Common() { cholmod_finish(this); }
  Common(const Common&) = delete;
};

}  // namespace

Supernodes find_supernodes(const SparsePattern& lower, int most) {
  Supernodes result;
  const int n = int(lower.begin.size()) - 1;
  result.first.push_back(0);
  result.row_begin.push_back(0);
  if (n == 0) return result;
  Common common;
  cholmod_sparse matrix = {};
  matrix.nrow = matrix.ncol = n;
  matrix.nzmax = lower.row.size();
  matrix.p = const_cast<int*>(lower.begin.data());  // only read
  matrix.i = const_cast<int*>(lower.row.data());
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_PATTERN;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;
  const auto free = [&](cholmod_factor* f) { cholmod_free_factor(&f, &common); };
  const std::unique_ptr<cholmod_factor, decltype(free)> factor(cholmod_analyze(&matrix, &common), free);
  if (!factor || !factor->is_super) throw std::bad_alloc();
  const int *const order = static_cast<int*>(factor->Perm), *const super = static_cast<int*>(factor->super),
                   *const begin = static_cast<int*>(factor->pi), *const row = static_cast<int*>(factor->s);
  result.order.assign(order, order + n);
  std::vector<int> first_part;  // of each supernode, before it was divided
  for (std::size_t s = 0; s < factor->nsuper; ++s) {
    std::vector<int> rows(row + begin[s], row + begin[s + 1]);
    std::sort(rows.begin(), rows.end());
    first_part.push_back(result.count());
    for (int from = super[s]; from < super[s + 1]; from += most) {
      const int end = std::min(from + most, super[s + 1]);
      result.first.push_back(end);
      result.row.insert(result.row.end(), rows.begin() + (end - super[s]), rows.end());
      result.row_begin.push_back(int(result.row.size()));
    }
  }
  // The parts of a divided supernode follow each other; its children belong to the first, so that parents
  // come in the order in which a stack gives back what children left on it.
  first_part.push_back(result.count());
  for (std::size_t s = 0; s < factor->nsuper; ++s) {
    for (int part = first_part[s]; part + 1 < first_part[s + 1]; ++part) result.parent.push_back(part + 1);
    const int last = first_part[s + 1] - 1, next = result.row_begin[last];
    const int* const holder = next < result.row_begin[last + 1]
                                  ? std::upper_bound(super, super + factor->nsuper, result.row[next])
                                  : super;
    result.parent.push_back(holder == super ? -1 : first_part[holder - super - 1]);
  }
  return result;
}

}  // namespace extremal
