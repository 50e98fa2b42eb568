#pragma once

#include <span>
#include <vector>

/// \file Meshes over τ = t/T in [0, 1], as many elements as asked, short where they should be.

namespace extremal {

/// A positive density of elements, piecewise linear in τ. Keeps memory.
class Density {
 public:
  void clear();
  /// Ascending τ; a value not above the last is left out.
  void add(double tau, double value);

  bool empty() const { return tau_.empty(); }
  double last() const { return value_.back(); }
  double integral() const { return sum_; }

  /// Longest against shortest element of mesh(·, floor), at most.
  double grading(double floor) const;

  /// Elements of equal ∫(density + floor·mean density) dτ.
  std::vector<double> mesh(int elements, double floor) const;

 private:
  std::vector<double> tau_, value_;
  double sum_ = 0, least_ = 0, most_ = 0;
};

std::vector<double> uniform_mesh(int elements);
std::vector<double> halved(const std::vector<double>& mesh);
/// Elements are halved until none is longer than `ratio` times one beside it, a ratio of 2 or more.
std::vector<double> graded(std::vector<double> mesh, double ratio);

/// A mesh that has these times, ascending in (0, 1), as nodes: nodes that are near one, by the length of the
/// elements there, give way to it. Between two of them there is another node: two crossings of a surface that
/// follow each other are conjugate where L is quadratic between them, and the inner nodes of an element from
/// one to the other would have a singular matrix.
std::vector<double> with_nodes(std::span<const double> mesh, std::span<const double> times);
/// The largest distance of one of these times from the nearest node.
double distance_to_nodes(std::span<const double> mesh, std::span<const double> times);

/// Values of n numbers at the nodes of one mesh (values[k*n + a]), interpolated linearly to those of another.
std::vector<double> interpolated(std::span<const double> values, std::size_t n, std::span<const double> from,
                                 std::span<const double> to);

}  // namespace extremal
