#include "system/formula_term.hpp"

#include <algorithm>
#include <utility>

namespace extremal::formula {

namespace {

std::uint64_t hash(const std::vector<std::uint32_t>& column) {
  std::uint64_t h = 0xcbf29ce484222325u;  // FNV-1a, by entries
  for (const std::uint32_t entry : column) h = (h ^ entry) * 0x100000001b3u;
  return h;
}

}  // namespace

void TermBuilder::read(const Scope& scope, std::size_t row, std::vector<double>& indices) const {
  indices.clear();
  for (const Slot& slot : scope)
    indices.push_back(slot.column < 0 ? slot.value : indices_[row * depth_ + slot.column]);
}

Scope TermBuilder::fixed(const Scope& scope, std::size_t row) const {
  std::vector<double> values;
  read(scope, row, values);
  Scope result;
  for (const double value : values) result.push_back({-1, value});
  return result;
}

NodeId TermBuilder::input(std::vector<std::uint32_t> column) {
  const std::uint64_t key = hash(column);
  const auto [begin, end] = known_.equal_range(key);
  for (auto it = begin; it != end; ++it)
    if (columns_[it->second] == column) return graph_.input(it->second);
  const auto local = static_cast<std::uint32_t>(columns_.size());
  known_.emplace(key, local);
  columns_.push_back(std::move(column));
  return graph_.input(local);
}

Term TermBuilder::finish() const {
  std::vector<std::uint32_t> used = inputs_of(graph_, body_);
  std::stable_sort(used.begin(), used.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return columns_[a][0] < columns_[b][0]; });
  std::vector<NodeId> replacement(columns_.size());
  for (std::uint32_t k = 0; k < used.size(); ++k) replacement[used[k]] = graph_.input(k);
  Term term{substitute(graph_, body_, replacement), static_cast<int>(used.size()), {}};
  term.table.reserve(rows_ * used.size());
  for (std::size_t row = 0; row < rows_; ++row)
    for (const std::uint32_t local : used) term.table.push_back(columns_[local][row]);
  return term;
}

}  // namespace extremal::formula
