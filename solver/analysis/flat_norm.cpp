#include "analysis/flat_norm.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "machine/roundoff.hpp"

namespace extremal {

namespace {

struct Bend {
  double at, weight;
};

/// −Σ weight (at − y)₊ over `rising` − Σ weight (y − at)₊ over `falling`, on [−1, 1]: concave, piecewise
/// linear, and largest from the last of the rising bends to the first of the falling ones.
struct Concave {
  std::vector<Bend> rising, falling;  // the ones nearest to the top are last

  double first_top() const { return rising.empty() ? -1 : rising.back().at; }
  double last_top() const { return falling.empty() ? 1 : falling.back().at; }

  /// Adds slope·y, but for a constant: (y − at) − (y − at)₊ = −(at − y)₊, so bends change sides. On [−1, 1]
  /// the slopes beyond the last bend are bends at ±1.
  void add(double slope) {
    auto& from = slope > 0 ? falling : rising;
    auto& to = slope > 0 ? rising : falling;
    double left = std::abs(slope);
    while (left > 0 && !from.empty()) {
      Bend& bend = from.back();
      const double part = std::min(left, bend.weight);
      to.push_back({bend.at, part});
      left -= part;
      bend.weight -= part;
      if (!(bend.weight > 0)) from.pop_back();
    }
    if (left > 0) to.push_back({slope > 0 ? 1.0 : -1.0, left});
  }

  /// Becomes its maximum over [y − distance, y + distance].
  void widen(double distance) {
    for (Bend& bend : rising) bend.at -= distance;
    for (Bend& bend : falling) bend.at += distance;
    std::erase_if(rising, [](const Bend& bend) { return bend.at <= -1; });
    std::erase_if(falling, [](const Bend& bend) { return bend.at >= 1; });
  }
};

/// ∫ f dμ for the f that has the largest real part of ∫ f dμ·conj(direction). The best of the first points as
/// a function of f at the last of them is concave and piecewise linear, and known from the one before.
std::complex<double> furthest(std::span<const PointMass> measure, std::complex<double> direction) {
  Concave best;
  std::vector<std::pair<double, double>> top;
  for (std::size_t k = 0; k < measure.size(); ++k) {
    if (k > 0) best.widen(measure[k].at - measure[k - 1].at);
    best.add(std::real(measure[k].weight * std::conj(direction)));
    top.emplace_back(best.first_top(), best.last_top());
  }
  std::complex<double> result = 0;
  double f = 0;
  for (std::size_t k = measure.size(); k-- > 0;) {
    const double nearest = std::clamp(f, top[k].first, top[k].second);
    const double distance = k + 1 < measure.size() ? measure[k + 1].at - measure[k].at : 2;
    f = std::clamp(nearest, f - distance, f + distance);
    result += f * measure[k].weight;
  }
  return result;
}

/// The largest |z| in the corner of the set of values between two of its corners a and b: a convex set, all
/// of which is on one side of each edge, but for the roundoff of its corners.
double beyond(std::span<const PointMass> measure, std::complex<double> a, std::complex<double> b,
              double roundoff) {
  const double least = std::max(std::abs(a), std::abs(b)), size = std::abs(b - a);
  if (size <= roundoff) return least;
  const std::complex<double> outward = (b - a) / size * std::complex<double>(0, -1);
  const std::complex<double> c = furthest(measure, outward);
  if (!(std::real((c - a) * std::conj(outward)) > roundoff)) return least;
  return std::max(beyond(measure, a, c, roundoff), beyond(measure, c, b, roundoff));
}

}  // namespace

double flat_norm(std::vector<PointMass> measure) {
  for (const PointMass& mass : measure)
    if (!std::isfinite(mass.at) || !std::isfinite(mass.weight.real()) || !std::isfinite(mass.weight.imag()))
      throw std::invalid_argument("a measure with a point or a weight that is not finite");
  std::sort(measure.begin(), measure.end(),
            [](const PointMass& a, const PointMass& b) { return a.at < b.at; });
  const bool real = std::all_of(measure.begin(), measure.end(),
                                [](const PointMass& mass) { return mass.weight.imag() == 0; });
  const std::complex<double> right = furthest(measure, 1);
  if (real) return std::abs(right);
  // The set is symmetric about 0: half of its corners tell all.
  const std::complex<double> top = furthest(measure, {0, 1});
  double mass = 0;
  for (const PointMass& each : measure) mass += std::abs(each.weight);
  const double roundoff = 4 * machine_epsilon * mass;
  return std::max(beyond(measure, right, top, roundoff), beyond(measure, top, -right, roundoff));
}

}  // namespace extremal
