#include "solve/fit/observations.hpp"

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"

namespace extremal {

namespace {

constexpr int batch = 64;  ///< points; a multiple of the lanes and of 64 bytes

int whole_batches(int rows) { return (rows + batch - 1) / batch * batch; }

/// Adds ½ q'ᵀMq' + q'ᵀCq + aᵀq' of a formula that has one.
void add_quadratic(const Structure& s, const double* q, const double* v, int stride, double* value) {
  for (const Triplet& m : s.mass)
    for (int i = 0; i < stride; ++i)
      value[i] +=
          0.5 * m.value * v[m.row * std::ptrdiff_t(stride) + i] * v[m.column * std::ptrdiff_t(stride) + i];
  for (const Triplet& c : s.gyroscopic)
    for (int i = 0; i < stride; ++i)
      value[i] += c.value * v[c.row * std::ptrdiff_t(stride) + i] * q[c.column * std::ptrdiff_t(stride) + i];
  for (std::size_t a = 0; a < s.linear.size(); ++a)
    for (int i = 0; i < stride; ++i) value[i] += s.linear[a] * v[a * stride + i];
}

}  // namespace

int Observations::count() const {
  std::size_t sum = 0;
  for (const ObservedColumn& column : columns) sum += column.values.size();
  return static_cast<int>(sum);
}

double Observations::size() const {
  double sum = 0;
  for (const ObservedColumn& column : columns)
    for (const ObservedValue& observed : column.values) sum += std::pow(observed.value / observed.sigma, 2);
  return std::sqrt(sum);
}

Observer::Observer(const Observations& data, int coordinates)
    : data_(data),
      n_(coordinates),
      rows_(static_cast<int>(data.t.size())),
      stride_(whole_batches(rows_)),
      count_(data.count()),
      element_(rows_) {
  t_.resize(stride_);
  for (int i = 0; i < stride_; ++i) t_[i] = data.t[std::min(i, rows_ - 1)];
}

/// Where each time lies on the mesh, and the polynomials there.
void Observer::place(const Path& path) {
  const std::span<const double> mesh = path.mesh();
  if (degree_ == path.degree() && duration_ == path.duration() && std::ranges::equal(mesh_, mesh)) return;
  degree_ = path.degree();
  duration_ = path.duration();
  mesh_.assign(mesh.begin(), mesh.end());
  const std::size_t functions = degree_ + 1;
  basis_.resize(2 * functions * rows_);
  for (int i = 0; i < rows_; ++i) {
    const double tau = data_.t[i] / path.duration();
    const auto after = std::upper_bound(mesh.begin() + 1, mesh.end() - 1, tau);
    const int k = static_cast<int>(after - mesh.begin()) - 1;
    element_[i] = k;
    double* const value = basis_.data() + 2 * functions * i;
    double place = (tau - mesh[k]) / path.lengths()[k];
    // A time that the end rounds to is the end's.
    if (std::abs(place - 1) < 1e-14) place = 1;
    lobatto_basis_at(degree_, place, value, value + functions);
  }
}

void Observer::sample(const Trajectory& trajectory, AlignedDoubles& q, AlignedDoubles& v) {
  width_ = trajectory.coordinates;
  q.resize(static_cast<std::size_t>(width_) * stride_);
  v.resize(q.size());
  const std::size_t functions = degree_ + 1, n = width_;
  for (int i = 0; i < rows_; ++i) {
    const double* const value = basis_.data() + 2 * functions * i;
    const std::size_t first = element_[i] * functions * n;
    const double *const nodes = trajectory.nodes.data() + first, *const slopes =
                                                                     trajectory.slopes.data() + first;
    for (std::size_t a = 0; a < n; ++a) {
      double position = 0, velocity = 0;
      for (std::size_t j = 0; j < functions; ++j) {
        position += value[j] * nodes[j * n + a];
        velocity += value[j] * slopes[j * n + a];
      }
      q[a * stride_ + i] = position;
      v[a * stride_ + i] = velocity;
    }
  }
  for (int a = 0; a < width_; ++a)
    for (AlignedDoubles* x : {&q, &v})
      std::fill(row(*x, a) + rows_, row(*x, a) + stride_, row(*x, a)[rows_ - 1]);
}

/// q'' from the slopes at the nodes.
void Observer::accelerate(const Trajectory& trajectory) {
  a_.assign(static_cast<std::size_t>(n_) * stride_, 0);
  const std::size_t functions = degree_ + 1, n = trajectory.coordinates;
  for (int i = 0; i < rows_; ++i) {
    const int k = element_[i];
    const double* const derivative = basis_.data() + 2 * functions * i + functions;
    const double* const slopes = trajectory.slopes.data() + k * functions * n;
    for (int a = 0; a < n_; ++a) {
      double sum = 0;
      for (std::size_t j = 0; j < functions; ++j) sum += derivative[j] * slopes[j * n + a];
      row(a_, a)[i] = sum / trajectory.length(k);
    }
  }
}

bool Observer::residuals(const Path& path, const ObservedFormulas& formulas, std::span<double> to) {
  place(path);
  sample(trajectory_of(path), q_, v_);
  gradients_known_ = accelerations_known_ = false;
  bool finite = true;
  std::size_t next = 0;
  for (const ObservedColumn& column : data_.columns) {
    const double* computed = nullptr;
    if (column.kind == Observable::coordinate) {
      computed = row(q_, column.index);
    } else if (column.kind == Observable::velocity) {
      computed = row(v_, column.index);
    } else {
      const Lagrangian& formula = *formulas[column.index];
      out_.resize(stride_);
      formula.evaluate({stride_, stride_, q_.data(), v_.data(), t_.data()}, Order::value, out_.data(),
                       scratch_);
      add_quadratic(formula.structure(), q_.data(), v_.data(), stride_, out_.data());
      computed = out_.data();
    }
    for (const ObservedValue& observed : column.values) {
      double difference = observed.value - computed[observed.row];
      if (column.turn > 0) difference = std::remainder(difference, column.turn);
      to[next] = difference / observed.sigma;
      finite = finite && std::isfinite(to[next++]);
    }
  }
  return finite;
}

/// Of each formula by q and q'.
void Observer::gradients(const ObservedFormulas& formulas) {
  by_.resize(formulas.size());
  for (std::size_t f = 0; f < formulas.size(); ++f) {
    const Structure& s = formulas[f]->structure();
    out_.resize(static_cast<std::size_t>(formulas[f]->rows(Order::gradient)) * stride_);
    formulas[f]->evaluate({stride_, stride_, q_.data(), v_.data(), t_.data()}, Order::gradient, out_.data(),
                          scratch_);
    AlignedDoubles& by = by_[f];
    by.assign(2 * static_cast<std::size_t>(n_) * stride_, 0);
    for (std::size_t k = 0; k < s.gradient.size(); ++k)
      std::copy_n(out_.data() + (1 + k) * stride_, stride_, row(by, s.gradient[k]));
    for (const Triplet& m : s.mass)
      for (int i = 0; i < stride_; ++i) row(by, n_ + m.row)[i] += m.value * row(v_, m.column)[i];
    for (const Triplet& c : s.gyroscopic)
      for (int i = 0; i < stride_; ++i) {
        row(by, n_ + c.row)[i] += c.value * row(q_, c.column)[i];
        row(by, c.column)[i] += c.value * row(v_, c.row)[i];
      }
    for (std::size_t a = 0; a < s.linear.size(); ++a)
      for (int i = 0; i < stride_; ++i) row(by, n_ + static_cast<int>(a))[i] += s.linear[a];
  }
  gradients_known_ = true;
}

/// A time t lies at t/T of the path, so that with T its place there changes.
void Observer::derivatives(const Path& path, const ElementTables& tables, const ObservedFormulas& formulas,
                           const Step& step, const ProblemChange& change, double* to, std::ptrdiff_t stride) {
  Path moved;
  moved.reset(tables, path.mesh(), path.duration(), path.lengths());
  moved.add(step.nodes, step.inner, 1);
  moved.load_ends();
  sample(trajectory_of(moved), dq_, dv_);
  if (step.duration != 0) {
    if (!accelerations_known_) accelerate(trajectory_of(path));
    accelerations_known_ = true;
    const double rate = step.duration / path.duration();
    for (int a = 0; a < n_; ++a)
      for (int i = 0; i < rows_; ++i) {
        row(dq_, a)[i] -= rate * t_[i] * row(v_, a)[i];
        row(dv_, a)[i] -= rate * (row(v_, a)[i] + t_[i] * row(a_, a)[i]);
      }
  }
  if (!gradients_known_) gradients(formulas);
  AlignedDoubles total(stride_);
  for (const ObservedColumn& column : data_.columns) {
    const double* by = nullptr;
    if (column.kind == Observable::coordinate) {
      by = row(dq_, column.index);
    } else if (column.kind == Observable::velocity) {
      by = row(dv_, column.index);
    } else {
      std::fill(total.begin(), total.end(), 0.0);
      AlignedDoubles& slopes = by_[column.index];
      for (int a = 0; a < n_; ++a)
        for (int i = 0; i < rows_; ++i)
          total[i] += row(slopes, a)[i] * row(dq_, a)[i] + row(slopes, n_ + a)[i] * row(dv_, a)[i];
      const Lagrangian& formula = *formulas[column.index];
      out_.resize(static_cast<std::size_t>(formula.rows(Order::gradient)) * stride_);
      for (std::size_t p = 0; p < change.parameters.size(); ++p) {
        if (change.parameters[p] == 0) continue;
        formula.sensitivity({stride_, stride_, q_.data(), v_.data(), t_.data()}, static_cast<int>(p),
                            out_.data(), scratch_);
        for (int i = 0; i < rows_; ++i) total[i] += change.parameters[p] * out_[i];
      }
      by = total.data();
    }
    for (const ObservedValue& observed : column.values) {
      *to = -by[observed.row] / observed.sigma;
      to += stride;
    }
  }
}

}  // namespace extremal
