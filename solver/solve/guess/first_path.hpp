#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file The guess as a path.

namespace extremal {

/// Fills `path` (already reset) from the guess, shifted linearly in t so that its ends are `ends`.
void start_path(const Problem& problem, const std::vector<double>& ends, const ElementTables& tables,
                Path& path);

/// Whether a path of the largest |q| `magnitude` has run away from a guess of `first`, where the ends let it:
/// to where forces vanish, most likely.
bool ran_away(const Problem& problem, double first, double magnitude);

/// Replaces the values q of `path` (already reset) by what at(τ, q) makes of them, and sets those at the ends
/// to `ends`.
template <class At>
void fill_path(const std::vector<double>& ends, const ElementTables& tables, Path& path, const At& at) {
  const std::size_t n = path.coordinates();
  const int degree = path.degree();
  std::vector<double> q((degree + 1) * n), next(q.size());
  path.element(0, next.data());
  for (int k = 0; k < path.elements(); ++k) {
    q.swap(next);
    // An element is kept by deviations from its chord: it is read before its first node moves.
    if (k + 1 < path.elements()) path.element(k + 1, next.data());
    const double from = path.mesh()[k], to = path.mesh()[k + 1];
    // The first node of an element is already where the one before left it.
    for (int j = k > 0; j <= degree; ++j)
      at(j == degree ? to : from + tables.scheme().lobatto[j] * (to - from), q.data() + j * n);
    path.set_element(k, q.data());
    std::copy_n(q.end() - static_cast<std::ptrdiff_t>(n), n, next.begin());
  }
  for (std::size_t a = 0; a < n; ++a) {
    path.set_node(0, static_cast<int>(a), ends[a]);
    path.set_node(path.elements(), static_cast<int>(a), ends[n + a]);
  }
  path.load_ends();
}

/// An arc of a circle about `centre` in the plane of it and the ends, through the angle between those and so
/// many turns more; its radius is the mean distance of the ends from the centre, times 1 + `excess`. With one
/// coordinate there is no plane.
struct Arc {
  std::vector<double> centre;
  int turns = 0;
  double excess = 0;
};
/// Fills `path` with it. Returns the difference of its ends from `ends` (2n).
std::vector<double> arc_path(const Arc& arc, const std::vector<double>& ends, const ElementTables& tables,
                             Path& path);

/// Numbers in [-1, 1], the same for the same seed.
class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed + 1) { random_.discard(3); }
  double operator()() { return 2.0 * random_() / std::minstd_rand::max() - 1; }

 private:
  std::minstd_rand random_;
};

/// Smooth deterministic noise, the same for the same seed: Σ_m c_m sin(mπ t/T), the ends at rest.
struct Bend {
  double size = 0;  ///< of each coordinate, in units of its extent
  unsigned seed = 0;
  int modes = 3;
};
/// Paths of a periodic problem stay closed: by noise as in ClosedNoise, with their ends.
void bend_path(const Problem& problem, const Bend& bend, const ElementTables& tables, Path& path);

/// The second of two copies of the coordinates becomes the first.
void make_agree(Path& path);

/// Of the largest extent. Every other seed takes coordinates to be of one kind: a line has no extent across.
inline constexpr double negligible_extent[] = {0.01, 0.5};
/// Of each coordinate: its range, or its largest absolute value if that is more; where that is next to
/// nothing, that of the coordinate which has most.
std::vector<double> extents(const Path& path, double negligible);

}  // namespace extremal
