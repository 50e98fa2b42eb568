#include "solve/homotopy/comoving.hpp"
#include "solve/homotopy/limits.hpp"

#include "action/rule.hpp"
#include "machine/simd.hpp"

namespace extremal {

using namespace limits::comoving;

void Comoving::measure_slopes(const Path& path) {
  const int n = path.coordinates(), s = path.degree(), count = path.elements();
  const std::size_t size = static_cast<std::size_t>(s + 1) * n;
  const Basis& nodes = lobatto_nodal_basis(s);
  slopes_.resize(count * size);
  ends_.assign(static_cast<std::size_t>(count + 1) * n, 0);
  for (int k = 0; k < count; ++k) {
    double* const here = slopes_.data() + k * size;
    path.element_slopes(k, nodes.derivative, here);
    for (std::size_t u = 0; u < size; ++u) here[u] *= path.duration();
    for (int a = 0; a < n; ++a) {
      ends_[k * n + a] += (k > 0 ? 0.5 : 1) * here[a];
      ends_[(k + 1) * n + a] += (k + 1 < count ? 0.5 : 1) * here[s * n + a];
    }
  }
}

/// The least change makes tridiagonal equations.
void Comoving::find_times(const Path& path, double extent, const Step& step, std::vector<double>& times) {
  const int n = path.coordinates(), count = path.elements();
  const std::span<const double> mesh = path.mesh();
  const double weight = 1 / (extent * extent * static_cast<double>(step.nodes.size()));
  const auto stiffness = [&](int k) {
    const double h = mesh[k + 1] - mesh[k];
    return strain_weight / (h * h * count);
  };
  times.assign(count + 1, 0);
  upper_.assign(count + 1, 0);
  for (int k = 1; k < count; ++k) {
    double square = 0, product = 0;
    for (int a = 0; a < n; ++a) {
      square += ends_[k * n + a] * ends_[k * n + a];
      product += ends_[k * n + a] * step.nodes[k * n + a];
    }
    const double before = stiffness(k - 1), after = stiffness(k);
    const double pivot = weight * square + before * (1 - upper_[k - 1]) + after;
    upper_[k] = after / pivot;
    times[k] = (before * times[k - 1] - weight * product) / pivot;
  }
  for (int k = count - 1; k > 0; --k) times[k] += upper_[k] * times[k + 1];
}

void Comoving::take_along(const Path& path, double extent, Step& step, std::vector<double>& times) {
  measure_slopes(path);
  find_times(path, extent, step, times);
  const int n = path.coordinates(), s = path.degree(), lanes = path.lanes();
  const std::size_t m = static_cast<std::size_t>(s + 1) * n;
  const std::vector<double>& lobatto = lobatto_nodal_basis(s).points;
  for (std::size_t k = 0; k < times.size(); ++k)
    for (int a = 0; a < n; ++a) step.nodes[k * n + a] += ends_[k * n + a] * times[k];
  for (int k = 0; k < path.elements(); ++k) {
    const double* const slope = slopes_.data() + k * m;
    double* const inner = step.inner.data() + static_cast<std::size_t>(k / lanes) * m * lanes + k % lanes;
    for (int j = 1; j < s; ++j)
      for (int a = 0; a < n; ++a) {
        const double first = ends_[k * n + a] * times[k], last = ends_[(k + 1) * n + a] * times[k + 1];
        const double time = times[k] + lobatto[j] * (times[k + 1] - times[k]);
        const double chord = first + lobatto[j] * (last - first);
        inner[((j - 1) * n + a) * lanes] += slope[j * n + a] * time - chord;
      }
  }
}

double strain_product(const Path& path, const std::vector<double>& a, const std::vector<double>& b) {
  if (a.empty() || b.empty()) return 0;
  const std::span<const double> mesh = path.mesh();
  double sum = 0;
  for (int k = 0; k < path.elements(); ++k) {
    const double h = mesh[k + 1] - mesh[k];
    sum += (a[k + 1] - a[k]) * (b[k + 1] - b[k]) / (h * h);
  }
  return strain_weight * sum / path.elements();
}

}  // namespace extremal
