#include "action/discrete_action.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

void DiscreteAction::reset(const Lagrangian& lagrangian, const ElementTables& tables, int elements,
                           bool border, bool condense) {
  lagrangian_ = &lagrangian;
  tables_ = &tables;
  assembly_ = &assembly();
  elimination_ = &elimination();
  border_ = border;
  n_ = tables.coordinates();
  elements_ = elements;
  batches_ = (elements + lanes - 1) / lanes;
  inner_ = tables.inner();
  unknowns_ = tables.unknowns();
  condensation_ = condense ? &tables.condensation() : nullptr;
  const std::size_t m = unknowns_, groups = condense ? condensation_->fronts.groups() : 0;
  sizes_ = {groups * lanes, m * lanes, static_cast<std::size_t>(tables.shape().points) * lanes};
  q_.resize(n_ * sizes_.points);
  v_.resize(tables.shape().velocity_free ? 0 : n_ * sizes_.points);
  t_.resize(sizes_.points);
  rows_.resize(lagrangian.rows(Order::hessian) * sizes_.points);
  matrices_.resize(condense ? batches_ * batch_size() : 0);
  inverses_.resize(condense ? batches_ * sizes_.vector : 0);
  gradients_.resize(batches_ * 3 * lanes);
  work_.resize(2 * sizes_.vector + 4 * lanes);
  nodes.gradient.resize(static_cast<std::size_t>(elements + 1) * n_);
  nodes.border.resize(border ? nodes.gradient.size() : 0);
  if (condense) {
    nodes.chain.resize(std::max(elements - 1, 0), n_);
    for (auto* block : {&nodes.first, &nodes.last, &nodes.first_lower, &nodes.last_lower})
      block->resize(static_cast<std::size_t>(n_) * n_);
  }
  raw_nodes_.resize(nodes.gradient.size());
  start_gradient_.resize(n_);
  end_gradient_.resize(n_);
}

void DiscreteAction::substitute(const Lagrangian& lagrangian, const ElementTables& tables) {
  lagrangian_ = &lagrangian;
  tables_ = &tables;
  v_.resize(std::max(v_.size(), tables.shape().velocity_free ? 0 : n_ * sizes_.points));
  rows_.resize(std::max(rows_.size(), lagrangian.rows(Order::hessian) * sizes_.points));
}

ElementBatch DiscreteAction::batch(const Path& path, int b) {
  return {.h = path.h(b),
          .start = path.start(b),
          .x = path.x(b),
          .q = q_.data(),
          .v = v_.data(),
          .t = lagrangian_->structure().autonomous ? nullptr : t_.data(),
          .rows = rows_.data()};
}

void DiscreteAction::play(const ElementBatch& batch, Order order) {
  assembly_->expand(tables_->shape(), batch);
  const int count = static_cast<int>(sizes_.points);
  lagrangian_->evaluate({count, count, batch.q, batch.v, batch.t}, order, rows_.data(), scratch_);
}

const double* DiscreteAction::rows(const Path& path, int b, Order order) {
  play(batch(path, b), order);
  return rows_.data();
}

void DiscreteAction::clear_sums() {
  action_ = slope_duration_ = residual_ = momentum_scale_ = 0;
  std::fill(nodes.gradient.begin(), nodes.gradient.end(), 0.0);
  std::fill(raw_nodes_.begin(), raw_nodes_.end(), 0.0);
  nodes.border_gradient = 0;
}

/// Sums the values and the gradient of a batch as they are, before condensation.
void DiscreteAction::gather(const Path& path, int b, const double* gradient) {
  const double *action = gradients_.data() + b * 3 * lanes, *slope = action + lanes;
  const int first = b * lanes, last = std::min(elements_, first + lanes);
  double largest[lanes] = {};
  for (int u = 0; u < inner_; ++u)
    for (int lane = 0; lane < lanes; ++lane) {
      const double size = std::abs(gradient[u * lanes + lane]);
      largest[lane] = size > largest[lane] ? size : largest[lane];
    }
  residual_ = std::max(residual_, *std::max_element(largest, largest + lanes));
  for (int k = first; k < last; ++k) {
    const int lane = k - first;
    action_ += action[lane];
    if (border_) slope_duration_ += slope[lane] * (path.mesh()[k + 1] - path.mesh()[k]);
    double* node = raw_nodes_.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) {
      const double g = gradient[(inner_ + a) * lanes + lane];
      node[a] += g;
      momentum_scale_ = std::max(momentum_scale_, std::abs(g));
    }
  }
}

void DiscreteAction::gather_gradient(int b) {
  const double* gradient = reduced(b);
  const int first = b * lanes, last = std::min(elements_, first + lanes);
  for (int k = first; k < last; ++k) {
    double* node = nodes.gradient.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) node[a] += gradient[(inner_ + a) * lanes + k - first];
  }
  if (!border_) return;
  double taken[lanes];
  eliminated(b, gradient, gradient + sizes_.vector, taken);
  for (int k = first; k < last; ++k) nodes.border_gradient -= taken[k - first];
}

/// Σ x_j y_j / d_j of each lane: what elimination takes from the product of two vectors.
void DiscreteAction::eliminated(int b, const double* x, const double* y, double* sum) const {
  const Fronts& fronts = condensation_->fronts;
  const double* inverse = inverses_.data() + b * sizes_.vector;
  std::fill_n(sum, lanes, 0.0);
  for (int f = 0; f < fronts.count(); ++f) {
    const FrontView& front = fronts.data()[f];
    for (int j = 0; j < front.pivots; ++j, inverse += lanes) {
      const int u = front.unknown[j] * lanes;
      for (int lane = 0; lane < lanes; ++lane) sum[lane] += x[u + lane] * y[u + lane] * inverse[lane];
    }
  }
}

void DiscreteAction::finish_sums() {
  for (int a = 0; a < n_; ++a) {
    start_gradient_[a] = raw_nodes_[a];
    end_gradient_[a] = raw_nodes_[static_cast<std::size_t>(elements_) * n_ + a];
  }
  for (std::size_t k = n_; k < static_cast<std::size_t>(elements_) * n_; ++k)
    residual_ = std::max(residual_, std::abs(raw_nodes_[k]));
  double sum = action_;
  for (double g : raw_nodes_) sum += g;
  finite_ = std::isfinite(sum) && std::isfinite(residual_) && std::isfinite(slope_duration_);
  nodes.border_gradient += slope_duration_;
}

void DiscreteAction::evaluate_plain(const Path& path) {
  clear_sums();
  for (int b = 0; b < batches_; ++b) {
    const ElementBatch elements = batch(path, b);
    play(elements, Order::gradient);
    double *sums = gradients_.data() + b * 3 * lanes, *gradient = work_.data();
    assembly_->gradient(tables_->shape(), elements, sums, gradient, border_ ? sums + lanes : nullptr);
    gather(path, b, gradient);
  }
  finish_sums();
}

void DiscreteAction::evaluate_gradient(const Path& path) {
  const Fronts& fronts = condensation_->fronts;
  clear_sums();
  for (int b = 0; b < batches_; ++b) {
    const ElementBatch elements = batch(path, b);
    play(elements, Order::gradient);
    double *sums = gradients_.data() + b * 3 * lanes, *gradient = reduced(b);
    assembly_->gradient(tables_->shape(), elements, sums, gradient, border_ ? sums + lanes : nullptr);
    gather(path, b, gradient);
    elimination_->reduce(fronts.data(), fronts.count(), matrix(b), inverses_.data() + b * sizes_.vector,
                         gradient, work_.data());
    gather_gradient(b);
  }
  finish_sums();
}

/// ∂²S/∂x∂T and ∂²S/∂T² from those with the elements' lengths: d/dT = Σ (h_k/T) ∂/∂h_k.
void DiscreteAction::evaluate_border(const Path& path, const ElementBatch& elements, const double* gradient,
                                     double* row, double* corner) {
  assembly_->border(tables_->shape(), elements, gradient, row, corner);
  for (int lane = 0; lane < lanes; ++lane) {
    const double share = elements.h[lane] / path.duration();
    corner[lane] *= share * share;
    for (int u = 0; u < unknowns_; ++u) row[u * lanes + lane] *= share;
  }
}

void DiscreteAction::visit(const Path& path, bool hessian,
                           const std::function<void(int batch, const BatchValues&)>& use) {
  clear_sums();
  const std::size_t count = hessian ? tables_->entries().row.size() * lanes : 0;
  entries_.resize(std::max(entries_.size(), count));
  for (int b = 0; b < batches_; ++b) {
    const ElementBatch elements = batch(path, b);
    play(elements, hessian ? Order::hessian : Order::gradient);
    double *sums = gradients_.data() + b * 3 * lanes, *gradient = work_.data(),
           *row = gradient + sizes_.vector;
    assembly_->gradient(tables_->shape(), elements, sums, gradient, border_ ? sums + lanes : nullptr);
    gather(path, b, gradient);
    if (hessian) {
      std::fill_n(entries_.begin(), count, 0.0);
      assembly_->hessian(tables_->shape(), elements, tables_->entries().slots.data(), entries_.data());
      if (border_) evaluate_border(path, elements, gradient, row, sums + 2 * lanes);
    }
    use(b, {gradient, hessian ? entries_.data() : nullptr, hessian && border_ ? row : nullptr,
            sums + 2 * lanes});
  }
  finish_sums();
}

void DiscreteAction::evaluate(const Path& path) {
  const Fronts& fronts = condensation_->fronts;
  clear_sums();
  std::fill_n(nodes.chain.diagonal(0), static_cast<std::size_t>(nodes.chain.blocks()) * n_ * n_, 0.0);
  for (auto* block : {&nodes.first, &nodes.last, &nodes.border}) std::fill(block->begin(), block->end(), 0.0);
  nodes.corner = 0;
  nodes.negative = 0;
  nodes.pivot_ratio = 1;
  for (int b = 0; b < batches_; ++b) {
    const ElementBatch elements = batch(path, b);
    play(elements, Order::hessian);
    double *sums = gradients_.data() + b * 3 * lanes, *gradient = reduced(b);
    assembly_->gradient(tables_->shape(), elements, sums, gradient, border_ ? sums + lanes : nullptr);
    gather(path, b, gradient);
    elimination_->clear(fronts.data(), fronts.count(), matrix(b), fronts.ends(), 2 * n_);
    assembly_->hessian(tables_->shape(), elements, condensation_->slots.data(), matrix(b));
    if (border_) evaluate_border(path, elements, gradient, gradient + sizes_.vector, sums + 2 * lanes);
    double *negative = work_.data() + 2 * sizes_.vector, *ratio = negative + lanes;
    elimination_->condense(fronts.data(), fronts.count(), matrix(b), fronts.ends(), 2 * n_, gradient,
                           1 + border_, inverses_.data() + b * sizes_.vector, negative, ratio, work_.data());
    for (int lane = 0; lane < std::min(lanes, elements_ - b * lanes); ++lane) {
      nodes.negative += static_cast<int>(negative[lane]);
      if (!(ratio[lane] >= nodes.pivot_ratio)) nodes.pivot_ratio = ratio[lane];
    }
    gather_gradient(b);
    n_ < lanes ? gather_schur(b) : gather_large_schur(b);
    if (border_) gather_border(b);
  }
  if (n_ >= lanes) mirror_blocks();
  finish_sums();
}

void DiscreteAction::expand_step(std::span<const double> node_step, double duration_step,
                                 AlignedDoubles& step) const {
  const Fronts& fronts = condensation_->fronts;
  step.resize(batches_ * sizes_.vector);
  alignas(64) double step_h[lanes];
  std::fill_n(step_h, lanes, duration_step);
  for (int b = 0; b < batches_; ++b) {
    double *x = step.data() + b * sizes_.vector, *ends = x + static_cast<std::size_t>(inner_) * lanes;
    for (int lane = 0; lane < lanes; ++lane) {
      const std::size_t k = std::min(b * lanes + lane, elements_ - 1);
      for (int a = 0; a < 2 * n_; ++a) ends[a * lanes + lane] = node_step[k * n_ + a];
    }
    const double* gradient = reduced(b);
    elimination_->expand_step(fronts.data(), fronts.count(), matrix(b), inverses_.data() + b * sizes_.vector,
                              gradient, border_ ? gradient + sizes_.vector : nullptr, step_h, x);
  }
}

void DiscreteAction::element_hessian(const Path& path, int k, std::span<double> hessian,
                                     std::span<double> gradient) {
  const int b = k / lanes, lane = k % lanes;
  const ElementBatch elements = batch(path, b);
  play(elements, Order::hessian);
  const ElementTables::Entries& entries = tables_->entries();
  AlignedDoubles values(entries.row.size() * lanes), sums(3 * lanes);
  assembly_->gradient(tables_->shape(), elements, sums.data(), work_.data(), nullptr);
  assembly_->hessian(tables_->shape(), elements, entries.slots.data(), values.data());
  for (int i = 0; i < unknowns_; ++i) gradient[i] = work_[i * lanes + lane];
  std::fill(hessian.begin(), hessian.end(), 0.0);
  for (std::size_t e = 0; e < entries.row.size(); ++e)
    hessian[static_cast<std::size_t>(entries.row[e]) * unknowns_ + entries.column[e]] =
        values[e * lanes + lane];
}

/// M, C and a do not depend on active parameters: what does is a Lagrangian of its own, ∂R/∂p.
double DiscreteAction::parameter_slope(const Path& path, int parameter, AlignedDoubles& mixed) {
  ElementShape shape = tables_->shape();
  shape.mass_count = shape.gyroscopic_count = shape.linear_count = 0;
  mixed.resize(batches_ * sizes_.vector);
  const int count = static_cast<int>(sizes_.points);
  double sum = 0;
  for (int b = 0; b < batches_; ++b) {
    const ElementBatch elements = batch(path, b);
    assembly_->expand(shape, elements);
    lagrangian_->sensitivity({count, count, elements.q, elements.v, elements.t}, parameter, rows_.data(),
                             scratch_);
    double* action = gradients_.data() + b * 3 * lanes;
    assembly_->gradient(shape, elements, action, mixed.data() + b * sizes_.vector, nullptr);
    for (int lane = 0; lane < std::min(lanes, elements_ - b * lanes); ++lane) sum += action[lane];
  }
  return sum;
}

}  // namespace extremal
