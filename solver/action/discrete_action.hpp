#pragma once

#include <functional>
#include <span>
#include <vector>

#include "action/corners.hpp"
#include "action/extended.hpp"
#include "action/path.hpp"
#include "linear/chain.hpp"
#include "machine/deadline.hpp"
#include "machine/simd.hpp"
#include "problem/end_cost.hpp"
#include "system/lagrangian.hpp"

/// \file The discrete action S_h = Σ L_d of a path, its derivatives, and the equations that remain at the
/// nodes between elements once the inner unknowns are eliminated.

namespace extremal {

/// What the ends of the elements see after condensation: with x the mesh nodes and T,
///   δ²S = Σ_k (x_k, x_{k+1}) S_k (x_k, x_{k+1})ᵀ + 2 δT tᵀx + τ δT².
struct NodeEquations {
  Chain chain;                      ///< nodes 1 … N − 1
  std::vector<double> first, last;  ///< n × n: second derivative in q(0), in q(T)
  std::vector<double> first_lower;  ///< couples node 1 (row) with q(0) (column); for N = 1 q(T) with q(0)
  std::vector<double> last_lower;   ///< couples q(T) (row) with node N − 1 (column); unused for N = 1
  std::vector<double> gradient;     ///< (N + 1) × n, condensed
  std::vector<double> border;       ///< (N + 1) × n: t
  double border_gradient = 0;       ///< ∂S/∂T, condensed
  /// What must be added to the gradients by q(0) and q(T) (2n; or empty), and by T: momenta that are given,
  /// and of gradients in extended precision numbers that cancel in the equations of the ends, and would take
  /// the digits of what is left with them.
  std::vector<double> end_parts;
  double border_part = 0;
  double corner = 0;       ///< τ
  int negative = 0;        ///< negative pivots among the inner unknowns
  double pivot_ratio = 1;  ///< least pivot against the entry it came from
};

/// The uncondensed values of a batch of elements, a lane each.
struct BatchValues {
  const double* gradient;  ///< over the m local unknowns
  const double* entries;   ///< Hessian, as ElementTables::entries lists it; null without Hessian
  const double* border;    ///< ∂²S/∂x∂T, m; null unless T is an unknown
  const double* corner;    ///< ∂²S/∂T²
  const double* slope;     ///< ∂L_d/∂h; null unless T is an unknown
};

/// What evaluate() makes of the Hessians of elements: nothing; of each by itself, its Schur complement in its
/// ends; and of these the node equations.
enum class Condense { nothing, elements, to_nodes };

/// Evaluates a path, batch by batch in one pass: points, tape, gradient, Hessian, condensation.
/// Keeps factors of the last factored path, so that a gradient elsewhere can be reduced with them.
class DiscreteAction {
 public:
  /// Binds to tables (which must outlive it) and N elements. `border`: T is an unknown. To condense nothing,
  /// only visit() and evaluate_plain() may be called, and no dense matrix is held. Of elements by themselves
  /// `nodes` has the pivots only.
  void reset(const Lagrangian& lagrangian, const ElementTables& tables, int elements, bool border,
             Condense condense = Condense::to_nodes);

  /// From now on values and gradients are those of another Lagrangian of as many coordinates or of another
  /// quadrature, on tables of the same degree bound to it; the factors stay. evaluate() needs what reset()
  /// was given.
  void substitute(const Lagrangian& lagrangian, const ElementTables& tables);

  /// Until reset() the ends have given momenta (2n; empty: none), which must outlive it: `nodes` and
  /// imbalance() are derivatives of S_h + p(0)·q(0) − p(T)·q(T).
  void give_momenta(std::span<const double> momenta) { momenta_ = momenta; }
  std::span<const double> momenta() const { return momenta_; }
  /// Likewise costs of the ends (2; or empty): `nodes`, imbalance() and action() are those of S_h with them.
  void give_costs(std::span<const EndCost> costs) { costs_ = costs; }

  /// From now on evaluations end when the deadline passes; the action is then not finite.
  void end_at(const Deadline& deadline) { deadline_ = deadline; }
  const Deadline& deadline() const { return deadline_; }

  /// From now on evaluate() and evaluate_gradient() take gradients in extended precision, where they can.
  void extend(bool on) { extended_on_ = on; }

  /// S_h and its gradient; condensed with the factors there are into `nodes`.
  void evaluate_gradient(const Path& path);
  /// Where the last gradient was evaluated, in extended precision: `nodes` has in its place what it changes
  /// by, to first order, along a change of the path; then itself again.
  void put_change(const Path& path, const PathChange& change);
  void put_gradient(const Path& path);
  bool extended() const { return extended_ready_; }
  /// Where it is: the last gradient itself.
  const ExtendedGradient::Values& extended_gradient() const { return extended_.values(); }
  /// S_h, gradient, Hessian, condensed afresh.
  void evaluate(const Path& path);
  /// Value and gradient only, nothing condensed.
  void evaluate_plain(const Path& path);

  /// S_h and its derivatives, batch by batch, as they are.
  void visit(const Path& path, bool hessian, const std::function<void(int batch, const BatchValues&)>& use);

  NodeEquations nodes;

  double action() const { return action_; }
  double slope_duration() const { return slope_duration_; }  ///< ∂S_h/∂T, not condensed
  double residual() const { return residual_; }              ///< largest inner or nodal gradient component
  double momentum_scale() const { return momentum_scale_; }  ///< largest end gradient of an element
  /// Largest range of a momentum over the ends of elements; 0 where gradients were extended.
  double momentum_range() const;
  /// Largest momentum by velocity along a path, roughly; 0 where unknown.
  double inertia(const Path& path) const;
  bool finite() const { return finite_; }
  /// Paths close, from now until reset(), by this map, which must outlive its use; null: they have ends.
  void close(const ClosingMap* closed) { closed_ = closed; }
  /// Where elements end at kinks of L, those of the path evaluated last.
  std::span<const Corner> corners() const { return corners_; }
  /// ∂L_d/∂q_a, then ∂L_d/∂q_b of the elements of a batch, 2n groups of lanes.
  const double* end_gradients(int batch) const { return sums(batch, of_ends); }
  const ElementTables& tables() const { return *tables_; }
  std::span<const double> start_gradient() const { return start_gradient_; }  ///< ∂S_h/∂q(0), n
  std::span<const double> end_gradient() const { return end_gradient_; }      ///< ∂S_h/∂q(T), n

  /// ∂S_h/∂x_e of the end coordinate e, less what momenta and costs that are given make of it.
  double imbalance(int e) const;

  /// Inner steps from the steps of the nodes and of T, into `step` (laid out as Path::x).
  void expand_step(std::span<const double> node_step, double duration_step, AlignedDoubles& step) const;

  /// The Hessian of element k, m × m lower triangle row-major, and its gradient (m), local numbering of
  /// element.hpp: for tests, large sparse systems and the spectrum.
  void element_hessian(const Path& path, int k, std::span<double> hessian, std::span<double> gradient);

  /// ∂S_h/∂p of an active parameter, returned, and ∂²S_h/∂x∂p, laid out as Path::x: the m local unknowns of
  /// each element, its share of the nodes at q_a and q_b.
  double parameter_slope(const Path& path, int parameter, AlignedDoubles& mixed) {
    double by_duration = 0;
    return parameter_slope(path, parameter, mixed, by_duration);
  }
  /// The same, and ∂²S_h/∂T∂p.
  double parameter_slope(const Path& path, int parameter, AlignedDoubles& mixed, double& by_duration);

  /// In place of the gradient, a load over the local unknowns of the elements, laid out as `mixed`, and one
  /// on T: condensed into `nodes` with the factors there are. Momenta that are given do not add to it. The
  /// gradient is to be evaluated anew after it.
  void put_load(const Path& path, const AlignedDoubles& load, double on_duration);

  /// Entry (i, j), i >= j, of the Hessian of element k in (q_a, q_b), 2n × 2n, as evaluate() condensed it.
  double condensed(int k, int i, int j) const {
    const std::size_t place = condensation_->fronts.ends() + std::size_t(i) * 2 * n_ + j;
    return matrix(k / lanes_)[place * lanes_ + k % lanes_];
  }
  /// Of each element of a batch the n × n blocks (q_a, q_a), (q_b, q_a) and (q_b, q_b) of it, row by row; the
  /// first alone, if the others are empty.
  void copy_condensed(int batch, std::span<double* const> start, std::span<double* const> lower = {},
                      std::span<double* const> end = {}) const;

  /// ∂x_u/∂x_e of inner unknown u of element k by the ends e (q_a, then q_b), at fields[u*2n + e], by the
  /// elimination that evaluate() made.
  void inner_by_ends(int k, std::span<double> fields) const;

  /// Rows of the remainder at the quadrature points of a batch, as Lagrangian::evaluate returns them.
  const double* rows(const Path& path, int batch, Order order);

 private:
  /// In doubles: what elimination works on, the gradient and the border after it; a vector; a row of points;
  /// what is summed up.
  struct Sizes {
    std::size_t matrix, vector, points, sums;
  };
  /// What a batch leaves to be summed up, in lanes; the gradient at the ends of the elements last.
  enum Sum { of_action, of_slope, of_corner, of_negative, of_ratio, of_residual, of_ends };
  double* sums(int b, Sum sum) { return sums_.data() + b * sizes_.sums + sum * lanes_; }
  const double* sums(int b, Sum sum) const { return sums_.data() + b * sizes_.sums + sum * lanes_; }
  /// What one batch is evaluated on; each thread has its own.
  struct Buffers {
    Scratch scratch;
    AlignedDoubles q, v, t, rows, work;
  };
  template <class Evaluate, class Gather>
  void for_batches(const Evaluate& evaluate, const Gather& gather);
  ElementBatch batch(const Path& path, int b, Buffers& buffers);
  void play(const ElementBatch& batch, Order order, Buffers& buffers);
  void condense(const Path& path, int b, Buffers& buffers);
  void set_buffers(bool condense);
  void make_room(Buffers& buffers) const;
  void evaluate_border(const Path& path, const ElementBatch& elements, double* row, double* corner);
  void assemble_gradient(const ElementBatch& elements, int b, double* gradient);
  void keep_gradient(int b, const double* gradient);
  const ExtendedGradient::Values& taken() const { return changed_ ? extended_.change() : extended_.values(); }
  void take_extended(int b, double* gradient);
  void reduce_gradient(const Path& path);
  void finish_extended();
  void gather(const Path& path, int b);
  void gather_pivots(int b);
  struct Blocks {
    double *start, *end, *lower;
  };
  Blocks blocks(int k);
  void gather_schur(int b);
  void gather_large_schur(int b);
  static void mirror(double* block, int n);
  void mirror_blocks();
  void gather_border(int b);
  void gather_gradient(int b);
  void eliminated(int b, const double* x, const double* y, double* sum) const;
  void clear_sums();
  bool stop() { return stopped_ = stopped_ || deadline_.passed(); }
  void measure_corners(const Path& path);
  void add_corners();
  void finish_sums();
  void add_momenta();
  void add_costs(const Path& path);
  void add_stiffness_of_costs();
  std::size_t batch_size() const { return sizes_.matrix + 2 * sizes_.vector; }
  double* matrix(int b) { return matrices_.data() + b * batch_size(); }
  const double* matrix(int b) const { return matrices_.data() + b * batch_size(); }
  double* reduced(int b) { return matrix(b) + sizes_.matrix; }
  const double* reduced(int b) const { return matrix(b) + sizes_.matrix; }

  const Lagrangian* lagrangian_ = nullptr;
  const ElementTables* tables_ = nullptr;
  const Assembly* assembly_ = nullptr;
  const Elimination* elimination_ = nullptr;
  const ElementTables::Condensation* condensation_ = nullptr;
  int lanes_ = simd_lanes();
  int n_ = 0, elements_ = 0, batches_ = 0, inner_ = 0, unknowns_ = 0;
  Condense condense_ = Condense::to_nodes;
  bool border_ = false, finite_ = false;
  Deadline deadline_;
  bool stopped_ = false;                               ///< at the deadline
  bool extended_on_ = false, extended_ready_ = false;  ///< asked for; evaluated at the path
  ExtendedGradient extended_;
  std::span<const double> momenta_;
  std::span<const EndCost> costs_;
  std::vector<double> cost_slopes_;  ///< 2n, of the path evaluated last; empty without costs
  bool changed_ = false;             ///< its change is taken in its place
  double action_ = 0, slope_duration_ = 0, residual_ = 0, momentum_scale_ = 0;
  Sizes sizes_{};
  std::vector<Buffers> buffers_;               // the first of the thread that calls
  AlignedDoubles matrices_, inverses_, sums_;  // of every batch
  AlignedDoubles entries_;
  const ClosingMap* closed_ = nullptr;
  std::vector<Corner> corners_;
  std::vector<double> raw_nodes_, start_gradient_, end_gradient_;
};

}  // namespace extremal
