#include "solve/march/deviation.hpp"

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "machine/aligned.hpp"
#include "solution/element_point.hpp"
#include "solve/march/limits.hpp"
#include "solve/mesh/nodal_values.hpp"
#include "solve/mesh/limits.hpp"

namespace extremal {

namespace {

/// Points evaluated together, for each motion; a multiple of the lanes.
constexpr int batch = 64;
/// The end of an element, and points that are no nodes of small degrees.
constexpr double places[] = {0.093, 0.27, 0.46, 0.64, 0.83, 1.0};

/// The ranges and errors of q, q' and p, from points that come in pairs.
class Comparer {
 public:
  Comparer(const Lagrangian& lagrangian, int coordinates)
      : lagrangian_(lagrangian),
        structure_(lagrangian.structure()),
        n_(coordinates),
        low_(3 * n_, INFINITY),
        high_(3 * n_, -INFINITY) {
    for (Side* side : {&motion_, &better_}) side->rows.assign((3 * n_ + 1) * batch, 0.0);
    out_.assign(static_cast<std::size_t>(lagrangian.rows(Order::gradient)) * batch, 0.0);
  }

  double* motion() { return motion_.rows.data() + count_; }
  double* better() { return better_.rows.data() + count_; }
  std::ptrdiff_t velocities() const { return static_cast<std::ptrdiff_t>(n_ * batch); }

  void take(double t) {
    time_[count_++] = t;
    if (count_ == batch) evaluate();
  }

  MotionDeviation finish(double duration) {
    if (count_ > 0) evaluate();
    found_.range = {width(0), width(n_), width(2 * n_)};
    for (std::size_t a = 0; a < n_; ++a)
      found_.magnitude = std::max({found_.magnitude, std::abs(low_[a]), std::abs(high_[a])});
    for (std::size_t a = 2 * n_; a < 3 * n_; ++a)
      found_.largest_momentum = std::max({found_.largest_momentum, std::abs(low_[a]), std::abs(high_[a])});
    found_.duration = duration;
    return std::move(found_);
  }

 private:
  struct Side {
    AlignedDoubles rows;  ///< q, q', p, t
  };

  double width(std::size_t first) const {
    double largest = 0;
    for (std::size_t a = first; a < first + n_; ++a) largest = std::max(largest, high_[a] - low_[a]);
    return largest;
  }

  void momenta(Side& side) {
    double *const q = side.rows.data(), *const v = q + n_ * batch, *const p = v + n_ * batch,
                  *const t = p + n_ * batch;
    for (std::size_t row = 0; row < 2 * n_; ++row)
      std::fill(q + row * batch + count_, q + (row + 1) * batch, q[row * batch + count_ - 1]);
    std::copy_n(time_, count_, t);
    std::fill(t + count_, t + batch, time_[count_ - 1]);
    std::fill_n(p, n_ * batch, 0.0);
    for (const Triplet& m : structure_.mass)
      for (int i = 0; i < batch; ++i) p[m.row * batch + i] += m.value * v[m.column * batch + i];
    for (const Triplet& c : structure_.gyroscopic)
      for (int i = 0; i < batch; ++i) p[c.row * batch + i] += c.value * q[c.column * batch + i];
    if (structure_.velocity_free) return;
    lagrangian_.evaluate({batch, batch, q, v, t}, Order::gradient, out_.data(), scratch_);
    for (std::size_t k = 0; k < structure_.gradient.size(); ++k) {
      const std::size_t z = structure_.gradient[k];
      if (z < n_) continue;
      for (int i = 0; i < batch; ++i) p[(z - n_) * batch + i] += out_[(1 + k) * batch + i];
    }
  }

  void evaluate() {
    momenta(motion_);
    momenta(better_);
    double differences[3][batch] = {};
    for (std::size_t row = 0; row < 3 * n_; ++row) {
      const double *x = motion_.rows.data() + row * batch, *y = better_.rows.data() + row * batch;
      double* const difference = differences[row / n_];
      double low = low_[row], high = high_[row];
      for (int i = 0; i < count_; ++i) {
        const double apart = std::abs(x[i] - y[i]);
        difference[i] = apart <= difference[i] ? difference[i] : apart;  // NaN stays
        low = std::min(low, y[i]);
        high = std::max(high, y[i]);
      }
      low_[row] = low;
      high_[row] = high;
    }
    for (int i = 0; i < count_; ++i)
      note(time_[i], {differences[0][i], differences[1][i], differences[2][i]});
    count_ = 0;
  }

  void note(double time, const MotionDeviation::Sizes& now) {
    MotionDeviation::Sizes& error = found_.error;
    found_.finite = found_.finite && std::isfinite(now.q + now.v + now.p);
    if (now.q <= error.q && now.v <= error.v && now.p <= error.p) return;
    error = {std::max(error.q, now.q), std::max(error.v, now.v), std::max(error.p, now.p)};
    constexpr double tenth = 1.1;
    if (!found_.growth.empty()) {
      const MotionDeviation::Sizes& last = found_.growth.back().error;
      if (error.q <= tenth * last.q && error.v <= tenth * last.v && error.p <= tenth * last.p) return;
    }
    found_.growth.push_back({time, error});
  }

  const Lagrangian& lagrangian_;
  const Structure& structure_;
  std::size_t n_;
  Side motion_, better_;
  AlignedDoubles out_;
  Scratch scratch_;
  double time_[batch];
  int count_ = 0;
  MotionDeviation found_;
  std::vector<double> low_, high_;
};

/// Where velocities or momenta hardly change they are asked for no more digits than this share of their size
/// gives.
constexpr double nearly_uniform = limits::resolution::nearly_uniform;

MotionDeviation::Part worst_of(const MotionDeviation::Sizes& error, const MotionDeviation& whole,
                               double tolerance) {
  constexpr double negligible = 1e-12, velocity_tolerances = 10;
  const double q = whole.range.q > negligible * whole.magnitude ? whole.range.q : whole.magnitude;
  const double v = std::max(whole.range.v, nearly_uniform * q / whole.duration),
               p = std::max(whole.range.p, nearly_uniform * whole.largest_momentum);
  const double loose = velocity_tolerances * tolerance;
  return std::max({MotionDeviation::Part{"coordinates", error.q, tolerance * q},
                   {"velocities", error.v, loose * v},
                   {"momenta", error.p, loose * p}},
                  [](const auto& a, const auto& b) { return a.excess() < b.excess(); });
}

}  // namespace

MotionDeviation::Part MotionDeviation::worst(double tolerance) const {
  return worst_of(error, *this, tolerance);
}

double MotionDeviation::excess(double tolerance) const {
  return finite ? worst(tolerance).excess() : INFINITY;
}

double MotionDeviation::exceeded(double tolerance) const {
  for (const Growth& entry : growth)
    if (!(worst_of(entry.error, *this, tolerance).excess() <= 1)) return entry.time;
  return INFINITY;
}

MotionDeviation deviation(const Lagrangian& lagrangian, const Trajectory& motion, const Trajectory& better) {
  Comparer comparer(lagrangian, better.coordinates);
  const Basis basis = lobatto_basis(better.degree, places);
  const Basis middle = lobatto_basis(motion.degree, std::vector<double>{0.5});
  double value[max_degree + 1];
  const auto read = [&](const Trajectory& trajectory, int k, double tau, double* to) {
    nodal_values(trajectory.degree, std::clamp(tau, 0.0, 1.0), value);
    element_point(trajectory, k, {value, nullptr}, to, to + comparer.velocities(), batch);
  };
  int k = 0;
  const int last = motion.elements() - 1;
  for (int e = 0; e < better.elements(); ++e) {
    const double start = better.times[e], h = better.length(e);
    for (std::size_t i = 0; i < std::size(places); ++i) {
      const double t =
          e + 1 == better.elements() && places[i] == 1 ? better.duration() : start + places[i] * h;
      // Where both end elements on a kink, they differ by roundoff, and velocities may jump.
      while (k < last && motion.times[k + 1] <
                             t - std::max(limits::march::instant * h, limits::march::instant_digits * t))
        ++k;
      element_point(better, e, basis.row(i), comparer.better(), comparer.better() + comparer.velocities(),
                    batch);
      read(motion, k, (t - motion.times[k]) / motion.length(k), comparer.motion());
      comparer.take(t);
      const double centre = motion.times[k] + 0.5 * motion.length(k);
      if (motion.length(k) > h || centre < start || centre > start + h) continue;
      element_point(motion, k, middle.row(0), comparer.motion(), comparer.motion() + comparer.velocities(),
                    batch);
      read(better, e, (centre - start) / h, comparer.better());
      comparer.take(centre);
    }
  }
  return comparer.finish(better.duration());
}

}  // namespace extremal
