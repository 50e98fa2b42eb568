#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "system/expression_inverse.hpp"
#include "system/hamiltonian.hpp"
#include "system/merged_sets.hpp"
#include "system/momentum_forms.hpp"

/// \file The Legendre transform on the expression graph, of a Hamiltonian made of quadratic forms of the
/// momenta and of square roots of such forms. With H = ½ pᵀ a p + bᵀ p + c, all of them functions of q and t,
///   L = ½ (v − b)ᵀ a⁻¹ (v − b) − c.
/// With H = g √K + bᵀ p, K = ½ pᵀ a p + βᵀ p + c, let u = v − b = g (a p + β)/(2 √K). Then p = a⁻¹(2 √K u/g −
/// β), which put into K gives K (1 − 2 uᵀ a⁻¹ u/g²) = c₀ with c₀ = c − ½ βᵀ a⁻¹ β, and
///   L = −g √(c₀/e) e − uᵀ a⁻¹ β,   e = 1 − 2 uᵀ a⁻¹ u/g².
/// The momenta fall into blocks that H_pp couples. Terms of H are cut into summands, and those of one block
/// are put together; blocks that are made alike become the rows of one term, so sums stay sums.

namespace extremal {

namespace {

using expression_matrix::Matrix;
using expression_matrix::Row;

/// A block of one momentum, or of several that are coupled, with what contributes to it.
struct Block {
  std::vector<std::uint32_t> members;                      ///< coordinates, by first appearance
  std::vector<std::pair<std::size_t, int>> contributions;  ///< forms, and which row of each
};

/// Blocks that are made alike.
struct Alike {
  Block first;
  std::vector<std::uint32_t> inputs;  ///< of the first block: velocities of its members, then what it reads
  std::vector<std::vector<std::uint32_t>> bound;   ///< for each contribution, the input of what it reads
  std::vector<std::vector<std::uint32_t>> member;  ///< for each contribution, the member of its momenta
  std::vector<std::uint32_t> table;
};

/// Of a block: ½ pᵀ a p + bᵀ p + c, or where g does not vanish g √(½ pᵀ a p + βᵀ p + under) + bᵀ p + c.
struct BlockForms {
  Matrix a;
  Row b, beta;
  Scaled c, under, g;
};

class Transform {
 public:
  explicit Transform(const LagrangianGraph& h) : h_(h), algebra_(l_.graph) {
    l_.coordinates = h.coordinates;
    l_.uniforms = h.uniforms;
    l_.parameters = h.parameters;
    l_.replaceable = h.replaceable;
  }

  std::optional<LagrangianGraph> run();

 private:
  MergedSets coupled_momenta() const;
  std::vector<Block> blocks(MergedSets coupled) const;
  void add_alike(const Block& block, std::map<std::vector<std::uint32_t>, Alike>& alike) const;
  std::optional<BlockForms> forms_of(const Alike& alike);
  Scaled half_form(const Matrix& m, std::span<const Scaled> u);
  Scaled form(const Matrix& m, std::span<const Scaled> u, std::span<const Scaled> w);
  std::optional<Matrix> inverse_of(const Matrix& a, const Block& block);
  bool add_term(const Alike& alike);

  Scaled times(Scaled x, Scaled y) { return algebra_.multiply(x, y); }

  const LagrangianGraph& h_;
  LagrangianGraph l_;
  Algebra algebra_;
  MomentumForms parts_;
};

[[noreturn]] void refuse_singular(const Block& block) {
  std::vector<int> momenta(block.members.begin(), block.members.end());
  std::ranges::sort(momenta);
  throw SingularHamiltonian("the second derivative of the Hamiltonian by the momenta is singular",
                            std::move(momenta));
}

/// The momenta that forms couple, as sets of coordinates.
MergedSets Transform::coupled_momenta() const {
  const auto n = static_cast<std::uint32_t>(h_.coordinates);
  MergedSets coupled(n);
  for (const MomentumForm& part : parts_.forms) {
    const PhaseRows& rows = parts_.rows[part.rows];
    for (int row = 0; row < rows.rows(); ++row) {
      for (const MomentumForm::Second& second : part.a)
        coupled.merge(rows.at(row, second.row) - n, rows.at(row, second.column) - n);
      for (const std::uint32_t m : part.root ? part.momenta : std::vector<std::uint32_t>{})
        coupled.merge(rows.at(row, m) - n, rows.at(row, part.momenta.front()) - n);
    }
  }
  return coupled;
}

std::vector<Block> Transform::blocks(MergedSets coupled) const {
  const auto n = static_cast<std::uint32_t>(h_.coordinates);
  std::vector<Block> result(n);
  std::vector<bool> seen(n);
  for (std::size_t k = 0; k < parts_.forms.size(); ++k) {
    const MomentumForm& part = parts_.forms[k];
    for (int row = 0; row < parts_.rows[part.rows].rows(); ++row) {
      Block& block = result[coupled.find(parts_.rows[part.rows].at(row, part.momenta.front()) - n)];
      block.contributions.emplace_back(k, row);
      for (const std::uint32_t m : part.momenta) {
        const std::uint32_t member = parts_.rows[part.rows].at(row, m) - n;
        if (!seen[member]) block.members.push_back(member);
        seen[member] = true;
      }
    }
  }
  for (std::uint32_t a = 0; a < n; ++a)
    if (!seen[a]) refuse_singular({{a}, {}});
  std::erase_if(result, [](const Block& block) { return block.members.empty(); });
  return result;
}

/// Two blocks are alike if the same parts contribute, bound alike. Coordinates, time and parameters that
/// coincide are one input; uniforms stay apart, as they may be equal by chance.
void Transform::add_alike(const Block& block, std::map<std::vector<std::uint32_t>, Alike>& alike) const {
  const auto n = static_cast<std::uint32_t>(h_.coordinates);
  Alike found{block, {}, {}, {}, {}};
  std::unordered_map<std::uint32_t, std::uint32_t> position;
  for (const std::uint32_t member : block.members) {
    position.emplace(n + member, found.inputs.size());
    found.inputs.push_back(n + member);
  }
  std::vector<std::uint32_t> signature{static_cast<std::uint32_t>(block.members.size())};
  for (const auto& [k, row] : block.contributions) {
    const MomentumForm& part = parts_.forms[k];
    const PhaseRows& rows = parts_.rows[part.rows];
    signature.push_back(static_cast<std::uint32_t>(k));
    std::vector<std::uint32_t>& member = found.member.emplace_back();
    for (const std::uint32_t m : part.momenta) member.push_back(position.at(rows.at(row, m)));
    std::vector<std::uint32_t>& bound = found.bound.emplace_back();
    for (const std::uint32_t m : part.read) {
      const std::uint32_t global = rows.at(row, m);
      const auto next = static_cast<std::uint32_t>(found.inputs.size());
      const std::uint32_t at =
          rows.kinds[m] == PhaseInput::uniform ? next : position.emplace(global, next).first->second;
      bound.push_back(at);
      if (at == next) found.inputs.push_back(global);
    }
    signature.insert(signature.end(), member.begin(), member.end());
    signature.insert(signature.end(), bound.begin(), bound.end());
  }
  const std::vector<std::uint32_t> row = found.inputs;
  Alike& group = alike.try_emplace(std::move(signature), std::move(found)).first->second;
  group.table.insert(group.table.end(), row.begin(), row.end());
}

/// The forms of some blocks that are alike, in the inputs of their term. Nothing where roots stand beside
/// quadratic forms.
std::optional<BlockForms> Transform::forms_of(const Alike& group) {
  const Block& block = group.first;
  const std::size_t k = block.members.size();
  const std::uint32_t first_uniform = 2 * h_.coordinates + 1 + h_.parameters;
  const bool single = group.table.size() == group.inputs.size();
  BlockForms forms{Matrix(k, Row(k)), Row(k), Row(k), {}, {}, {}};
  int roots = 0, others = 0;
  for (std::size_t e = 0; e < block.contributions.size(); ++e) {
    const MomentumForm& part = parts_.forms[block.contributions[e].first];
    std::vector<Scaled> replacement(parts_.rows[part.rows].arity);
    for (std::size_t m = 0; m < part.read.size(); ++m) {
      const std::uint32_t global = group.inputs[group.bound[e][m]];
      replacement[part.read[m]] = single && global >= first_uniform  // a number, as no other row differs
                                      ? algebra_.constant(h_.uniforms[global - 2 * h_.coordinates - 1])
                                      : algebra_.input(group.bound[e][m]);
    }
    const auto add = [&](Scaled& sum, Scaled f) {
      if (f.zero()) return;
      Scaled value = algebra_.import(l_.graph, f.node, replacement);
      value.factor *= f.factor;
      sum = algebra_.add(sum, value);
    };
    const auto member = [&](std::uint32_t input) {
      return group.member[e][std::ranges::find(part.momenta, input) - part.momenta.begin()];
    };
    for (const MomentumForm::Second& second : part.a)
      add(forms.a[member(second.row)][member(second.column)], second.value);
    for (const Partial& b : part.b) add((part.root ? forms.beta : forms.b)[member(b.input)], b.value);
    add(part.root ? forms.under : forms.c, part.c);
    add(forms.g, part.g);
    roots += part.root;
    others += !part.root && !part.a.empty();
  }
  if (roots > 1 || (roots == 1 && others > 0)) return std::nullopt;
  return forms;
}

/// ½ uᵀ m u.
Scaled Transform::half_form(const Matrix& m, std::span<const Scaled> u) {
  Scaled sum;
  for (std::size_t i = 0; i < u.size(); ++i) {
    Scaled row;
    for (std::size_t j = 0; j <= i; ++j)
      row = algebra_.add(row, times(algebra_.constant(j < i ? 2 : 1), times(m[i][j], u[j])));
    sum = algebra_.add(sum, times(row, u[i]));
  }
  return times(algebra_.constant(0.5), sum);
}

/// uᵀ m w.
Scaled Transform::form(const Matrix& m, std::span<const Scaled> u, std::span<const Scaled> w) {
  Scaled sum;
  for (std::size_t i = 0; i < u.size(); ++i) {
    Scaled row;
    for (std::size_t j = 0; j < w.size(); ++j) row = algebra_.add(row, times(m[i][j], w[j]));
    sum = algebra_.add(sum, times(row, u[i]));
  }
  return sum;
}

std::optional<Matrix> Transform::inverse_of(const Matrix& a, const Block& block) {
  if (a.size() > most_coupled_momenta)
    throw std::invalid_argument("the Hamiltonian couples " + std::to_string(a.size()) + " momenta; " +
                                std::to_string(most_coupled_momenta) + " are the most");
  try {
    return expression_matrix::inverse(algebra_, a);
  } catch (const expression_matrix::Singular&) {
    refuse_singular(block);
  }
}

/// Adds the term of some blocks that are alike. False where it has no expression.
bool Transform::add_term(const Alike& group) {
  const std::optional<BlockForms> f = forms_of(group);
  if (!f) return false;
  const std::optional<Matrix> m = inverse_of(f->a, group.first);
  if (!m) return false;
  std::vector<Scaled> v;
  for (std::uint32_t i = 0; i < f->b.size(); ++i) v.push_back(algebra_.input(i));
  Scaled value;
  if (f->g.zero()) {
    // ½ vᵀ m v − vᵀ m b + (½ bᵀ m b − c): written out, so that c cancels where b makes it, as in (p − A)².
    value = algebra_.add(algebra_.subtract(half_form(*m, v), form(*m, v, f->b)),
                         algebra_.subtract(half_form(*m, f->b), f->c));
  } else {
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = algebra_.subtract(v[i], f->b[i]);
    const Scaled rest = algebra_.subtract(f->under, half_form(*m, f->beta));
    if (rest.zero()) refuse_singular(group.first);
    const Scaled over = algebra_.reciprocal(times(f->g, f->g));
    const Scaled e =
        algebra_.subtract(algebra_.constant(1), times(algebra_.constant(4), times(half_form(*m, v), over)));
    const bool positive = l_.graph.is_constant(rest.node) && rest.factor > 0;
    const Scaled root = positive ? times(algebra_.unary(Op::sqrt, rest), algebra_.unary(Op::sqrt, e))
                                 : times(e, algebra_.unary(Op::sqrt, times(rest, algebra_.reciprocal(e))));
    value = -algebra_.add(algebra_.add(times(f->g, root), form(*m, v, f->beta)), f->c);
  }
  l_.terms.push_back({algebra_.node(value), static_cast<int>(group.inputs.size()), group.table});
  return true;
}

std::optional<LagrangianGraph> Transform::run() {
  std::optional<MomentumForms> parts = momentum_forms(h_, algebra_);
  if (!parts) return std::nullopt;
  parts_ = *std::move(parts);
  for (const MomentumForms::Rest& rest : parts_.rest) {
    const PhaseRows& rows = parts_.rows[rest.rows];
    l_.terms.push_back({algebra_.node(-rest.value), rows.arity, rows.table});
  }
  std::map<std::vector<std::uint32_t>, Alike> alike;
  for (const Block& block : blocks(coupled_momenta())) add_alike(block, alike);
  for (const auto& [signature, group] : alike)
    if (!add_term(group)) return std::nullopt;
  return std::move(l_);
}

}  // namespace

std::optional<LagrangianGraph> legendre_transform(const LagrangianGraph& hamiltonian) {
  return Transform(hamiltonian).run();
}

}  // namespace extremal
