#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <random>
#include <string>

#include "action/discrete_action.hpp"
#include "action/elimination_order.hpp"
#include "system/formula.hpp"

/// The elimination along the couplings of the coordinates, against dense elimination of the same matrices.

namespace extremal {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

struct Graph {
  std::string name;
  int n;
  Pairs pairs;
};

Graph chain(int n, bool closed = false) {
  Graph graph{closed ? "ring" : "chain", n, {}};
  for (int i = 0; i + (closed ? 0 : 1) < n; ++i) graph.pairs.emplace_back(i, (i + 1) % n);
  return graph;
}

Graph lattice(int width, int height) {
  Graph graph{"lattice", width * height, {}};
  for (int i = 0; i < width * height; ++i) {
    if (i % width + 1 < width) graph.pairs.emplace_back(i, i + 1);
    if (i + width < width * height) graph.pairs.emplace_back(i, i + width);
  }
  return graph;
}

Graph random_graph(int n, double density, unsigned seed) {
  Graph graph{"random " + std::to_string(seed), n, {}};
  std::mt19937 random(seed);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      if (random() < density * std::mt19937::max()) graph.pairs.emplace_back(i, j);
  return graph;
}

std::vector<Graph> graphs() {
  std::vector<Graph> list{chain(1), chain(9), chain(8, true), lattice(3, 3), random_graph(7, 1, 0)};
  Graph star{"star", 8, {}}, tree{"tree", 10, {}}, apart = chain(4);
  for (int i = 1; i < 8; ++i) star.pairs.emplace_back(0, i);
  for (int i = 1; i < 10; ++i) tree.pairs.emplace_back((i - 1) / 2, i);
  apart.name = "two parts and free ones";
  apart.n = 9;
  apart.pairs.emplace_back(5, 6);
  list.insert(list.end(), {star, tree, apart});
  for (unsigned seed = 1; seed <= 4; ++seed) list.push_back(random_graph(9, 0.1 * seed, seed));
  return list;
}

/// Each pair coupled by a term; q1 and q2 stand for its coordinates.
std::shared_ptr<const Lagrangian> coupled(const Graph& graph, const std::string& term) {
  SystemText text{.coordinates = {}, .lagrangian = "0"};
  for (int i = 0; i < graph.n; ++i) {
    const std::string q = "x" + std::to_string(i);
    text.coordinates.push_back(q);
    text.lagrangian += " + " + std::to_string(2 + i % 3) + "*" + q + "'^2";
  }
  for (const auto& [i, j] : graph.pairs) {
    std::string pair = term;
    for (std::size_t at; (at = pair.find("q1")) != std::string::npos;)
      pair.replace(at, 2, "x" + std::to_string(i));
    for (std::size_t at; (at = pair.find("q2")) != std::string::npos;)
      pair.replace(at, 2, "x" + std::to_string(j));
    text.lagrangian += " + " + pair;
  }
  return compile(text).lagrangian;
}

const char* const terms[] = {
    "-3*(q1 - q2)^2 - (q1 - q2)^4/4",              // a potential
    "0.2*q1'*q2' - cos(q1 + 2*q2)",                // masses
    "0.7*q1'*q2 - 0.4*q2'*q1 - (q1 - q2)^2/2",     // gyroscopic
    "0.1*cos(q1)*q1'*q2' + sin(q2)*q1' - q1*q2^2"  // all that a Lagrangian may have
};

/// Uncondensed values of one element, dense.
struct Dense {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient, border;
};

/// `lengths` elements, random values everywhere.
class Elements {
 public:
  Elements(std::shared_ptr<const Lagrangian> given, const Scheme& scheme, int elements)
      : lagrangian(std::move(given)), scheme_(scheme, scheme.points), random_(3) {
    tables.bind(scheme_, *lagrangian);
    action.reset(*lagrangian, tables, elements, true);
    std::vector<double> mesh(elements + 1);
    for (int k = 0; k <= elements; ++k) mesh[k] = std::sqrt(double(k) / elements);
    path.reset(tables, mesh, 0.8 * elements);
    scatter();
  }

  void scatter() {
    std::uniform_real_distribution<double> noise(-1, 1);
    const int n = tables.coordinates(), m = tables.unknowns();
    std::vector<double> step(std::size_t(path.elements() + 1) * n);
    AlignedDoubles inner(std::size_t(path.batches()) * m * simd_lanes());
    for (double& x : step) x = 0.5 * noise(random_);
    for (double& x : inner) x = 0.1 * noise(random_);
    path.add(step, inner, 1);
    path.load_ends();
  }

  std::vector<Dense> dense() {
    const int m = tables.unknowns();
    const ElementTables::Entries& entries = tables.entries();
    std::vector<Dense> result(path.elements());
    action.visit(path, true, [&](int batch, const BatchValues& values) {
      for (int k = simd_lanes() * batch; k < std::min(simd_lanes() * (batch + 1), path.elements()); ++k) {
        Dense& d = result[k];
        const int lane = k % simd_lanes();
        d.hessian.setZero(m, m);
        for (std::size_t e = 0; e < entries.row.size(); ++e)
          d.hessian(entries.row[e], entries.column[e]) = d.hessian(entries.column[e], entries.row[e]) =
              values.entries[e * simd_lanes() + lane];
        d.gradient.resize(m);
        d.border.resize(m);
        for (int u = 0; u < m; ++u) {
          d.gradient[u] = values.gradient[u * simd_lanes() + lane];
          d.border[u] = values.border[u * simd_lanes() + lane];
        }
      }
    });
    return result;
  }

  std::shared_ptr<const Lagrangian> lagrangian;

 private:
  SchemeTables scheme_;
  std::mt19937 random_;

 public:
  ElementTables tables;
  DiscreteAction action;
  Path path;
};

class Elimination : public testing::TestWithParam<Graph> {};

TEST_P(Elimination, OfElementsByThemselvesIsThatForTheNodes) {
  const int elements = 11;
  Elements d(coupled(GetParam(), terms[0]), lobatto(4), elements);
  d.action.evaluate(d.path);
  DiscreteAction apart;
  apart.reset(*d.lagrangian, d.tables, elements, false, Condense::elements);
  apart.evaluate(d.path);
  EXPECT_EQ(apart.nodes.negative, d.action.nodes.negative);
  EXPECT_EQ(apart.nodes.pivot_ratio, d.action.nodes.pivot_ratio);
  const int n = d.tables.coordinates(), lanes = simd_lanes();
  for (int first = 0; first < elements; first += lanes) {
    const std::size_t used = std::min(lanes, elements - first);
    std::vector<std::vector<double>> blocks(3 * used, std::vector<double>(n * n, NAN));
    std::vector<double*> to;
    for (std::vector<double>& block : blocks) to.push_back(block.data());
    const std::span<double* const> all = to;
    apart.copy_condensed(first / lanes, all.first(used), all.subspan(used, used), all.last(used));
    for (std::size_t k = 0; k < used; ++k)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto entry = [&](int row, int column) {
            return d.action.condensed(first + int(k), std::max(row, column), std::min(row, column));
          };
          EXPECT_EQ(blocks[k][i * n + j], entry(i, j)) << i << ", " << j;
          EXPECT_EQ(blocks[used + k][i * n + j], entry(n + i, j)) << i << ", " << j;
          EXPECT_EQ(blocks[2 * used + k][i * n + j], entry(n + i, n + j)) << i << ", " << j;
        }
  }
}

TEST_P(Elimination, IsThatOfTheDenseMatrix) {
  for (const char* term : terms)
    for (const Scheme& scheme : {lobatto(2), lobatto(5), gauss(3)}) {
      const std::string what = std::string(term) + ' ' + scheme.name;
      Elements d(coupled(GetParam(), term), scheme, 11);
      const int n = d.tables.coordinates(), inner = d.tables.inner(), m = d.tables.unknowns();
      const std::vector<Dense> before = d.dense();
      d.action.evaluate(d.path);
      std::vector<Eigen::PartialPivLU<Eigen::MatrixXd>> factors;
      int negative = 0;
      double amplified = 1;  // what the pivots that there are may cost
      for (int k = 0; k < d.path.elements(); ++k) {
        const Eigen::MatrixXd a = before[k].hessian.topLeftCorner(inner, inner),
                              lower = before[k].hessian.bottomLeftCorner(2 * n, inner);
        factors.emplace_back(a);
        const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues();
        negative += int((eigenvalues.array() < 0).count());
        amplified =
            std::max(amplified, eigenvalues.cwiseAbs().maxCoeff() / eigenvalues.cwiseAbs().minCoeff());
        const Eigen::MatrixXd schur =
            before[k].hessian.bottomRightCorner(2 * n, 2 * n) - lower * factors[k].solve(lower.transpose());
        const double scale = before[k].hessian.cwiseAbs().maxCoeff() + schur.cwiseAbs().maxCoeff();
        for (int i = 0; i < 2 * n; ++i)
          for (int j = 0; j <= i; ++j)
            ASSERT_NEAR(d.action.condensed(k, i, j), schur(i, j), 1e-11 * scale / d.action.nodes.pivot_ratio)
                << what << " element " << k << " entry " << i << ", " << j;
      }
      EXPECT_EQ(d.action.nodes.negative, negative) << what;

      for (int k : {0, 7, 10}) {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> fields(inner, 2 * n);
        d.action.inner_by_ends(k, {fields.data(), std::size_t(fields.size())});
        const Eigen::MatrixXd lower = before[k].hessian.bottomLeftCorner(2 * n, inner);
        const Eigen::MatrixXd expected = -factors[k].solve(lower.transpose());
        EXPECT_LE((fields - expected).cwiseAbs().maxCoeff(),
                  1e-13 * amplified / d.action.nodes.pivot_ratio * (1 + expected.cwiseAbs().maxCoeff()))
            << what << " element " << k;
      }

      // A step, from another gradient, with the factors of before.
      d.scatter();
      const std::vector<Dense> after = d.dense();
      d.action.evaluate_gradient(d.path);
      std::vector<double> nodes((d.path.elements() + 1) * n);
      for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = std::sin(1.0 + i);
      AlignedDoubles step;
      d.action.expand_step(nodes, 0.3, step);
      Eigen::VectorXd reduced = Eigen::VectorXd::Zero(nodes.size());
      for (int k = 0; k < d.path.elements(); ++k) {
        const Eigen::Map<const Eigen::VectorXd> ends(nodes.data() + k * n, 2 * n);
        const Eigen::MatrixXd lower = before[k].hessian.bottomLeftCorner(2 * n, inner);
        const Eigen::VectorXd g = after[k].gradient.head(inner);
        const Eigen::VectorXd x =
            -factors[k].solve(g + lower.transpose() * ends + 0.3 * before[k].border.head(inner));
        const double allowed = 1e-13 * amplified / d.action.nodes.pivot_ratio * (1 + x.cwiseAbs().maxCoeff());
        for (int u = 0; u < inner; ++u)
          ASSERT_NEAR(step[(k / simd_lanes() * m + u) * simd_lanes() + k % simd_lanes()], x[u], allowed)
              << what << " element " << k;
        reduced.segment(k * n, 2 * n) += after[k].gradient.tail(2 * n) - lower * factors[k].solve(g);
      }
      const double allowed =
          1e-13 * amplified / d.action.nodes.pivot_ratio * (1 + reduced.cwiseAbs().maxCoeff());
      for (std::size_t i = 0; i < nodes.size(); ++i)
        ASSERT_NEAR(d.action.nodes.gradient[i], reduced[i], allowed) << what << " node unknown " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Graphs, Elimination, testing::ValuesIn(graphs()), [](const auto& info) {
  std::string name = info.param.name + '_' + std::to_string(info.param.n);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

Fronts fronts(const Graph& graph, const char* term, int degree) {
  const auto lagrangian = coupled(graph, term);
  const SchemeTables scheme(lobatto(degree));
  ElementTables tables;
  tables.bind(scheme, *lagrangian);
  return Fronts(tables.shape());
}

TEST(EliminationOrder, TakesAllAtOnceWhereAllAreCoupled) {
  EXPECT_EQ(fronts(random_graph(7, 1, 0), terms[0], 5).count(), 1);
  EXPECT_EQ(fronts(chain(2), terms[3], 5).count(), 1);
  EXPECT_EQ(fronts(chain(1), terms[0], 1).count(), 0);
}

TEST(EliminationOrder, ListsEachCoordinateOnceAndNoFillInATree) {
  for (const Graph& graph : graphs()) {
    CoordinateGraph couplings{graph.n, {}, {}};
    couplings.inner.resize(graph.n * graph.n);
    couplings.ends.resize(graph.n * graph.n);
    for (const auto& [i, j] : graph.pairs)
      couplings.inner[i * graph.n + j] = couplings.inner[j * graph.n + i] = Coupling::nodes;
    std::vector<int> seen(graph.n);
    std::size_t couples = 0;
    for (const PivotGroup& group : elimination_order(couplings, 3)) {
      for (int a : group.pivots) ++seen[a];
      couples += group.inner.size() + group.pivots.size() - 1;
    }
    EXPECT_EQ(seen, std::vector<int>(graph.n, 1)) << graph.name;
    if (graph.name == "tree" || graph.name == "star" || graph.name == "chain") {
      EXPECT_EQ(couples, graph.pairs.size()) << graph.name;
    }
  }
}

TEST(EliminationOrder, MakesAChainCheap) {
  const double inner = 7 * 32, ends = 64;
  const double dense = inner * (inner * inner / 6 + inner * ends / 2 + ends * ends / 2);
  const double work = fronts(chain(32), terms[0], 8).work();
  EXPECT_LT(work, 0.05 * dense);
  EXPECT_NEAR(fronts(random_graph(32, 1, 0), terms[0], 8).work(), dense, 1e-9 * dense);
}

}  // namespace
}  // namespace extremal
