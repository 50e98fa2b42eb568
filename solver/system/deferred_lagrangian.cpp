#include "system/deferred_lagrangian.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

namespace extremal {

DeferredLagrangian::DeferredLagrangian(int coordinates, Make make) : make_(std::move(make)) {
  structure_.coordinates = coordinates;
  for (int a = 0; a < 2 * coordinates; ++a) {
    structure_.gradient.push_back(a);
    for (int b = 0; b <= a; ++b) structure_.hessian.push_back({a, b});
  }
}

std::shared_ptr<const Lagrangian> DeferredLagrangian::made() const {
  std::call_once(once_, [this] { made_ = make_(); });
  return made_;
}

void DeferredLagrangian::evaluate(const Points& points, Order order, double* out, Scratch&) const {
  Scratch scratch;  // that of the caller may hold the points
  const int n = structure_.coordinates;
  std::vector<double> q(n), v(n);
  for (int i = 0; i < points.count; ++i) {
    for (int a = 0; a < n; ++a) {
      q[a] = points.q[a * points.stride + i];
      v[a] = points.v[a * points.stride + i];
    }
    const PointValues values = evaluate_at(*made(), q, v, points.t ? points.t[i] : 0, order, scratch);
    double* row = out + i;
    const auto put = [&](double x) {
      *row = x;
      row += points.stride;
    };
    put(values.value);
    if (order == Order::value) continue;
    for (int a = 0; a < 2 * n; ++a) put(a < n ? values.dq[a] : values.dv[a - n]);
    if (order == Order::gradient) continue;
    for (const auto [a, b] : structure_.hessian)
      put(a < n ? values.qq[a * n + b] : b < n ? values.vq[(a - n) * n + b] : values.vv[(a - n) * n + b - n]);
  }
}

void DeferredLagrangian::sensitivity(const Points&, int, double*, Scratch&) const {
  throw std::logic_error("a deferred Lagrangian has no parameters");
}

std::shared_ptr<const Lagrangian> as_made(std::shared_ptr<const Lagrangian> lagrangian) {
  const auto* deferred = dynamic_cast<const DeferredLagrangian*>(lagrangian.get());
  return deferred ? deferred->made() : lagrangian;
}

}  // namespace extremal
