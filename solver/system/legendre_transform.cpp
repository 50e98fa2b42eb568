#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "system/derivative.hpp"
#include "system/hamiltonian.hpp"

/// \file The Legendre transform of a Hamiltonian that is quadratic in the momenta, on the expression graph.
/// With H = ½ pᵀ a p + bᵀ p + c, all of them functions of q and t,
///   L = ½ (v − b)ᵀ a⁻¹ (v − b) − c.
/// The matrix a falls into blocks of momenta that it couples. Terms of H are cut into summands, and those of
/// one block are put together; blocks that are made alike become the rows of one term, so sums stay sums.

namespace extremal {

namespace {

/// Larger blocks that are not numbers have no expression of reasonable size.
constexpr int most_symbolic = 16;
constexpr int most_by_minors = 3;

using Matrix = std::vector<std::vector<Scaled>>;

enum class Input : std::uint8_t { coordinate, momentum, time, parameter, uniform };

Input kind_of(const LagrangianGraph& h, std::uint32_t global) {
  const auto n = static_cast<std::uint32_t>(h.coordinates);
  if (global < n) return Input::coordinate;
  if (global < 2 * n) return Input::momentum;
  if (global == 2 * n) return Input::time;
  return global < 2 * n + 1 + h.parameters ? Input::parameter : Input::uniform;
}

/// Rows of a term whose inputs are of the same kinds.
struct Rows {
  NodeId body;
  int arity;
  std::vector<Input> kinds;
  std::vector<std::uint32_t> table;
  int rows() const { return arity ? static_cast<int>(table.size()) / arity : 1; }
  std::uint32_t at(int row, std::uint32_t input) const {
    return table[static_cast<std::size_t>(row) * arity + input];
  }
};

std::vector<Rows> rows_by_kind(const LagrangianGraph& h) {
  std::vector<Rows> result;
  for (const Term& term : h.terms) {
    std::map<std::vector<Input>, std::size_t> known;
    for (int r = 0; r < term.rows(); ++r) {
      const std::uint32_t* row = term.table.data() + static_cast<std::size_t>(r) * term.arity;
      std::vector<Input> kinds;
      for (int m = 0; m < term.arity; ++m) kinds.push_back(kind_of(h, row[m]));
      const auto [at, added] = known.emplace(kinds, result.size());
      if (added) result.push_back({term.body, term.arity, kinds, {}});
      std::vector<std::uint32_t>& table = result[at->second].table;
      table.insert(table.end(), row, row + term.arity);
    }
  }
  return result;
}

/// What some momenta of a term contribute: ½ pᵀ a p + bᵀ p + c, in the inputs of the term.
struct Piece {
  struct Second {
    std::uint32_t row, column;  ///< inputs, both orders stand
    Scaled value;
  };
  std::size_t rows;                    ///< which Rows
  std::vector<std::uint32_t> momenta;  ///< inputs
  std::vector<Second> a;
  std::vector<Partial> b;
  Scaled c;
  std::vector<std::uint32_t> read;  ///< inputs that a, b, c are made of
};

/// Sets of numbers that are merged.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::uint32_t find(std::uint32_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void merge(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

class Transform {
 public:
  explicit Transform(const LagrangianGraph& h)
      : h_(h), rows_(rows_by_kind(h)), algebra_(l_.graph), coupled_(h.coordinates) {
    l_.coordinates = h.coordinates;
    l_.uniforms = h.uniforms;
    l_.parameters = h.parameters;
  }

  std::optional<LagrangianGraph> run();

 private:
  /// A block of one momentum, or of several that are coupled, with what contributes to it.
  struct Block {
    std::vector<std::uint32_t> members;                       ///< coordinates, by first appearance
    std::vector<std::pair<std::size_t, int>> contributions;  ///< pieces, and which row of each
  };
  /// Blocks that are made alike.
  struct Alike {
    Block first;
    std::vector<std::uint32_t> inputs;  ///< of the first block: velocities of its members, then what it reads
    std::vector<std::vector<std::uint32_t>> bound;  ///< for each contribution, the input of what it reads
    std::vector<std::vector<std::uint32_t>> member;  ///< for each contribution, the member of its momenta
    std::vector<std::uint32_t> table;
  };

  bool depends(NodeId node, const std::vector<Input>& kinds, std::unordered_map<NodeId, bool>& known) const;
  void cut(Scaled f, const std::vector<Input>& kinds, std::unordered_map<NodeId, bool>& known,
           std::vector<Scaled>& summands, Scaled& rest);
  bool take_apart(std::size_t rows, Scaled summand, Scaled& rest);
  Scaled at_rest(Scaled f, const std::vector<Input>& kinds);
  bool read_terms();
  void couple();
  std::vector<Block> blocks();
  void add_alike(const Block& block, std::map<std::vector<std::uint32_t>, Alike>& alike) const;
  bool add_term(const Alike& alike);
  std::optional<Matrix> inverse(const Matrix& a, const Block& block);
  Matrix inverse_of_numbers(const Matrix& a, const Block& block);
  Matrix inverse_by_minors(const Matrix& a, const Block& block);
  std::optional<Matrix> inverse_by_pivots(const Matrix& a, const Block& block);
  [[noreturn]] static void singular(const Block& block);

  Scaled times(Scaled x, Scaled y) { return algebra_.multiply(x, y); }
  Scaled half(Scaled x) { return times(algebra_.constant(0.5), x); }

  const LagrangianGraph& h_;
  const std::vector<Rows> rows_;
  LagrangianGraph l_;
  Algebra algebra_;
  Sets coupled_;
  std::vector<Piece> pieces_;
};

bool Transform::depends(NodeId node, const std::vector<Input>& kinds,
                        std::unordered_map<NodeId, bool>& known) const {
  for (const NodeId id : nodes_of(l_.graph, node)) {
    const auto [at, added] = known.emplace(id, false);
    if (!added) continue;
    const Node& n = l_.graph[id];
    at->second = n.op == Op::input ? kinds[n.index] == Input::momentum
                                   : (arity(n.op) > 0 && known.at(n.a)) || (arity(n.op) > 1 && known.at(n.b));
  }
  return known.at(node);
}

/// f as a sum: summands that depend on momenta, and the rest. Factors without momenta are distributed.
void Transform::cut(Scaled f, const std::vector<Input>& kinds, std::unordered_map<NodeId, bool>& known,
                    std::vector<Scaled>& summands, Scaled& rest) {
  if (f.zero()) return;
  if (!depends(f.node, kinds, known)) {
    rest = algebra_.add(rest, f);
    return;
  }
  const Node n = l_.graph[f.node];
  if (n.op == Op::add || n.op == Op::sub) {
    cut(algebra_.scaled(f.factor, n.a), kinds, known, summands, rest);
    cut(algebra_.scaled(n.op == Op::add ? f.factor : -f.factor, n.b), kinds, known, summands, rest);
    return;
  }
  const bool product = n.op == Op::mul || n.op == Op::div;
  const bool first = product && depends(n.a, kinds, known), second = product && depends(n.b, kinds, known);
  if (first == second || (n.op == Op::div && second)) {
    summands.push_back(f);
    return;
  }
  const Scaled moving = algebra_.scaled(f.factor, first ? n.a : n.b), other{1, first ? n.b : n.a};
  std::vector<Scaled> parts;
  Scaled still;
  cut(moving, kinds, known, parts, still);
  const Scaled factor = n.op == Op::div ? algebra_.reciprocal(other) : algebra_.scaled(1, other.node);
  for (const Scaled part : parts) summands.push_back(times(part, factor));
  rest = algebra_.add(rest, times(still, factor));
}

/// f with all momenta zero.
Scaled Transform::at_rest(Scaled f, const std::vector<Input>& kinds) {
  if (f.zero()) return f;
  std::vector<Scaled> replacement;
  for (std::uint32_t k = 0; k < kinds.size(); ++k)
    replacement.push_back(kinds[k] == Input::momentum ? Scaled{} : algebra_.input(k));
  Scaled value = algebra_.import(l_.graph, f.node, replacement);
  value.factor *= f.factor;
  return value;
}

/// Makes pieces of a summand, one for each set of momenta that its own second derivatives couple; c goes to
/// the rest where there are several. False where the summand is not quadratic.
bool Transform::take_apart(std::size_t r, Scaled summand, Scaled& rest) {
  const std::vector<Input>& kinds = rows_[r].kinds;
  std::vector<bool> momentum;
  for (const Input kind : kinds) momentum.push_back(kind == Input::momentum);
  std::unordered_map<NodeId, bool> known;
  std::vector<Partial> slopes = differentiate(algebra_, summand, momentum);
  std::vector<Piece::Second> seconds;
  Sets together(kinds.size());
  for (const Partial& slope : slopes) {
    for (const Partial& second : differentiate(algebra_, slope.value, momentum)) {
      if (depends(second.value.node, kinds, known)) return false;
      seconds.push_back({slope.input, second.input, second.value});
      together.merge(slope.input, second.input);
    }
  }
  std::map<std::uint32_t, Piece> pieces;
  for (const Partial& slope : slopes) {
    Piece& piece = pieces[together.find(slope.input)];
    piece.rows = r;
    piece.momenta.push_back(slope.input);
    if (const Scaled b = at_rest(slope.value, kinds); !b.zero()) piece.b.push_back({slope.input, b});
  }
  for (const Piece::Second& second : seconds) pieces[together.find(second.row)].a.push_back(second);
  const Scaled c = at_rest(summand, kinds);
  if (pieces.size() == 1)
    pieces.begin()->second.c = c;
  else
    rest = algebra_.add(rest, c);
  for (auto& [first, piece] : pieces) {
    std::vector<NodeId> nodes;
    for (const Piece::Second& second : piece.a) nodes.push_back(second.value.node);
    for (const Partial& b : piece.b) nodes.push_back(b.value.node);
    if (!piece.c.zero()) nodes.push_back(piece.c.node);
    for (const NodeId node : nodes) {
      const std::vector<std::uint32_t> inputs = inputs_of(l_.graph, node);
      piece.read.insert(piece.read.end(), inputs.begin(), inputs.end());
    }
    std::ranges::sort(piece.read);
    piece.read.erase(std::unique(piece.read.begin(), piece.read.end()), piece.read.end());
    pieces_.push_back(std::move(piece));
  }
  return true;
}

/// Pieces of all terms; what has no momenta becomes a term of L with the opposite sign.
bool Transform::read_terms() {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Rows& rows = rows_[r];
    std::unordered_map<NodeId, bool> known;
    std::vector<Scaled> summands;
    Scaled rest;
    cut(algebra_.import(h_.graph, rows.body), rows.kinds, known, summands, rest);
    for (const Scaled summand : summands)
      if (!take_apart(r, summand, rest)) return false;
    if (!rest.zero()) l_.terms.push_back({algebra_.node(-rest), rows.arity, rows.table});
  }
  return true;
}

void Transform::couple() {
  const auto n = static_cast<std::uint32_t>(h_.coordinates);
  for (const Piece& piece : pieces_)
    for (const Piece::Second& second : piece.a)
      for (int row = 0; row < rows_[piece.rows].rows(); ++row)
        coupled_.merge(rows_[piece.rows].at(row, second.row) - n, rows_[piece.rows].at(row, second.column) - n);
}

std::vector<Transform::Block> Transform::blocks() {
  const auto n = static_cast<std::uint32_t>(h_.coordinates);
  std::vector<Block> result(n);
  std::vector<bool> seen(n);
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Piece& piece = pieces_[k];
    for (int row = 0; row < rows_[piece.rows].rows(); ++row) {
      Block& block = result[coupled_.find(rows_[piece.rows].at(row, piece.momenta.front()) - n)];
      block.contributions.emplace_back(k, row);
      for (const std::uint32_t m : piece.momenta) {
        const std::uint32_t member = rows_[piece.rows].at(row, m) - n;
        if (!seen[member]) block.members.push_back(member);
        seen[member] = true;
      }
    }
  }
  for (std::uint32_t a = 0; a < n; ++a)
    if (!seen[a]) singular({{a}, {}});
  std::erase_if(result, [](const Block& block) { return block.members.empty(); });
  return result;
}

/// Two blocks are alike if the same pieces contribute, bound alike. Coordinates, time and parameters that
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
    const Piece& piece = pieces_[k];
    const Rows& rows = rows_[piece.rows];
    signature.push_back(static_cast<std::uint32_t>(k));
    std::vector<std::uint32_t>& member = found.member.emplace_back();
    for (const std::uint32_t m : piece.momenta) member.push_back(position.at(rows.at(row, m)));
    std::vector<std::uint32_t>& bound = found.bound.emplace_back();
    for (const std::uint32_t m : piece.read) {
      const std::uint32_t global = rows.at(row, m);
      const auto next = static_cast<std::uint32_t>(found.inputs.size());
      const std::uint32_t at =
          rows.kinds[m] == Input::uniform ? next : position.emplace(global, next).first->second;
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

void Transform::singular(const Block& block) {
  std::vector<int> momenta(block.members.begin(), block.members.end());
  std::ranges::sort(momenta);
  throw SingularHamiltonian("the second derivative of the Hamiltonian by the momenta is singular",
                            std::move(momenta));
}

/// Adds the term of some blocks that are alike. False where a⁻¹ has no expression.
bool Transform::add_term(const Alike& group) {
  const Block& block = group.first;
  const std::size_t k = block.members.size();
  const std::uint32_t first_uniform = 2 * h_.coordinates + 1 + h_.parameters;
  const bool single = group.table.size() == group.inputs.size();
  Matrix a(k, std::vector<Scaled>(k));
  std::vector<Scaled> b(k);
  Scaled c;
  for (std::size_t e = 0; e < block.contributions.size(); ++e) {
    const Piece& piece = pieces_[block.contributions[e].first];
    std::vector<Scaled> replacement(rows_[piece.rows].arity);
    for (std::size_t m = 0; m < piece.read.size(); ++m) {
      const std::uint32_t global = group.inputs[group.bound[e][m]];
      replacement[piece.read[m]] = single && global >= first_uniform  // a number, as no other row differs
                                       ? algebra_.constant(h_.uniforms[global - 2 * h_.coordinates - 1])
                                       : algebra_.input(group.bound[e][m]);
    }
    const auto bound = [&](Scaled f) {
      Scaled value = f.zero() ? f : algebra_.import(l_.graph, f.node, replacement);
      value.factor *= f.factor;
      return value;
    };
    const auto member = [&](std::uint32_t input) {
      const auto at = std::ranges::find(piece.momenta, input) - piece.momenta.begin();
      return group.member[e][at];
    };
    for (const Piece::Second& second : piece.a) {
      Scaled& entry = a[member(second.row)][member(second.column)];
      entry = algebra_.add(entry, bound(second.value));
    }
    for (const Partial& slope : piece.b) {
      Scaled& entry = b[member(slope.input)];
      entry = algebra_.add(entry, bound(slope.value));
    }
    c = algebra_.add(c, bound(piece.c));
  }
  const std::optional<Matrix> m = inverse(a, block);
  if (!m) return false;
  // L = ½ vᵀ m v − vᵀ m b + (½ bᵀ m b − c): written out, so that c cancels where b makes it, as in (p − A)².
  Scaled quadratic, linear, constant;
  for (std::uint32_t i = 0; i < k; ++i) {
    const Scaled v = algebra_.input(i);
    Scaled mv, mb;
    for (std::uint32_t j = 0; j < k; ++j) {
      const Scaled weight = j < i ? times(algebra_.constant(2), (*m)[i][j]) : (*m)[i][j];
      if (j <= i) mv = algebra_.add(mv, times(weight, algebra_.input(j)));
      mb = algebra_.add(mb, times((*m)[i][j], b[j]));
    }
    quadratic = algebra_.add(quadratic, times(mv, v));
    linear = algebra_.add(linear, times(mb, v));
    constant = algebra_.add(constant, times(mb, b[i]));
  }
  const Scaled value =
      algebra_.add(algebra_.subtract(half(quadratic), linear), algebra_.subtract(half(constant), c));
  l_.terms.push_back({algebra_.node(value), static_cast<int>(group.inputs.size()), group.table});
  return true;
}

std::optional<Matrix> Transform::inverse(const Matrix& a, const Block& block) {
  const std::size_t k = a.size();
  const bool numbers = std::ranges::all_of(a, [&](const std::vector<Scaled>& row) {
    return std::ranges::all_of(
        row, [&](const Scaled& entry) { return entry.zero() || l_.graph.is_constant(entry.node); });
  });
  if (k > most_coupled_momenta)
    throw std::invalid_argument("the Hamiltonian couples " + std::to_string(k) + " momenta; " +
                                std::to_string(most_coupled_momenta) + " are the most");
  if (numbers) return inverse_of_numbers(a, block);
  if (k <= most_by_minors) return inverse_by_minors(a, block);
  return k <= most_symbolic ? inverse_by_pivots(a, block) : std::nullopt;
}

Matrix Transform::inverse_of_numbers(const Matrix& a, const Block& block) {
  const auto k = static_cast<Eigen::Index>(a.size());
  Eigen::MatrixXd numbers(k, k);
  for (Eigen::Index i = 0; i < k; ++i)
    for (Eigen::Index j = 0; j < k; ++j) {
      const Scaled& entry = a[i][j];
      numbers(i, j) = entry.zero() ? 0 : entry.factor * l_.graph[entry.node].value;
    }
  // Units of the momenta differ: the rank is that of the matrix with unit rows.
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(k);
  for (int pass = 0; pass < 4; ++pass) {
    const Eigen::VectorXd size =
        (unit.asDiagonal() * numbers * unit.asDiagonal()).cwiseAbs().rowwise().maxCoeff();
    for (Eigen::Index i = 0; i < k; ++i) unit[i] /= size[i] > 0 ? std::sqrt(size[i]) : 1;
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(unit.asDiagonal() * numbers * unit.asDiagonal());
  if (!numbers.allFinite() || !lu.isInvertible()) singular(block);
  const Eigen::MatrixXd inverse = unit.asDiagonal() * lu.inverse() * unit.asDiagonal();
  Matrix m(a.size(), std::vector<Scaled>(a.size()));
  for (Eigen::Index i = 0; i < k; ++i)
    for (Eigen::Index j = 0; j < k; ++j)
      m[i][j] = k == 1 ? algebra_.reciprocal(a[0][0])
                       : algebra_.constant(0.5 * inverse(i, j) + 0.5 * inverse(j, i));
  return m;
}

/// a⁻¹ = adj(a)/det(a), regular wherever a is.
Matrix Transform::inverse_by_minors(const Matrix& a, const Block& block) {
  const std::size_t k = a.size();
  Matrix m(k, std::vector<Scaled>(k));
  const auto minor = [&](std::size_t i, std::size_t j) -> Scaled {  // with its sign
    if (k == 1) return algebra_.constant(1);
    if (k == 2) return i == j ? a[1 - i][1 - j] : -a[i][j];
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return algebra_.subtract(times(a[i1][j1], a[i2][j2]), times(a[i1][j2], a[i2][j1]));
  };
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j) m[i][j] = minor(i, j);
  Scaled determinant;
  for (std::size_t j = 0; j < k; ++j)
    determinant = algebra_.add(determinant, times(a[0][j], m[j][0]));
  if (determinant.zero()) singular(block);
  const Scaled scale = algebra_.reciprocal(determinant);
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j) m[i][j] = m[j][i] = times(m[i][j], scale);
  return m;
}

/// By elimination in place, with pivots on the diagonal, numbers first. Nothing where the diagonal has none.
std::optional<Matrix> Transform::inverse_by_pivots(const Matrix& given, const Block& block) {
  const std::size_t k = given.size();
  Matrix a = given, m(k, std::vector<Scaled>(k));
  for (std::size_t i = 0; i < k; ++i) m[i][i] = algebra_.constant(1);
  std::vector<Scaled> pivots(k);
  std::vector<bool> done(k);
  // Gauss-Jordan; the rows are divided by their pivots in the end.
  for (std::size_t step = 0; step < k; ++step) {
    std::size_t pivot = k;
    for (std::size_t i = 0; i < k; ++i) {
      if (done[i] || a[i][i].zero()) continue;
      if (pivot == k || (l_.graph.is_constant(a[i][i].node) && !l_.graph.is_constant(a[pivot][pivot].node)))
        pivot = i;
    }
    if (pivot == k) {
      bool nothing = true;
      for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j < k; ++j) nothing = nothing && (done[i] || done[j] || a[i][j].zero());
      if (nothing) singular(block);
      return std::nullopt;
    }
    done[pivot] = true;
    const Scaled unit = algebra_.reciprocal(a[pivot][pivot]);
    for (std::size_t i = 0; i < k; ++i) {
      if (i == pivot || a[i][pivot].zero()) continue;
      const Scaled factor = times(a[i][pivot], unit);
      for (std::size_t j = 0; j < k; ++j) {
        a[i][j] = j == pivot ? Scaled{} : algebra_.subtract(a[i][j], times(factor, a[pivot][j]));
        m[i][j] = algebra_.subtract(m[i][j], times(factor, m[pivot][j]));
      }
    }
    pivots[pivot] = unit;
  }
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j) m[i][j] = m[j][i] = times(m[i][j], pivots[i]);
  return m;
}

std::optional<LagrangianGraph> Transform::run() {
  if (!read_terms()) return std::nullopt;
  couple();
  std::map<std::vector<std::uint32_t>, Alike> alike;
  for (const Block& block : blocks()) add_alike(block, alike);
  for (const auto& [signature, group] : alike)
    if (!add_term(group)) return std::nullopt;
  return std::move(l_);
}

}  // namespace

std::optional<LagrangianGraph> legendre_transform(const LagrangianGraph& hamiltonian) {
  return Transform(hamiltonian).run();
}

}  // namespace extremal
