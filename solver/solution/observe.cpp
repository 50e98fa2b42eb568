#include "solution/observe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "action/by_degree.hpp"
#include "action/rule.hpp"
#include "solution/element_point.hpp"

namespace extremal {

namespace {

/// Points gathered for one call of the Lagrangian; a multiple of the lanes and of 64 bytes.
constexpr int batch = 64;

struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  void add(double x) {
    least = std::min(least, x);
    most = std::max(most, x);
  }
};

std::vector<double> widths(const std::vector<Range>& ranges) {
  std::vector<double> result;
  for (const Range& range : ranges) result.push_back(range.most - range.least);
  return result;
}

/// A Lagrangian evaluated over points that come one by one.
class Surveyor {
 public:
  Surveyor(const Lagrangian& lagrangian, int coordinates)
      : lagrangian_(lagrangian),
        n_(coordinates),
        ranges_q_(n_),
        ranges_v_(n_),
        ranges_p_(n_),
        p_(n_),
        force_(n_) {
    const std::size_t rows = 2 * n_ + 1 + lagrangian.rows(Order::gradient);
    q_ = storage_.reserve(rows * batch);
    v_ = q_ + n_ * batch;
    t_ = v_ + n_ * batch;
    out_ = t_ + batch;
  }

  /// Place for the next point: coordinate a stands at q[a*batch], v likewise.
  double* q() { return q_ + count_; }
  double* v() { return v_ + count_; }

  void take(double t, bool end) {
    end_[count_] = end;
    t_[count_++] = t;
    if (count_ == batch) evaluate();
  }

  Survey finish() {
    if (count_ > 0) evaluate();
    found_.q = widths(ranges_q_);
    found_.v = widths(ranges_v_);
    found_.p = widths(ranges_p_);
    return std::move(found_);
  }

 private:
  void evaluate() {
    for (std::size_t row = 0; row < 2 * n_ + 1; ++row)
      std::fill(q_ + row * batch + count_, q_ + (row + 1) * batch, q_[row * batch + count_ - 1]);
    lagrangian_.evaluate({batch, batch, q_, v_, t_}, Order::gradient, out_, scratch_);
    for (int i = 0; i < count_; ++i) read(i);
    count_ = 0;
  }

  /// p = M v + C q + a + ∂R/∂v. In E = p·v − L the terms linear in v cancel:
  /// E = ½ vᵀMv + v·∂R/∂v − R.
  void read(int i) {
    const Structure& s = lagrangian_.structure();
    const auto q = [&](int a) { return q_[a * batch + i]; };
    const auto v = [&](int a) { return v_[a * batch + i]; };
    double energy = -out_[i];
    std::fill(p_.begin(), p_.end(), 0.0);
    std::fill(force_.begin(), force_.end(), 0.0);
    for (const Triplet& m : s.mass) {
      p_[m.row] += m.value * v(m.column);
      energy += 0.5 * v(m.row) * m.value * v(m.column);
    }
    for (const Triplet& c : s.gyroscopic) {
      p_[c.row] += c.value * q(c.column);
      force_[c.column] += c.value * v(c.row);
    }
    for (std::size_t a = 0; a < s.linear.size(); ++a) p_[a] += s.linear[a];
    for (std::size_t k = 0; k < s.gradient.size(); ++k) {
      const int a = s.gradient[k] - static_cast<int>(n_);
      const double slope = out_[(1 + k) * batch + i];
      if (a < 0) {
        force_[s.gradient[k]] += slope;
        continue;
      }
      p_[a] += slope;
      energy += v(a) * slope;
    }
    double speed = 0, momentum = 0, force = 0, products = 0;
    for (std::size_t a = 0; a < n_; ++a) {
      ranges_q_[a].add(q(a));
      ranges_v_[a].add(v(a));
      ranges_p_[a].add(p_[a]);
      speed += std::abs(v(a));
      momentum += std::abs(p_[a]);
      force += std::abs(force_[a]);
      products += std::abs(p_[a] * v(a));
    }
    found_.speed = std::max(found_.speed, speed);
    found_.momentum = std::max(found_.momentum, momentum);
    if (!end_[i]) found_.force = std::max(found_.force, force);
    found_.terms = std::max(found_.terms, products + std::abs(energy - products));
    if (std::exchange(first_, false)) found_.energy = energy;
    found_.finite = found_.finite && std::isfinite(energy);
    found_.energy_drift = std::max(found_.energy_drift, std::abs(energy - found_.energy));
  }

  const Lagrangian& lagrangian_;
  std::size_t n_;
  Scratch storage_, scratch_;
  double *q_, *v_, *t_, *out_;
  bool end_[batch] = {};  ///< of the trajectory
  int count_ = 0;
  bool first_ = true;
  Survey found_;
  std::vector<Range> ranges_q_, ranges_v_, ranges_p_;
  std::vector<double> p_, force_;
};

/// At the nodes of an element and the midpoints between them.
Basis make_survey_basis(int degree) {
  const std::vector<double>& nodes = lobatto_barycentric(degree).nodes;
  std::vector<double> points{nodes.front()};
  for (int j = 1; j <= degree; ++j) {
    points.push_back((nodes[j - 1] + nodes[j]) / 2);
    points.push_back(nodes[j]);
  }
  return lobatto_basis(degree, points);
}

const Basis& survey_basis(int degree) {
  static ByDegree<Basis> bases(make_survey_basis);
  return bases.at(degree);
}

}  // namespace

Survey survey(const Lagrangian& lagrangian, const Trajectory& trajectory) {
  if (lagrangian.structure().coordinates != trajectory.coordinates)
    throw std::invalid_argument(fmt::format("a trajectory of {} coordinates for a Lagrangian of {}",
                                            trajectory.coordinates, lagrangian.structure().coordinates));
  const Basis& basis = survey_basis(trajectory.degree);
  Surveyor surveyor(lagrangian, trajectory.coordinates);
  for (int k = 0; k < trajectory.elements(); ++k) {
    const double start = trajectory.times[k], h = trajectory.times[k + 1] - start;
    for (std::size_t i = 0; i < basis.points.size(); ++i) {
      element_point(trajectory, k, basis.row(i), surveyor.q(), surveyor.v(), batch);
      const bool end = (k == 0 && i == 0) || (k + 1 == trajectory.elements() && i + 1 == basis.points.size());
      surveyor.take(start + h * basis.points[i], end);
    }
  }
  return surveyor.finish();
}

std::optional<Survey> observe_energy(const Lagrangian& lagrangian, Solution& solution) {
  solution.energy.reset();
  solution.energy_drift.reset();
  if (!lagrangian.structure().autonomous) return std::nullopt;
  Survey found = survey(lagrangian, solution.trajectory);
  if (!found.finite) return std::nullopt;
  solution.energy = found.energy;
  solution.energy_drift = found.energy_drift;
  return found;
}

}  // namespace extremal
