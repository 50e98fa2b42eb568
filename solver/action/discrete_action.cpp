#include "action/discrete_action.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "machine/simd.hpp"
#include "machine/workers.hpp"

namespace extremal {

namespace {

/// Work for a thread, in multiplications or so, below which it is left asleep.
constexpr double least_share = 3e5;

}  // namespace

void DiscreteAction::reset(const Lagrangian& lagrangian, const ElementTables& tables, int elements,
                           bool border, Condense condensed) {
  const bool condense = condensed != Condense::nothing;
  condense_ = condensed;
  lagrangian_ = &lagrangian;
  tables_ = &tables;
  assembly_ = &assembly();
  elimination_ = &elimination();
  border_ = border;
  momenta_ = {};
  costs_ = {};
  cost_slopes_.clear();
  n_ = tables.coordinates();
  elements_ = elements;
  batches_ = (elements + lanes_ - 1) / lanes_;
  inner_ = tables.inner();
  unknowns_ = tables.unknowns();
  condensation_ = condense ? &tables.condensation() : nullptr;
  const std::size_t m = unknowns_, groups = condense ? condensation_->fronts.groups() : 0;
  sizes_ = {groups * lanes_, m * lanes_, static_cast<std::size_t>(tables.shape().points) * lanes_,
            static_cast<std::size_t>(of_ends + 2 * n_) * lanes_};
  set_buffers(condense);
  // Memory that grows only: what a smaller action leaves need not be cleared for the next.
  const auto provide = [](AlignedDoubles& x, std::size_t size) {
    if (x.size() < size) x.resize(size);
  };
  provide(matrices_, condense ? batches_ * batch_size() : 0);
  provide(inverses_, condense ? batches_ * sizes_.vector : 0);
  sums_.resize(batches_ * sizes_.sums);
  nodes.gradient.resize(static_cast<std::size_t>(elements + 1) * n_);
  nodes.border.resize(border ? nodes.gradient.size() : 0);
  const bool to_nodes = condensed == Condense::to_nodes;
  if (to_nodes) nodes.chain.resize(std::max(elements - 1, 0), n_);
  for (auto* block : {&nodes.first, &nodes.last, &nodes.first_lower, &nodes.last_lower})
    block->resize(to_nodes ? static_cast<std::size_t>(n_) * n_ : 0);
  nodes.negative = 0;
  nodes.pivot_ratio = 1;
  raw_nodes_.resize(nodes.gradient.size());
  start_gradient_.resize(n_);
  end_gradient_.resize(n_);
  corners_.clear();
  closed_ = nullptr;
}

void DiscreteAction::substitute(const Lagrangian& lagrangian, const ElementTables& tables) {
  lagrangian_ = &lagrangian;
  tables_ = &tables;
  sizes_.points = static_cast<std::size_t>(tables.shape().points) * lanes_;
  for (Buffers& buffers : buffers_) make_room(buffers);
}

/// One, or where there is that much work one for each thread.
void DiscreteAction::set_buffers(bool condense) {
  const double points = static_cast<double>(lagrangian_->rows(Order::hessian) * sizes_.points);
  const double work = condense ? points + condensation_->fronts.work() : 0;
  const bool shared = batches_ > 1 && batches_ * work > least_share * threads();
  buffers_.resize(shared ? threads() : 1);
  for (Buffers& buffers : buffers_) make_room(buffers);
}

void DiscreteAction::make_room(Buffers& buffers) const {
  buffers.q.resize(n_ * sizes_.points);
  buffers.v.resize(tables_->shape().velocity_free ? 0 : n_ * sizes_.points);
  buffers.t.resize(sizes_.points);
  buffers.rows.resize(lagrangian_->rows(Order::hessian) * sizes_.points);
  buffers.work.resize(2 * sizes_.vector + 2 * lanes_);
}

/// evaluate(buffers, b) for each batch in any order, gather(b) from the first to the last: sums do not depend
/// on how many threads there are. Several threads end at the deadline only before they begin.
template <class Evaluate, class Gather>
void DiscreteAction::for_batches(const Evaluate& evaluate, const Gather& gather) {
  if (buffers_.size() == 1) {
    for (int b = 0; b < batches_ && !stop(); ++b) {
      evaluate(buffers_.front(), b);
      gather(b);
    }
    return;
  }
  if (stop()) return;
  share_out(batches_, [&](int thread, int b) { evaluate(buffers_[thread], b); });
  for (int b = 0; b < batches_; ++b) gather(b);
}

ElementBatch DiscreteAction::batch(const Path& path, int b, Buffers& buffers) {
  return {.h = path.h(b),
          .start = path.start(b),
          .x = path.x(b),
          .q = buffers.q.data(),
          .v = buffers.v.data(),
          .t = lagrangian_->structure().autonomous ? nullptr : buffers.t.data(),
          .rows = buffers.rows.data()};
}

void DiscreteAction::play(const ElementBatch& batch, Order order, Buffers& buffers) {
  assembly_->expand(tables_->shape(), batch);
  const int count = static_cast<int>(sizes_.points);
  lagrangian_->evaluate({count, count, batch.q, batch.v, batch.t}, order, buffers.rows.data(),
                        buffers.scratch);
}

void DiscreteAction::assemble_gradient(const ElementBatch& elements, int b, double* gradient) {
  assembly_->gradient(tables_->shape(), elements, sums(b, of_action), gradient,
                      border_ ? sums(b, of_slope) : nullptr);
  keep_gradient(b, gradient);
}

const double* DiscreteAction::rows(const Path& path, int b, Order order) {
  Buffers& buffers = buffers_.front();
  play(batch(path, b, buffers), order, buffers);
  return buffers.rows.data();
}

void DiscreteAction::evaluate_plain(const Path& path) {
  clear_sums();
  Buffers& buffers = buffers_.front();
  for (int b = 0; b < batches_ && !stop(); ++b) {
    const ElementBatch elements = batch(path, b, buffers);
    play(elements, Order::gradient, buffers);
    assemble_gradient(elements, b, buffers.work.data());
    gather(path, b);
  }
  add_costs(path);
  finish_sums();
}

void DiscreteAction::evaluate_gradient(const Path& path) {
  clear_sums();
  extended_ready_ = extended_on_ && extended_.evaluate(*lagrangian_, *tables_, path);
  reduce_gradient(path);
}

void DiscreteAction::put_change(const Path& path, const PathChange& change) {
  extended_.evaluate_change(*lagrangian_, path, change);
  changed_ = true;
  put_gradient(path);
  changed_ = false;
  for (const Corner& corner : corners_) {
    const std::size_t first = static_cast<std::size_t>(corner.node) * n_;
    double u = -corner.u;
    for (int a = 0; a < n_; ++a) u += corner.normal[a] * change.nodes[first + a];
    add_force(corner, u, nodes.gradient.data() + first);
  }
}

void DiscreteAction::put_gradient(const Path& path) {
  clear_sums();
  extended_ready_ = true;
  reduce_gradient(path);
}

/// With the factors there are.
void DiscreteAction::reduce_gradient(const Path& path) {
  const Fronts& fronts = condensation_->fronts;
  const auto evaluate = [&](Buffers& buffers, int b) {
    if (extended_ready_) {
      take_extended(b, reduced(b));
    } else {
      const ElementBatch elements = batch(path, b, buffers);
      play(elements, Order::gradient, buffers);
      assemble_gradient(elements, b, reduced(b));
    }
    elimination_->reduce(fronts.data(), fronts.count(), matrix(b), inverses_.data() + b * sizes_.vector,
                         reduced(b), buffers.work.data());
  };
  for_batches(evaluate, [&](int b) {
    gather(path, b);
    gather_gradient(b);
  });
  if (tables_->kinks()) measure_corners(path);
  add_costs(path);
  finish_sums();
}

/// ∂²S/∂x∂T and ∂²S/∂T² from those with the elements' lengths: d/dT = Σ (h_k/T) ∂/∂h_k.
void DiscreteAction::evaluate_border(const Path& path, const ElementBatch& elements, double* row,
                                     double* corner) {
  assembly_->border(tables_->shape(), elements, row, corner);
  for (int lane = 0; lane < lanes_; ++lane) {
    const double share = elements.h[lane] / path.duration();
    corner[lane] *= share * share;
    for (int u = 0; u < unknowns_; ++u) row[u * lanes_ + lane] *= share;
  }
}

void DiscreteAction::visit(const Path& path, bool hessian,
                           const std::function<void(int batch, const BatchValues&)>& use) {
  clear_sums();
  const std::size_t count = hessian ? tables_->entries().row.size() * lanes_ : 0;
  entries_.resize(std::max(entries_.size(), count));
  Buffers& buffers = buffers_.front();
  for (int b = 0; b < batches_ && !stop(); ++b) {
    const ElementBatch elements = batch(path, b, buffers);
    play(elements, hessian ? Order::hessian : Order::gradient, buffers);
    double *corner = sums(b, of_corner), *gradient = buffers.work.data(), *row = gradient + sizes_.vector;
    assemble_gradient(elements, b, gradient);
    gather(path, b);
    if (hessian) {
      std::fill_n(entries_.begin(), count, 0.0);
      assembly_->hessian(tables_->shape(), elements, tables_->entries().slots.data(), entries_.data());
      if (border_) evaluate_border(path, elements, row, corner);
    }
    use(b, {gradient, hessian ? entries_.data() : nullptr, hessian && border_ ? row : nullptr, corner,
            border_ ? sums(b, of_slope) : nullptr});
  }
  add_costs(path);
  finish_sums();
}

/// One batch: values, derivatives, inner unknowns eliminated.
void DiscreteAction::condense(const Path& path, int b, Buffers& buffers) {
  const Fronts& fronts = condensation_->fronts;
  const ElementBatch elements = batch(path, b, buffers);
  play(elements, Order::hessian, buffers);
  double* const gradient = reduced(b);
  assemble_gradient(elements, b, gradient);
  if (extended_ready_) take_extended(b, gradient);
  elimination_->clear(fronts.data(), fronts.count(), matrix(b), fronts.ends(), 2 * n_);
  assembly_->hessian(tables_->shape(), elements, condensation_->slots.data(), matrix(b));
  if (border_) evaluate_border(path, elements, gradient + sizes_.vector, sums(b, of_corner));
  elimination_->condense(fronts.data(), fronts.count(), matrix(b), fronts.ends(), 2 * n_, gradient,
                         1 + border_, inverses_.data() + b * sizes_.vector, sums(b, of_negative),
                         sums(b, of_ratio), buffers.work.data());
}

void DiscreteAction::evaluate(const Path& path) {
  clear_sums();
  extended_ready_ = extended_on_ && extended_.evaluate(*lagrangian_, *tables_, path);
  nodes.negative = 0;
  nodes.pivot_ratio = 1;
  const auto evaluate = [&](Buffers& buffers, int b) { condense(path, b, buffers); };
  if (condense_ == Condense::elements) {
    for_batches(evaluate, [&](int b) {
      gather(path, b);
      gather_pivots(b);
    });
    return finish_sums();
  }
  std::fill_n(nodes.chain.diagonal(0), static_cast<std::size_t>(nodes.chain.blocks()) * n_ * n_, 0.0);
  for (auto* block : {&nodes.first, &nodes.last, &nodes.border}) std::fill(block->begin(), block->end(), 0.0);
  nodes.corner = 0;
  for_batches(evaluate, [&](int b) {
    gather(path, b);
    gather_pivots(b);
    gather_gradient(b);
    n_ < most_lanes ? gather_schur(b) : gather_large_schur(b);
    if (border_) gather_border(b);
  });
  if (n_ >= most_lanes) mirror_blocks();
  if (tables_->kinks()) {
    measure_corners(path);
    add_corners();
  }
  add_costs(path);
  add_stiffness_of_costs();
  finish_sums();
}

void DiscreteAction::expand_step(std::span<const double> node_step, double duration_step,
                                 AlignedDoubles& step) const {
  const Fronts& fronts = condensation_->fronts;
  step.resize(batches_ * sizes_.vector);
  alignas(64) double step_h[most_lanes];
  std::fill_n(step_h, lanes_, duration_step);
  for (int b = 0; b < batches_; ++b) {
    double *x = step.data() + b * sizes_.vector, *ends = x + static_cast<std::size_t>(inner_) * lanes_;
    for (int lane = 0; lane < lanes_; ++lane) {
      const std::size_t k = std::min(b * lanes_ + lane, elements_ - 1);
      for (int a = 0; a < 2 * n_; ++a) ends[a * lanes_ + lane] = node_step[k * n_ + a];
    }
    const double* gradient = reduced(b);
    elimination_->expand_step(fronts.data(), fronts.count(), matrix(b), inverses_.data() + b * sizes_.vector,
                              gradient, border_ ? gradient + sizes_.vector : nullptr, step_h, x);
  }
}

void DiscreteAction::element_hessian(const Path& path, int k, std::span<double> hessian,
                                     std::span<double> gradient) {
  const int b = k / lanes_, lane = k % lanes_;
  Buffers& buffers = buffers_.front();
  const ElementBatch elements = batch(path, b, buffers);
  play(elements, Order::hessian, buffers);
  const ElementTables::Entries& entries = tables_->entries();
  AlignedDoubles values(entries.row.size() * lanes_), sums(lanes_);
  assembly_->gradient(tables_->shape(), elements, sums.data(), buffers.work.data(), nullptr);
  assembly_->hessian(tables_->shape(), elements, entries.slots.data(), values.data());
  for (int i = 0; i < unknowns_; ++i) gradient[i] = buffers.work[i * lanes_ + lane];
  std::fill(hessian.begin(), hessian.end(), 0.0);
  for (std::size_t e = 0; e < entries.row.size(); ++e)
    hessian[static_cast<std::size_t>(entries.row[e]) * unknowns_ + entries.column[e]] =
        values[e * lanes_ + lane];
}

/// M, C and a do not depend on active parameters: what does is a Lagrangian of its own, ∂R/∂p.
double DiscreteAction::parameter_slope(const Path& path, int parameter, AlignedDoubles& mixed,
                                       double& by_duration) {
  ElementShape shape = tables_->shape();
  shape.mass_count = shape.gyroscopic_count = shape.linear_count = 0;
  mixed.resize(batches_ * sizes_.vector);
  const int count = static_cast<int>(sizes_.points);
  Buffers& buffers = buffers_.front();
  double sum = 0;
  by_duration = 0;
  for (int b = 0; b < batches_; ++b) {
    const ElementBatch elements = batch(path, b, buffers);
    assembly_->expand(shape, elements);
    lagrangian_->sensitivity({count, count, elements.q, elements.v, elements.t}, parameter,
                             buffers.rows.data(), buffers.scratch);
    double *const action = sums(b, of_action), *const slope = sums(b, of_slope);
    assembly_->gradient(shape, elements, action, mixed.data() + b * sizes_.vector, slope);
    for (int lane = 0; lane < std::min(lanes_, elements_ - b * lanes_); ++lane) {
      sum += action[lane];
      by_duration += slope[lane] * path.lengths()[b * lanes_ + lane];
    }
  }
  return sum;
}

void DiscreteAction::put_load(const Path& path, const AlignedDoubles& load, double on_duration) {
  clear_sums();
  const Fronts& fronts = condensation_->fronts;
  const auto take = [&](Buffers& buffers, int b) {
    std::copy_n(load.data() + b * sizes_.vector, sizes_.vector, reduced(b));
    std::fill_n(sums(b, of_action), lanes_, 0.0);
    std::fill_n(sums(b, of_slope), lanes_, 0.0);
    keep_gradient(b, reduced(b));
    elimination_->reduce(fronts.data(), fronts.count(), matrix(b), inverses_.data() + b * sizes_.vector,
                         reduced(b), buffers.work.data());
  };
  for_batches(take, [&](int b) {
    gather(path, b);
    gather_gradient(b);
  });
  slope_duration_ = on_duration;
  const std::span<const double> given = std::exchange(momenta_, {});
  finish_sums();
  momenta_ = given;
}

}  // namespace extremal
