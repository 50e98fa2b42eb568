#include "problem/shift.hpp"

#include <algorithm>
#include <utility>

namespace extremal {

namespace {

/// Another Lagrangian with one of its inputs increased by a constant: t, or a coordinate.
class Shifted final : public Lagrangian {
 public:
  static constexpr int time = -1;

  Shifted(std::shared_ptr<const Lagrangian> lagrangian, int input, double by)
      : lagrangian_(std::move(lagrangian)), input_(input), by_(by) {
    structure_ = lagrangian_->structure();
  }

  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override {
    Scratch moved;
    lagrangian_->evaluate(shifted(points, moved), order, out, scratch);
  }
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override {
    Scratch moved;
    lagrangian_->sensitivity(shifted(points, moved), parameter, out, scratch);
  }
  bool evaluate_extended(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                         PointScratch<Extended>& scratch) const override {
    return input_ == time && lagrangian_->evaluate_extended(q, v, t + by_, out, scratch);
  }
  /// t + by is not known to so many digits.
  bool evaluate_extended(const DoubleDouble*, const DoubleDouble*, const DoubleDouble&, DoubleDouble*,
                         PointScratch<DoubleDouble>&) const override {
    return false;
  }

 private:
  /// Points with the input increased in `moved`.
  Points shifted(const Points& points, Scratch& moved) const {
    Points result = points;
    if (input_ == time) {
      if (!points.t) return result;
      double* const t = moved.reserve(points.count);
      for (int i = 0; i < points.count; ++i) t[i] = points.t[i] + by_;
      result.t = t;
      return result;
    }
    const std::ptrdiff_t size = (structure_.coordinates - 1) * points.stride + points.count;
    double* const q = moved.reserve(size);
    std::copy_n(points.q, size, q);
    for (int i = 0; i < points.count; ++i) q[input_ * points.stride + i] += by_;
    result.q = q;
    return result;
  }

  std::shared_ptr<const Lagrangian> lagrangian_;
  int input_;
  double by_;
};

}  // namespace

std::shared_ptr<const Lagrangian> shift_time(std::shared_ptr<const Lagrangian> lagrangian, double by) {
  if (by == 0 || lagrangian->structure().autonomous) return lagrangian;
  return std::make_shared<const Shifted>(std::move(lagrangian), Shifted::time, by);
}

std::shared_ptr<const Manifold> shift_time(std::shared_ptr<const Manifold> manifold, double by) {
  if (by == 0 || manifold->autonomous()) return manifold;
  Manifold::Parts parts = manifold->parts();
  const int t = manifold->coordinates();
  parts.lagrangian = shift_time(parts.lagrangian, by);
  parts.timed = std::make_shared<const Shifted>(parts.timed, t, by);
  parts.forms = std::make_shared<const Shifted>(parts.forms, t, by);
  return std::make_shared<const Manifold>(std::move(parts));
}

}  // namespace extremal
