#include "solve/mesh/overlooked.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "machine/aligned.hpp"
#include "solution/element_point.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/mesh/nodal_values.hpp"

namespace extremal {

using namespace limits::overlooked;

namespace {

/// Points evaluated together; a multiple of the lanes.
constexpr int points_together = 64;

/// Points of a trajectory that come in order, on cubics between a few points of each element.
class CubicReader {
 public:
  explicit CubicReader(const Trajectory& trajectory)
      : trajectory_(trajectory), n_(trajectory.coordinates), ends_(4 * n_), cubics_(4 * n_) {}

  /// q and q'; coordinate a goes to q[a*stride] and v[a*stride].
  void read(double t, double* q, double* v, std::ptrdiff_t stride) {
    if (!(t <= until_)) move_to(t);
    const double x = std::min((t - from_) / length_, 1.0);
    for (std::size_t a = 0; a < n_; ++a) {
      const double* const c = cubics_.data() + 4 * a;
      q[a * stride] = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
      v[a * stride] = (c[1] + x * (2 * c[2] + x * 3 * c[3])) / length_;
    }
  }

 private:
  void move_to(double t) {
    while (element_ + 1 < trajectory_.elements() && trajectory_.times[element_ + 1] < t) ++element_;
    const int parts = cubics_a_degree * trajectory_.degree;
    const double start = trajectory_.times[element_], whole = trajectory_.length(element_);
    const int k = std::clamp(static_cast<int>(parts * (t - start) / whole), 0, parts - 1);
    from_ = start + k * whole / parts;
    until_ = start + (k + 1) * whole / parts;
    length_ = until_ - from_;
    double *const q = ends_.data(), *const v = q + 2 * n_;
    for (const int end : {0, 1}) {
      nodal_values(trajectory_.degree, static_cast<double>(k + end) / parts, value_);
      element_point(trajectory_, element_, {value_, nullptr}, q + end * n_, v + end * n_, 1);
    }
    for (std::size_t a = 0; a < n_; ++a) {
      const double rise = q[n_ + a] - q[a], first = length_ * v[a], last = length_ * v[n_ + a];
      double* const c = cubics_.data() + 4 * a;
      c[0] = q[a], c[1] = first, c[2] = 3 * rise - 2 * first - last, c[3] = first + last - 2 * rise;
    }
  }

  const Trajectory& trajectory_;
  std::size_t n_;
  std::vector<double> ends_, cubics_;
  double value_[max_degree + 1];
  double from_ = 0, until_ = -INFINITY, length_ = 0;
  int element_ = 0;
};

/// ∂L/∂q and ∂L/∂q' at points of a trajectory that come in order.
class ForceReader {
 public:
  ForceReader(const Lagrangian& lagrangian, const Trajectory& trajectory)
      : lagrangian_(lagrangian),
        points_(trajectory),
        n_(trajectory.coordinates),
        rows_((2 * n_ + 1) * points_together),
        out_(static_cast<std::size_t>(lagrangian.rows(Order::gradient)) * points_together) {}

  /// Point i of the batch.
  void put(int i, double t) {
    double* const q = rows_.data() + i;
    points_.read(t, q, q + n_ * points_together, points_together);
    rows_[2 * n_ * points_together + i] = t;
  }

  /// Of all points of the batch: n rows each.
  void read(AlignedDoubles& force, AlignedDoubles& momentum) {
    const double *const q = rows_.data(), *const v = q + n_ * points_together;
    lagrangian_.evaluate({points_together, points_together, q, v, v + n_ * points_together}, Order::gradient,
                         out_.data(), scratch_);
    force.assign(n_ * points_together, 0.0);
    momentum.assign(n_ * points_together, 0.0);
    const Structure& s = lagrangian_.structure();
    const auto add = [&](AlignedDoubles& to, int row, double factor, const double* from) {
      for (int i = 0; i < points_together; ++i) to[row * points_together + i] += factor * from[i];
    };
    for (const Triplet& m : s.mass) add(momentum, m.row, m.value, v + m.column * points_together);
    for (const Triplet& c : s.gyroscopic) {
      add(momentum, c.row, c.value, q + c.column * points_together);
      add(force, c.column, c.value, v + c.row * points_together);
    }
    for (std::size_t k = 0; k < s.gradient.size(); ++k) {
      const std::size_t z = s.gradient[k];
      add(z < n_ ? force : momentum, static_cast<int>(z < n_ ? z : z - n_), 1,
          out_.data() + (1 + k) * points_together);
    }
  }

 private:
  const Lagrangian& lagrangian_;
  CubicReader points_;
  std::size_t n_;
  AlignedDoubles rows_, out_;
  Scratch scratch_;
};

}  // namespace

OverlookedForces overlooked_forces(const Lagrangian& lagrangian, const Trajectory& trajectory) {
  constexpr int steps_a_batch = points_together / 2 - 1;  // their ends and their middles
  const int count = std::max(least_steps, trajectory.degree * trajectory.elements());
  const double step = trajectory.duration() / count;
  const std::size_t n = trajectory.coordinates;
  ForceReader reader(lagrangian, trajectory);
  AlignedDoubles force, momentum;
  std::vector<double> largest(n), before(n), most(count);  // |p|, the last |Δp|, what is missed
  for (int first = 0; first < count; first += steps_a_batch) {
    const int together = std::min(steps_a_batch, count - first);
    for (int i = 0; i < points_together; ++i)
      reader.put(i, std::min((first + 0.5 * std::min(i, 2 * together)) * step, trajectory.duration()));
    reader.read(force, momentum);
    for (std::size_t a = 0; a < n; ++a)
      for (int k = 0; k < together; ++k) {
        const double* const p = momentum.data() + a * points_together + 2 * k;
        const double change = std::abs(p[2] - p[0]), usual = std::exchange(before[a], change);
        const double missed = std::abs(p[2] - p[0] - step * force[a * points_together + 2 * k + 1]);
        largest[a] = std::max({largest[a], std::abs(p[0]), std::abs(p[2])});
        if (missed > far * std::max(change, usual) && missed > momentum_noise * largest[a])
          most[first + k] = std::max(most[first + k], missed);
      }
  }
  // Elements end on kinks, where forces jump: the middle of a step does not tell their mean there.
  const bool kinked = lagrangian.kinks() != nullptr;
  const double roundoff = rounded_off * *std::max_element(largest.begin(), largest.end());
  OverlookedForces found{.step = step};
  for (int k = 0, element = 0; k < count; ++k) {
    while (element + 1 < trajectory.elements() && trajectory.times[element + 1] <= k * step) ++element;
    const bool whole = trajectory.times[element + 1] >= (k + 1) * step;
    if (most[k] > roundoff && (whole || !kinked) && trajectory.length(element) > steps_an_element * step)
      found.steps.push_back(k);
  }
  return found;
}

}  // namespace extremal
