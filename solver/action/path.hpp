#pragma once

#include <span>
#include <vector>

#include "action/tables.hpp"
#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "problem/signed_permutation.hpp"

/// \file The unknown: a piecewise polynomial path on a mesh, laid out for the kernels.

namespace extremal {

/// Values at the nodes between elements are kept as unevaluated sums high + low, so that the difference of
/// neighbours, and with it the momentum, is exact to roundoff of the difference. Inner unknowns are the
/// deviations from the chord, batch by batch with one element in each lane; idle lanes of the last batch copy
/// the last element.
class Path {
 public:
  /// N = mesh.size() − 1 elements over `mesh` (t/T, 0 to 1), all zero, of `lengths` if they are known to more
  /// digits than differences of the mesh. Keeps memory.
  void reset(const ElementTables& tables, std::span<const double> mesh, double duration,
             std::span<const double> lengths = {});

  int coordinates() const { return n_; }
  int degree() const { return degree_; }
  int elements() const { return elements_; }
  int batches() const { return batches_; }
  int lanes() const { return lanes_; }  ///< elements of a batch
  double duration() const { return duration_; }
  std::span<const double> mesh() const { return mesh_; }
  std::span<const double> lengths() const { return lengths_; }  ///< N, in t/T

  /// Sets the values at the s + 1 Lobatto nodes of element k from q[(j)*n + a].
  void set_element(int k, const double* q);
  /// The same in the lanes alone, so that it need not meet its neighbours; not after load_ends().
  void set_apart(int k, const double* q);
  /// Element k becomes the image under `map` of element j of `other`, which is of the same degree, or of that
  /// run backwards. Exact; load_ends() is to follow.
  void set_image(int k, const Path& other, int j, const SignedPermutation& map, bool backwards);
  void set_duration(double duration);
  /// Mesh nodes move by factor·times (in τ), inner nodes stay where they are in their elements, and all
  /// values are kept. False, and nothing is done, if an element shrank to less than `least` of its length.
  bool move_mesh(std::span<const double> times, double factor, double least);

  /// Mesh nodes move by `shift` (N + 1, in τ, nothing at the ends) along the path. It is smooth at nodes that
  /// are not in `kinks` (N + 1); a piece between two kinks goes on by the polynomial of its last element, and
  /// where two meet their values are averaged. False, and nothing is done, if an element's length changed by
  /// more than the factor `most`, or a piece went on far beyond its end.
  bool slide(std::span<const double> shift, double most, std::span<const int> kinks);
  /// The same with a kink at each node.
  bool slide(std::span<const double> shift, double most) {
    return slide(shift, most, std::vector<int>(shift.size(), 1));
  }

  /// q at mesh node k (n entries), rounded to double.
  const double* node(int k) const { return high_.data() + static_cast<std::size_t>(k) * n_; }
  /// What rounding left of it.
  const double* rest(int k) const { return low_.data() + static_cast<std::size_t>(k) * n_; }
  std::span<const double> nodes() const { return high_; }  ///< (N + 1) × n
  void set_node(int k, int a, double high, double low = 0);

  /// x += factor·step, with nodes' steps (N + 1) × n and inner steps in lanes as x() is laid out.
  void add(std::span<const double> node_step, const AlignedDoubles& inner_step, double factor);

  /// The values alone, of a path on the same discretisation.
  void copy_values(const Path& other);

  /// Copies the nodes into the lanes (q_a and Δ); after any change of them.
  void load_ends();

  /// Lanes: x(batch)[(J*n + a)*lanes + lane], J inner, then q_a, then Δ.
  const double* x(int batch) const {
    return x_.data() + static_cast<std::size_t>(batch) * unknowns_ * lanes_;
  }
  double* x(int batch) { return x_.data() + static_cast<std::size_t>(batch) * unknowns_ * lanes_; }
  const double* h(int batch) const { return h_.data() + static_cast<std::size_t>(batch) * lanes_; }
  const double* start(int batch) const { return start_.data() + static_cast<std::size_t>(batch) * lanes_; }

  /// The same path in elements of another degree (exact where it is raised), same mesh.
  /// `matrix` is interpolation_matrix(degree(), Lobatto nodes of the new degree).
  void interpolate_from(const Path& other, const ElementTables& tables, std::span<const double> matrix);

  /// The same path on a mesh with every element halved. `halves` takes Lobatto(s) nodal values to the 2s + 1
  /// Lobatto nodes of the two halves.
  void split_from(const Path& other, const ElementTables& tables, std::span<const double> halves);

  /// The same path on another mesh with other elements, as near as those come: through its values at their
  /// nodes.
  void resample_from(const Path& other, const ElementTables& tables, std::span<const double> mesh);

  /// q at the s + 1 Lobatto nodes of element k.
  void element(int k, double* q) const;
  /// q' there. `derivative` is that of lobatto_basis(degree(), Lobatto nodes).
  void element_slopes(int k, std::span<const double> derivative, double* v) const;

 private:
  void values(int k, int count, const double* tau, double* q) const;
  bool goes_on(std::span<const int> kinks, int& k, double& tau) const;
  void measure_mesh();
  void set_inner(int k, const double* q);
  void repeat_last();

  int lanes_ = simd_lanes();
  int n_ = 0, degree_ = 0, elements_ = 0, batches_ = 0, unknowns_ = 0;
  double duration_ = 0;
  std::vector<double> mesh_, lengths_, high_, low_, lobatto_;
  AlignedDoubles x_, h_, start_;
};

}  // namespace extremal
