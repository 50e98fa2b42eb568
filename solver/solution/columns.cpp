#include "solution/columns.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "action/rule.hpp"

namespace extremal {
namespace {

/// Points of one call of the Lagrangian and of one run of the interpolation: a multiple of the lanes.
constexpr std::size_t block = 64;

/// Products of the differences from all nodes but one give the basis at many points side by side, without a
/// division for each node. Where the point is a node they vanish for all others, so that its value comes out.
class ColumnEvaluator {
 public:
  ColumnEvaluator(const Trajectory& trajectory, std::span<double* const> q, std::span<double* const> v)
      : trajectory_(trajectory), points_(lobatto_barycentric(trajectory.degree)), q_(q), v_(v) {
    const std::vector<double>& x = points_.nodes;
    for (std::size_t j = 0; j + 1 < x.size(); ++j) middles_.push_back((x[j] + x[j + 1]) / 2);
  }

  void run(std::span<const double> times) {
    for (std::size_t i = 0; i < times.size();) i += step(times.data() + i, times.size() - i, i);
  }

 private:
  /// Times that follow each other in one element and have one nearest node; returns how many there were.
  std::size_t step(const double* t, std::size_t most, std::size_t at) {
    if (!(*t >= 0 && *t <= trajectory_.duration())) {
      alone(*t, at);
      return 1;
    }
    find_element(*t);
    const std::vector<double>& times = trajectory_.times;
    const double start = times[element_], h = times[element_ + 1] - start;
    const auto middle = std::ranges::upper_bound(middles_, (*t - start) / h);
    const std::size_t node = middle - middles_.begin();
    const bool last = node == middles_.size();
    const double infinity = std::numeric_limits<double>::infinity();
    const bool ends = last && element_ + 1 == trajectory_.elements();
    const double from = node == 0 ? start : start + h * middles_[node - 1];
    const double to = ends ? infinity : last ? times[element_ + 1] : start + h * *middle;
    std::size_t count = 1;
    most = std::min(most, block);
    while (count < most && t[count] >= from && t[count] < to) ++count;
    interpolate(t, count, node, at);
    return count;
  }

  void find_element(double t) {
    const std::vector<double>& times = trajectory_.times;
    const auto holds = [&](int k) { return t >= times[k] && t < times[k + 1]; };
    if (holds(element_)) return;
    if (element_ + 1 < trajectory_.elements() && holds(element_ + 1)) {
      ++element_;
      return;
    }
    element_ = static_cast<int>(std::upper_bound(times.begin() + 1, times.end() - 1, t) - times.begin()) - 1;
  }

  void interpolate(const double* t, std::size_t count, std::size_t nearest, std::size_t at) {
    const std::vector<double>& x = points_.nodes;
    const double start = trajectory_.times[element_], h = trajectory_.times[element_ + 1] - start;
    const double node_time = start + h * x[nearest];
    std::array<double, block> tau, scale, product;
    for (std::size_t i = 0; i < count; ++i) {
      const double part = std::min((t[i] - start) / h, 1.0);
      tau[i] = t[i] == node_time ? x[nearest] : part;
    }
    product.fill(1);
    for (std::size_t j = 0; j < x.size(); ++j)
      for (std::size_t i = 0; i < count; ++i) {
        basis_[j][i] = points_.weights[j] * product[i];
        product[i] *= tau[i] - x[j];
      }
    product.fill(1);
    scale.fill(0);
    for (std::size_t j = x.size(); j-- > 0;)
      for (std::size_t i = 0; i < count; ++i) {
        basis_[j][i] *= product[i];
        product[i] *= tau[i] - x[j];
        scale[i] += basis_[j][i];
      }
    for (std::size_t i = 0; i < count; ++i) scale[i] = 1 / scale[i];
    const std::size_t n = trajectory_.coordinates, first = element_ * x.size() * n;
    for (std::size_t a = 0; a < n; ++a) {
      combine(trajectory_.nodes.data() + first + a, count, nearest, scale, q_[a] + at);
      combine(trajectory_.slopes.data() + first + a, count, nearest, scale, v_[a] + at);
    }
  }

  /// On the differences from one node: constants cost no digits.
  void combine(const double* values, std::size_t count, std::size_t nearest,
               const std::array<double, block>& scale, double* to) const {
    const std::size_t n = trajectory_.coordinates;
    const double centre = values[nearest * n];
    std::array<double, block> change{};
    for (std::size_t j = 0; j < points_.nodes.size(); ++j) {
      const double difference = values[j * n] - centre;
      for (std::size_t i = 0; i < count; ++i) change[i] += basis_[j][i] * difference;
    }
    for (std::size_t i = 0; i < count; ++i) to[i] = centre + scale[i] * change[i];
  }

  /// A time outside by rounding; any other is refused.
  void alone(double t, std::size_t at) const {
    std::vector<double> q(trajectory_.coordinates), v(q.size());
    trajectory_.at(t, q, v);
    for (std::size_t a = 0; a < q.size(); ++a) {
      q_[a][at] = q[a];
      v_[a][at] = v[a];
    }
  }

  const Trajectory& trajectory_;
  const Barycentric& points_;
  std::span<double*const> q_, v_;
  std::vector<double> middles_;  ///< between neighbouring nodes
  int element_ = 0;
  std::array<std::array<double, block>, max_degree + 1> basis_;
};

}  // namespace

void evaluate_columns(const Trajectory& trajectory, std::span<const double> times, std::span<double* const> q,
                      std::span<double* const> v) {
  if (!trajectory.slopes.empty()) {
    ColumnEvaluator(trajectory, q, v).run(times);
    return;
  }
  std::vector<double> point(trajectory.coordinates), rate(point.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    trajectory.at(times[i], point, rate);
    for (std::size_t a = 0; a < point.size(); ++a) {
      q[a][i] = point[a];
      v[a][i] = rate[a];
    }
  }
}

/// p = ∂R/∂v + M v + C q + a.
void momentum_columns(const Lagrangian& lagrangian, std::span<const double> times,
                      std::span<const double* const> q, std::span<const double* const> v,
                      std::span<double* const> p) {
  const Structure& s = lagrangian.structure();
  const std::size_t n = s.coordinates, rows = 2 * n + 1;
  Scratch storage, scratch;
  double* const in = storage.reserve((rows + lagrangian.rows(Order::gradient)) * block);
  double *const velocities = in + n * block, *const at_times = in + 2 * n * block,
                *const out = in + rows * block;
  for (std::size_t first = 0; first < times.size(); first += block) {
    const std::size_t count = std::min(block, times.size() - first);
    const auto load = [&](const double* values, double* row) {
      std::copy_n(values + first, count, row);
      std::fill(row + count, row + block, row[count - 1]);
    };
    for (std::size_t a = 0; a < n; ++a) {
      load(q[a], in + a * block);
      load(v[a], velocities + a * block);
    }
    load(times.data(), at_times);
    lagrangian.evaluate({block, block, in, velocities, at_times}, Order::gradient, out, scratch);
    for (std::size_t a = 0; a < n; ++a) std::fill_n(p[a] + first, count, 0.0);
    for (std::size_t k = 0; k < s.gradient.size(); ++k) {
      const auto z = static_cast<std::size_t>(s.gradient[k]);
      if (z >= n) std::copy_n(out + (1 + k) * block, count, p[z - n] + first);
    }
    const auto add = [&](const Triplet& term, const double* row) {
      for (std::size_t i = 0; i < count; ++i) p[term.row][first + i] += term.value * row[i];
    };
    for (const Triplet& m : s.mass) add(m, velocities + m.column * block);
    for (const Triplet& c : s.gyroscopic) add(c, in + c.column * block);
    for (std::size_t a = 0; a < s.linear.size(); ++a)
      for (std::size_t i = 0; i < count; ++i) p[a][first + i] += s.linear[a];
  }
}

}  // namespace extremal
