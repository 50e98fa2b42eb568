#pragma once

#include <cstddef>
#include <vector>

/// \file The chain of Fermi, Pasta and Ulam, of any length.

namespace bench::shooting {

/// Springs with the force F(d) = d + α d² + β d³ between unit masses and walls:
///   q_i'' = F(q_{i+1} − q_i) − F(q_i − q_{i−1}).
struct Chain {
  /// Columns of variations in a block: all stages of a block stay in the cache of a core.
  static constexpr int width = 8;
  static constexpr int first_width(bool) { return width; }
  static constexpr bool velocity_free = true;
  using Coordinates = std::vector<double>;
  template <int width>
  using Columns = std::vector<double>;
  using Slope = std::vector<double>;  ///< F' of each spring
  const int n;
  double alpha, beta;
  mutable std::vector<double> force;  ///< of each spring

  Chain(int n, const double* p) : n(n), alpha(p[0]), beta(p[1]), force(n + 1) {}
  Coordinates coordinates() const { return Coordinates(n); }
  template <int width>
  Columns<width> columns() const {
    return Columns<width>(static_cast<std::size_t>(n) * width);
  }
  Slope slope() const { return Slope(n + 1); }

  void acceleration(const double* q, const double*, double* a, Slope* slope) const {
    double* const f = force.data();
    const auto pull = [&](double d) { return d * (1 + d * (alpha + d * beta)); };
    f[0] = pull(q[0]);
    for (int i = 1; i < n; ++i) f[i] = pull(q[i] - q[i - 1]);
    f[n] = pull(-q[n - 1]);
    for (int i = 0; i < n; ++i) a[i] = f[i + 1] - f[i];
    if (!slope) return;
    double* const s = slope->data();
    const auto stiffness = [&](double d) { return 1 + d * (2 * alpha + 3 * beta * d); };
    s[0] = stiffness(q[0]);
    for (int i = 1; i < n; ++i) s[i] = stiffness(q[i] - q[i - 1]);
    s[n] = stiffness(-q[n - 1]);
  }
  template <int width>
  void vary(const Slope& slope, const double* x, const double*, double* w) const {
    double below[width];  // forces of the spring before the mass
    for (int j = 0; j < width; ++j) below[j] = slope[0] * x[j];
    for (int i = 0; i < n; ++i) {
      const double *here = x + i * width, s = slope[i + 1];
      for (int j = 0; j < width; ++j) {
        const double next = i + 1 < n ? here[width + j] : 0;
        const double above = s * (next - here[j]);
        w[i * width + j] = above - below[j];
        below[j] = above;
      }
    }
  }
};

}  // namespace bench::shooting
