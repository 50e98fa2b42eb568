#include "system/tape_lagrangian.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "system/structure.hpp"

namespace extremal {

namespace {

int gradient_row(const Structure& s, int z) {
  return static_cast<int>(std::lower_bound(s.gradient.begin(), s.gradient.end(), z) - s.gradient.begin());
}

int hessian_row(const Structure& s, HessianEntry entry) {
  const auto order = [](const HessianEntry& a, const HessianEntry& b) {
    return std::pair(a.row, a.column) < std::pair(b.row, b.column);
  };
  return static_cast<int>(std::lower_bound(s.hessian.begin(), s.hessian.end(), entry, order) -
                          s.hessian.begin());
}

/// The rows of Lagrangian::evaluate.
Tape::Contribution contribution(const std::shared_ptr<const Kernel>& shared, const Structure& s,
                                Order order) {
  const Kernel& kernel = *shared;
  Tape::Contribution result{shared, {kernel.value}, {}};
  const bool first = order != Order::value, second = order == Order::hessian;
  if (first)
    for (const Partial& p : kernel.gradient) result.roots.push_back(p.value);
  if (second)
    for (const SecondPartial& p : kernel.hessian) result.roots.push_back(p.value);
  const int gradients = static_cast<int>(s.gradient.size());
  for (int r = 0; r < kernel.rows; ++r) {
    result.rows.push_back(0);
    if (first)
      for (const Partial& p : kernel.gradient)
        result.rows.push_back(1 + gradient_row(s, state_index(kernel, r, p.input, s.coordinates)));
    if (second)
      for (const SecondPartial& p : kernel.hessian)
        result.rows.push_back(1 + gradients + hessian_row(s, hessian_entry(kernel, r, p, s.coordinates)));
  }
  return result;
}

/// The rows of Lagrangian::sensitivity.
Tape::Contribution contribution(const std::shared_ptr<const Kernel>& shared, const Structure& s,
                                const Kernel::Sensitivity& by) {
  const Kernel& kernel = *shared;
  Tape::Contribution result{shared, {by.value}, {}};
  for (const Partial& p : by.gradient) result.roots.push_back(p.value);
  for (int r = 0; r < kernel.rows; ++r) {
    result.rows.push_back(0);
    for (const Partial& p : by.gradient)
      result.rows.push_back(1 + gradient_row(s, state_index(kernel, r, p.input, s.coordinates)));
  }
  return result;
}

/// Whether an exponent is made of numbers and active ones: then its value decides on the instructions.
bool replaces_exponent(const LagrangianGraph& l) {
  const auto is_number = [&](const Term& term, std::uint32_t input) {
    return term.table[input] > 2u * static_cast<std::uint32_t>(l.coordinates);
  };
  const auto replaces = [&](const Term& term) {
    return std::ranges::any_of(nodes_of(l.graph, term.body), [&](NodeId id) {
      if (l.graph[id].op != Op::pow) return false;
      const std::vector<std::uint32_t> inputs = inputs_of(l.graph, l.graph[id].b);
      return !inputs.empty() && std::ranges::all_of(inputs, [&](auto k) { return is_number(term, k); });
    });
  };
  return std::ranges::any_of(l.terms, replaces);
}

}  // namespace

TapeLagrangian::TapeLagrangian(const LagrangianGraph& lagrangian, std::shared_ptr<const Kinks> kinks)
    : kinks_(std::move(kinks)), uniforms_(lagrangian.uniforms) {
  Analysis analysis = analyse(lagrangian);
  structure_ = std::move(analysis.structure);
  if (lagrangian.replaceable && !replaces_exponent(lagrangian))
    numbers_ = std::make_shared<const StructureNumbers>(std::move(analysis.numbers));
  for (const Order order : {Order::value, Order::gradient, Order::hessian}) {
    std::vector<Tape::Contribution> all;
    for (const auto& kernel : analysis.kernels) all.push_back(contribution(kernel, structure_, order));
    orders_[static_cast<int>(order)] = Tape(all, rows(order), lagrangian.uniforms);
  }
  for (Tape& tape : orders_)
    for (const Tape& other : orders_) tape.fit(other);
  for (int k = 0; k < structure_.parameters; ++k) {
    std::vector<Tape::Contribution> all;
    for (const auto& kernel : analysis.kernels)
      for (const Kernel::Sensitivity& s : kernel->sensitivities)
        if (s.parameter == static_cast<std::uint32_t>(k)) all.push_back(contribution(kernel, structure_, s));
    sensitivities_.emplace_back(all, rows(Order::gradient), lagrangian.uniforms);
  }
}

std::shared_ptr<const Lagrangian> TapeLagrangian::with(std::span<const double> parameters) const {
  if (!numbers_) return nullptr;
  const auto other = std::make_shared<TapeLagrangian>(*this);
  std::ranges::copy(parameters, other->uniforms_.begin());
  const std::span<const double> uniforms = other->uniforms_;
  if (!numbers_->put(uniforms, other->structure_) && structure_.quadratic) return nullptr;
  for (Tape& tape : other->orders_) tape = tape.with(uniforms);
  if (!kinks_) return other;
  other->kinks_ = kinks_->with(parameters);
  return other->kinks_ ? other : nullptr;
}

void TapeLagrangian::evaluate(const Points& points, Order order, double* out, Scratch& scratch) const {
  orders_[static_cast<int>(order)].play(points, out, scratch);
}

std::size_t TapeLagrangian::doubles(int points) const {
  std::size_t most = 0;
  for (const Tape& tape : orders_) most = std::max(most, tape.doubles(points));
  for (const Tape& tape : sensitivities_) most = std::max(most, tape.doubles(points));
  return most;
}

void TapeLagrangian::sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const {
  if (parameter < 0 || parameter >= structure_.parameters)
    throw std::out_of_range("parameter " + std::to_string(parameter) + " of " +
                            std::to_string(structure_.parameters));
  sensitivities_[parameter].play(points, out, scratch);
}

std::shared_ptr<const Lagrangian> make_lagrangian(LagrangianGraph graph) {
  return std::make_shared<TapeLagrangian>(graph, find_kinks(graph));
}

}  // namespace extremal
