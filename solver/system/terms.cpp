#include "system/terms.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace extremal {

namespace {

/// Rows of a sum are written out where that takes no more nodes than this.
constexpr std::size_t most_unrolled = 64;

struct Origin {
  Variable kind;
  std::uint32_t index;
};

class Sorter {
 public:
  explicit Sorter(const LagrangianGraph& l) : l_(l) {}
  std::vector<Group> run();

 private:
  Origin origin(std::uint32_t global) const;
  bool active(std::uint32_t uniform) const { return uniform < static_cast<std::uint32_t>(l_.parameters); }
  /// Whether the value may stand in the expressions.
  bool is_number(const Origin& o) const { return o.kind == Variable::uniform && !active(o.index); }
  void check(const Term& term, const std::vector<std::uint32_t>& used) const;
  const std::uint32_t* row(const Term& term, int r) const {
    return term.table.data() + std::size_t(r) * term.arity;
  }
  std::vector<std::uint32_t> pattern(const Term& term, const std::vector<std::uint32_t>& used, int r) const;
  void sort(const Term& term);
  void write_out(const Term& term, const std::vector<std::uint32_t>& used, int r);
  Group tabulate(const Term& term, const std::vector<std::uint32_t>& used,
                 const std::vector<int>& rows) const;

  const LagrangianGraph& l_;
  Group single_;
  std::unordered_map<std::uint32_t, std::uint32_t> single_inputs_;  ///< by global input
  std::vector<Group> groups_;
};

Origin Sorter::origin(std::uint32_t global) const {
  const auto n = static_cast<std::uint32_t>(l_.coordinates);
  if (global < n) return {Variable::coordinate, global};
  if (global < 2 * n) return {Variable::velocity, global - n};
  if (global == 2 * n) return {Variable::time, 0};
  const std::uint32_t k = global - 2 * n - 1;
  return {active(k) && !l_.replaceable ? Variable::parameter : Variable::uniform, k};
}

void Sorter::check(const Term& term, const std::vector<std::uint32_t>& used) const {
  const std::size_t inputs = 2 * static_cast<std::size_t>(l_.coordinates) + 1 + l_.uniforms.size();
  if (!used.empty() && used.back() >= static_cast<std::uint32_t>(term.arity))
    throw std::invalid_argument("a term reads input " + std::to_string(used.back()) + " of " +
                                std::to_string(term.arity));
  if (term.arity > 0 && term.table.size() % term.arity != 0)
    throw std::invalid_argument("a table of " + std::to_string(term.table.size()) +
                                " entries for a term of " + std::to_string(term.arity) + " inputs");
  for (const std::uint32_t global : term.table)
    if (global >= inputs)
      throw std::invalid_argument("a term names input " + std::to_string(global) + "; there are " +
                                  std::to_string(inputs));
}

/// Rows with equal patterns can share a kernel: what each input is, and which earlier one it repeats.
std::vector<std::uint32_t> Sorter::pattern(const Term& term, const std::vector<std::uint32_t>& used,
                                           int r) const {
  std::vector<std::uint32_t> result;
  for (std::size_t m = 0; m < used.size(); ++m) {
    const std::uint32_t global = row(term, r)[used[m]];
    const Origin o = origin(global);
    std::size_t first = 0;
    if (o.kind == Variable::parameter) first = o.index;
    if (o.kind == Variable::coordinate || o.kind == Variable::velocity)
      while (row(term, r)[used[first]] != global) ++first;
    result.push_back(static_cast<std::uint32_t>(o.kind));
    result.push_back(static_cast<std::uint32_t>(first));
  }
  return result;
}

void Sorter::write_out(const Term& term, const std::vector<std::uint32_t>& used, int r) {
  Part part{term.body, std::vector<Binding>(term.arity)};
  for (const std::uint32_t m : used) {
    const std::uint32_t global = row(term, r)[m];
    const Origin o = origin(global);
    if (is_number(o)) {
      part.inputs[m] = {true, l_.uniforms[o.index], 0};
      continue;
    }
    const auto [at, added] = single_inputs_.emplace(global, single_.kinds.size());
    if (added) {
      single_.kinds.push_back(o.kind);
      single_.table.push_back(o.index);
    }
    part.inputs[m] = {false, 0, at->second};
  }
  single_.parts.push_back(std::move(part));
}

Group Sorter::tabulate(const Term& term, const std::vector<std::uint32_t>& used,
                       const std::vector<int>& rows) const {
  Group group;
  group.rows = static_cast<int>(rows.size());
  Part part{term.body, std::vector<Binding>(term.arity)};
  std::vector<std::uint32_t> columns;  // the term's input for each of the group's
  std::map<std::uint32_t, std::uint32_t> known;
  for (const std::uint32_t m : used) {
    const std::uint32_t global = row(term, rows[0])[m];
    const Origin o = origin(global);
    const auto value = [&](int r) { return l_.uniforms[origin(row(term, r)[m]).index]; };
    if (std::all_of(rows.begin(), rows.end(), [&](int r) {
          const Origin at = origin(row(term, r)[m]);
          return is_number(at) && value(r) == value(rows[0]);
        })) {
      part.inputs[m] = {true, value(rows[0]), 0};
      continue;
    }
    const auto next = static_cast<std::uint32_t>(columns.size());
    const std::uint32_t input =
        o.kind == Variable::uniform ? next : known.emplace(global, next).first->second;
    part.inputs[m] = {false, 0, input};
    if (input != next) continue;
    columns.push_back(m);
    group.kinds.push_back(o.kind);
  }
  for (const int r : rows)
    for (const std::uint32_t m : columns) group.table.push_back(origin(row(term, r)[m]).index);
  group.parts.push_back(std::move(part));
  return group;
}

void Sorter::sort(const Term& term) {
  const std::vector<std::uint32_t> used = inputs_of(l_.graph, term.body);
  check(term, used);
  const std::size_t size = nodes_of(l_.graph, term.body).size();
  std::map<std::vector<std::uint32_t>, std::vector<int>> patterns;
  for (int r = 0; r < term.rows(); ++r) patterns[pattern(term, used, r)].push_back(r);
  for (const auto& [pattern, rows] : patterns) {
    if (rows.size() == 1 || rows.size() * size <= most_unrolled) {
      for (const int r : rows) write_out(term, used, r);
    } else {
      groups_.push_back(tabulate(term, used, rows));
    }
  }
}

std::vector<Group> Sorter::run() {
  for (const Term& term : l_.terms) sort(term);
  if (!single_.parts.empty()) groups_.insert(groups_.begin(), std::move(single_));
  return std::move(groups_);
}

}  // namespace

std::vector<Group> group_terms(const LagrangianGraph& lagrangian) { return Sorter(lagrangian).run(); }

}  // namespace extremal
