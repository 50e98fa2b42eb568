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
  void add(const double* row, int count) {
    for (int i = 0; i < count; ++i) {
      least = row[i] < least ? row[i] : least;
      most = row[i] > most ? row[i] : most;
    }
  }
};

std::vector<double> widths(const std::vector<Range>& ranges) {
  std::vector<double> result;
  for (const Range& range : ranges) result.push_back(range.most - range.least);
  return result;
}

double largest(const double* row, int count) {
  double result = 0;
  for (int i = 0; i < count; ++i) result = row[i] > result ? row[i] : result;
  return result;
}

/// A Lagrangian evaluated over points that come one by one.
class Surveyor {
 public:
  Surveyor(const Lagrangian& lagrangian, int coordinates)
      : lagrangian_(lagrangian), n_(coordinates), ranges_q_(n_), ranges_v_(n_), ranges_p_(n_) {
    const std::size_t rows = 5 * n_ + 1 + sums + lagrangian.rows(Order::gradient);
    q_ = storage_.reserve(rows * batch);
    v_ = q_ + n_ * batch;
    t_ = v_ + n_ * batch;
    inertial_ = t_ + batch;
    p_ = inertial_ + n_ * batch;
    force_ = p_ + n_ * batch;
    for (double*& sum : sums_) sum = force_ + (n_ + (&sum - sums_)) * batch;
    out_ = sums_[sums - 1] + batch;
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
    read();
    measure();
    count_ = 0;
  }

  /// p = M v + C q + a + ∂R/∂v. In E = p·v − L the terms linear in v cancel:
  /// E = ½ vᵀMv + v·∂R/∂v − R.
  void read() {
    const Structure& s = lagrangian_.structure();
    double* const energy = sums_[energies];
    for (int i = 0; i < batch; ++i) energy[i] = -out_[i];
    std::fill(p_, p_ + 2 * n_ * batch, 0.0);
    for (const Triplet& m : s.mass) {
      const double *v = v_ + m.row * batch, *other = v_ + m.column * batch;
      for (int i = 0; i < batch; ++i) {
        p_[m.row * batch + i] += m.value * other[i];
        energy[i] += 0.5 * v[i] * m.value * other[i];
      }
    }
    std::copy(p_, force_, inertial_);
    for (const Triplet& c : s.gyroscopic)
      for (int i = 0; i < batch; ++i) {
        p_[c.row * batch + i] += c.value * q_[c.column * batch + i];
        force_[c.column * batch + i] += c.value * v_[c.row * batch + i];
      }
    for (std::size_t a = 0; a < s.linear.size(); ++a)
      for (int i = 0; i < batch; ++i) p_[a * batch + i] += s.linear[a];
    for (std::size_t k = 0; k < s.gradient.size(); ++k) {
      const std::size_t row = s.gradient[k];
      const double* const slope = out_ + (1 + k) * batch;
      double* const to = row < n_ ? force_ + row * batch : p_ + (row - n_) * batch;
      for (int i = 0; i < batch; ++i) to[i] += slope[i];
      if (row < n_) continue;
      const double* const v = v_ + (row - n_) * batch;
      for (int i = 0; i < batch; ++i) energy[i] += v[i] * slope[i];
    }
  }

  /// Of p the terms M q' of constant masses and the others count each by itself: in phase space they cancel.
  void measure() {
    const double* const energy = sums_[energies];
    std::fill(sums_[speeds], sums_[speeds] + 4 * batch, 0.0);
    double work[batch] = {};  // p·q'
    for (std::size_t a = 0; a < n_; ++a) {
      const double *v = v_ + a * batch, *p = p_ + a * batch, *force = force_ + a * batch,
                   *inertial = inertial_ + a * batch;
      ranges_q_[a].add(q_ + a * batch, count_);
      ranges_v_[a].add(v, count_);
      ranges_p_[a].add(p, count_);
      for (int i = 0; i < batch; ++i) {
        sums_[speeds][i] += std::abs(v[i]);
        const double terms = std::abs(inertial[i]) + std::abs(p[i] - inertial[i]);
        sums_[momenta][i] += terms;
        sums_[forces][i] += std::abs(force[i]);
        sums_[products][i] += terms * std::abs(v[i]);
        work[i] += p[i] * v[i];
      }
    }
    if (std::exchange(first_, false)) found_.energy = energy[0];
    for (int i = 0; i < count_; ++i) {
      if (end_[i]) sums_[forces][i] = 0;
      sums_[products][i] += std::abs(energy[i] - work[i]);
      found_.finite = found_.finite && std::isfinite(energy[i]);
      found_.energy_drift = std::max(found_.energy_drift, std::abs(energy[i] - found_.energy));
    }
    found_.speed = std::max(found_.speed, largest(sums_[speeds], count_));
    found_.momentum = std::max(found_.momentum, largest(sums_[momenta], count_));
    found_.force = std::max(found_.force, largest(sums_[forces], count_));
    found_.terms = std::max(found_.terms, largest(sums_[products], count_));
  }

  /// Rows that are made of those of all coordinates.
  enum Sum { energies, speeds, momenta, forces, products, sums };

  const Lagrangian& lagrangian_;
  std::size_t n_;
  Scratch storage_, scratch_;
  double *q_, *v_, *t_, *inertial_, *p_, *force_, *sums_[sums], *out_;
  bool end_[batch] = {};  ///< of the trajectory
  int count_ = 0;
  bool first_ = true;
  Survey found_;
  std::vector<Range> ranges_q_, ranges_v_, ranges_p_;
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

Survey with_inertia(Survey found, const Lagrangian& lagrangian, const Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates;
  const std::vector<double> rest(n);
  std::vector<double> q(n), v(n);
  Scratch scratch;
  for (int k = 0; k < 2 * trajectory.elements(); ++k) {
    trajectory.in_element(k / 2, k % 2 == 0 ? 0 : 0.5, q, v);
    const std::vector<double> mass = evaluate_at(lagrangian, q, rest, 0, Order::hessian, scratch).vv;
    double momenta = 0, products = 0;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) {
        const double term = std::abs(mass[a * n + b] * v[b]);
        momenta += term;
        products += term * std::abs(v[a]);
      }
    if (!std::isfinite(products)) continue;
    found.momentum = std::max(found.momentum, momenta);
    found.terms = std::max(found.terms, products);
  }
  return found;
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

std::vector<double> element_energies(const Lagrangian& lagrangian, std::span<const double> nodes,
                                     std::span<const double> weights, const Trajectory& trajectory) {
  if (!lagrangian.structure().autonomous || trajectory.elements() > most_energies) return {};
  std::vector<double> energies(trajectory.elements()), q(trajectory.coordinates), v(q.size());
  Scratch scratch;
  for (int k = 0; k < trajectory.elements(); ++k)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      trajectory.in_element(k, nodes[i], q, v);
      const PointValues at = evaluate_at(lagrangian, q, v, 0, Order::gradient, scratch);
      double energy = -at.value;
      for (std::size_t a = 0; a < v.size(); ++a) energy += at.dv[a] * v[a];
      energies[k] += weights[i] * energy;
    }
  return energies;
}

}  // namespace extremal
