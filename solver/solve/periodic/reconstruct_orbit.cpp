#include "solve/periodic/reconstruct_orbit.hpp"

#include <vector>

namespace extremal {

void reconstruct_orbit(const Reduction& reduction, const Path& part, const ElementTables& tables,
                       Path& whole) {
  const int count = part.elements(), parts = reduction.parts();
  const auto backwards = [&](int i) { return reduction.mirror && i % 2 == 1; };
  std::vector<double> mesh{0}, lengths;
  for (int i = 0; i < parts; ++i)
    for (int k = 1; k <= count; ++k) {
      mesh.push_back((i + (backwards(i) ? 1 - part.mesh()[count - k] : part.mesh()[k])) / parts);
      lengths.push_back(part.lengths()[backwards(i) ? count - k : k - 1] / parts);
    }
  whole.reset(tables, mesh, parts * part.duration(), lengths);
  // In turn M^k on [k, k + 1/2] T/turns and M^k M S backwards on the rest, or M^k on all of it.
  SignedPermutation turns = SignedPermutation::identity(part.coordinates());
  for (int i = 0; i < parts; ++i) {
    const SignedPermutation map = backwards(i) ? turns * *reduction.mirror : turns;
    for (int k = 0; k < count; ++k)
      whole.set_image(i * count + k, part, backwards(i) ? count - 1 - k : k, map, backwards(i));
    if (backwards(i) || !reduction.mirror) turns = turns * reduction.turn;
  }
  whole.load_ends();
}

}  // namespace extremal
