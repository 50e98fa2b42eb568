#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "system/derivative.hpp"
#include "system/hamiltonian.hpp"

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

/// A summand of a term: factor · moving, where the factor has no momenta.
struct Summand {
  Scaled moving, factor;
};

/// What some momenta of a term contribute: ½ pᵀ a p + bᵀ p + c, or g times its square root, in the inputs of
/// the term.
struct Piece {
  struct Second {
    std::uint32_t row, column;  ///< inputs, both orders stand
    Scaled value;
  };
  std::size_t rows;                    ///< which Rows
  std::vector<std::uint32_t> momenta;  ///< inputs
  std::vector<Second> a;
  std::vector<Partial> b;
  Scaled c, g;
  bool root = false;
  std::vector<std::uint32_t> read;  ///< inputs that a, b, c, g are made of
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
    std::vector<std::uint32_t> members;                      ///< coordinates, by first appearance
    std::vector<std::pair<std::size_t, int>> contributions;  ///< pieces, and which row of each
  };
  /// Blocks that are made alike.
  struct Alike {
    Block first;
    std::vector<std::uint32_t> inputs;  ///< of the first block: velocities of its members, then what it reads
    std::vector<std::vector<std::uint32_t>> bound;   ///< for each contribution, the input of what it reads
    std::vector<std::vector<std::uint32_t>> member;  ///< for each contribution, the member of its momenta
    std::vector<std::uint32_t> table;
  };

  bool depends(NodeId node, const std::vector<Input>& kinds, std::unordered_map<NodeId, bool>& known) const;
  void cut(Scaled f, const std::vector<Input>& kinds, std::unordered_map<NodeId, bool>& known,
           std::vector<Summand>& summands, Scaled& rest);
  void cut_product(Scaled f, const std::vector<Input>& kinds, std::unordered_map<NodeId, bool>& known,
                   std::vector<Summand>& summands, Scaled& rest);
  std::optional<Piece> quadratic_piece(std::size_t rows, Scaled f, Sets& together);
  bool take_apart(std::size_t rows, const Summand& summand, Scaled& rest);
  void keep(Piece piece);
  Scaled at_rest(Scaled f, const std::vector<Input>& kinds);
  bool read_terms();
  void couple();
  std::vector<Block> blocks();
  void add_alike(const Block& block, std::map<std::vector<std::uint32_t>, Alike>& alike) const;
  /// Of a block: ½ pᵀ a p + bᵀ p + c, or where g does not vanish g √(½ pᵀ a p + βᵀ p + under) + bᵀ p + c.
  struct Forms {
    Matrix a;
    std::vector<Scaled> b, beta;
    Scaled c, under, g;
  };
  std::optional<Forms> forms_of(const Alike& alike);
  Scaled half_form(const Matrix& m, std::span<const Scaled> u);
  Scaled form(const Matrix& m, std::span<const Scaled> u, std::span<const Scaled> w);
  bool add_term(const Alike& alike);
  std::optional<Matrix> inverse(const Matrix& a, const Block& block);
  Matrix inverse_of_numbers(const Matrix& a, const Block& block);
  Matrix inverse_by_minors(const Matrix& a, const Block& block);
  std::optional<Matrix> inverse_by_pivots(const Matrix& a, const Block& block);
  [[noreturn]] static void singular(const Block& block);

  Scaled times(Scaled x, Scaled y) { return algebra_.multiply(x, y); }

  const LagrangianGraph& h_;
  const std::vector<Rows> rows_;
  LagrangianGraph l_;
  Algebra algebra_;
  Sets coupled_;
  std::vector<Piece> pieces_;
};

bool Transform::depends(NodeId node, const std::vector<Input>& kinds,
                        std::unordered_map<NodeId, bool>& known) const {
  if (const auto at = known.find(node); at != known.end()) return at->second;
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
                    std::vector<Summand>& summands, Scaled& rest) {
  std::vector<Scaled> waiting{f};  // the next one last: sums may be long
  while (!waiting.empty()) {
    f = waiting.back();
    waiting.pop_back();
    if (f.zero()) continue;
    const Node n = l_.graph[f.node];
    if (!depends(f.node, kinds, known)) {
      rest = algebra_.add(rest, f);
    } else if (n.op == Op::add || n.op == Op::sub) {
      waiting.push_back(algebra_.scaled(n.op == Op::add ? f.factor : -f.factor, n.b));
      waiting.push_back(algebra_.scaled(f.factor, n.a));
    } else {
      cut_product(f, kinds, known, summands, rest);
    }
  }
}

void Transform::cut_product(Scaled f, const std::vector<Input>& kinds,
                            std::unordered_map<NodeId, bool>& known, std::vector<Summand>& summands,
                            Scaled& rest) {
  const Node n = l_.graph[f.node];
  const bool product = n.op == Op::mul || n.op == Op::div;
  const bool first = product && depends(n.a, kinds, known), second = product && depends(n.b, kinds, known);
  if (first == second || (n.op == Op::div && second)) {
    summands.push_back({{1, f.node}, algebra_.constant(f.factor)});
    return;
  }
  const Scaled other = algebra_.scaled(1, first ? n.b : n.a);
  const Scaled factor = n.op == Op::div ? algebra_.reciprocal(other) : other;
  std::vector<Summand> parts;
  Scaled still;
  cut(algebra_.scaled(f.factor, first ? n.a : n.b), kinds, known, parts, still);
  for (const Summand& part : parts) summands.push_back({part.moving, times(part.factor, factor)});
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

/// a, b, c of f; `together` joins inputs that f couples. Nothing where f is not quadratic.
std::optional<Piece> Transform::quadratic_piece(std::size_t r, Scaled f, Sets& together) {
  const std::vector<Input>& kinds = rows_[r].kinds;
  std::vector<bool> momentum;
  for (const Input kind : kinds) momentum.push_back(kind == Input::momentum);
  std::unordered_map<NodeId, bool> known;
  Piece piece;
  piece.rows = r;
  for (const Partial& slope : differentiate(algebra_, f, momentum)) {
    piece.momenta.push_back(slope.input);
    for (const Partial& second : differentiate(algebra_, slope.value, momentum)) {
      if (depends(second.value.node, kinds, known)) return std::nullopt;
      piece.a.push_back({slope.input, second.input, second.value});
      together.merge(slope.input, second.input);
    }
    if (const Scaled b = at_rest(slope.value, kinds); !b.zero()) piece.b.push_back({slope.input, b});
  }
  piece.c = at_rest(f, kinds);
  return piece;
}

void Transform::keep(Piece piece) {
  std::vector<Scaled> values{piece.c, piece.g};
  for (const Piece::Second& second : piece.a) values.push_back(second.value);
  for (const Partial& b : piece.b) values.push_back(b.value);
  for (const Scaled value : values) {
    if (value.zero()) continue;
    const std::vector<std::uint32_t> inputs = inputs_of(l_.graph, value.node);
    piece.read.insert(piece.read.end(), inputs.begin(), inputs.end());
  }
  std::ranges::sort(piece.read);
  piece.read.erase(std::unique(piece.read.begin(), piece.read.end()), piece.read.end());
  pieces_.push_back(std::move(piece));
}

/// Makes pieces of a summand: of a quadratic one for each set of momenta that it couples, where c goes to the
/// rest if there are several; of a root one. False where it is neither.
bool Transform::take_apart(std::size_t r, const Summand& summand, Scaled& rest) {
  Sets together(rows_[r].kinds.size());
  std::optional<Piece> whole = quadratic_piece(r, summand.moving, together);
  if (!whole) {
    const Node n = l_.graph[summand.moving.node];
    if (n.op == Op::sqrt) whole = quadratic_piece(r, algebra_.scaled(1, n.a), together);
    if (!whole) return false;
    whole->g = summand.factor;
    whole->root = true;
    keep(*std::move(whole));
    return true;
  }
  for (Piece::Second& second : whole->a) second.value = times(second.value, summand.factor);
  for (Partial& b : whole->b) b.value = times(b.value, summand.factor);
  whole->c = times(whole->c, summand.factor);
  std::map<std::uint32_t, Piece> pieces;
  for (const std::uint32_t m : whole->momenta) {
    Piece& piece = pieces[together.find(m)];
    piece.rows = r;
    piece.momenta.push_back(m);
  }
  for (const Piece::Second& second : whole->a) pieces[together.find(second.row)].a.push_back(second);
  for (const Partial& b : whole->b) pieces[together.find(b.input)].b.push_back(b);
  if (pieces.size() == 1)
    pieces.begin()->second.c = whole->c;
  else
    rest = algebra_.add(rest, whole->c);
  for (auto& [first, piece] : pieces) keep(std::move(piece));
  return true;
}

/// Pieces of all terms; what has no momenta becomes a term of L with the opposite sign.
bool Transform::read_terms() {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Rows& rows = rows_[r];
    std::unordered_map<NodeId, bool> known;
    std::vector<Summand> summands;
    Scaled rest;
    cut(algebra_.import(h_.graph, rows.body), rows.kinds, known, summands, rest);
    for (const Summand& summand : summands)
      if (!take_apart(r, summand, rest)) return false;
    if (!rest.zero()) l_.terms.push_back({algebra_.node(-rest), rows.arity, rows.table});
  }
  return true;
}

void Transform::couple() {
  const auto n = static_cast<std::uint32_t>(h_.coordinates);
  for (const Piece& piece : pieces_) {
    const Rows& rows = rows_[piece.rows];
    for (int row = 0; row < rows.rows(); ++row) {
      for (const Piece::Second& second : piece.a)
        coupled_.merge(rows.at(row, second.row) - n, rows.at(row, second.column) - n);
      for (const std::uint32_t m : piece.root ? piece.momenta : std::vector<std::uint32_t>{})
        coupled_.merge(rows.at(row, m) - n, rows.at(row, piece.momenta.front()) - n);
    }
  }
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

/// The forms of some blocks that are alike, in the inputs of their term. Nothing where roots stand beside
/// quadratic forms.
std::optional<Transform::Forms> Transform::forms_of(const Alike& group) {
  const Block& block = group.first;
  const std::size_t k = block.members.size();
  const std::uint32_t first_uniform = 2 * h_.coordinates + 1 + h_.parameters;
  const bool single = group.table.size() == group.inputs.size();
  Forms forms{Matrix(k, std::vector<Scaled>(k)), std::vector<Scaled>(k), std::vector<Scaled>(k), {}, {}, {}};
  int roots = 0, others = 0;
  for (std::size_t e = 0; e < block.contributions.size(); ++e) {
    const Piece& piece = pieces_[block.contributions[e].first];
    std::vector<Scaled> replacement(rows_[piece.rows].arity);
    for (std::size_t m = 0; m < piece.read.size(); ++m) {
      const std::uint32_t global = group.inputs[group.bound[e][m]];
      replacement[piece.read[m]] = single && global >= first_uniform  // a number, as no other row differs
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
      return group.member[e][std::ranges::find(piece.momenta, input) - piece.momenta.begin()];
    };
    for (const Piece::Second& second : piece.a)
      add(forms.a[member(second.row)][member(second.column)], second.value);
    for (const Partial& b : piece.b) add((piece.root ? forms.beta : forms.b)[member(b.input)], b.value);
    add(piece.root ? forms.under : forms.c, piece.c);
    add(forms.g, piece.g);
    roots += piece.root;
    others += !piece.root && !piece.a.empty();
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

/// Adds the term of some blocks that are alike. False where it has no expression.
bool Transform::add_term(const Alike& group) {
  const std::optional<Forms> f = forms_of(group);
  if (!f) return false;
  const std::optional<Matrix> m = inverse(f->a, group.first);
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
    if (rest.zero()) singular(group.first);
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
  for (std::size_t j = 0; j < k; ++j) determinant = algebra_.add(determinant, times(a[0][j], m[j][0]));
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
