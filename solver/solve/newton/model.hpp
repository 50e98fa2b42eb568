#pragma once

#include <memory>
#include <span>
#include <vector>

#include "action/discrete_action.hpp"
#include "linear/inertia.hpp"
#include "problem/problem.hpp"
#include "solve/periodic/phase.hpp"

/// \file The quadratic model of S_h at a path, from which Newton steps come.

namespace extremal {

/// The equation that closes a free duration: row over (q(0), q(T)) and its value, or, where the row is
/// empty, ∂S/∂T + energy = 0, whose row is the border itself.
struct ClosingEquation {
  std::vector<double> row;  ///< 2n, or empty
  double value = 0;         ///< to become zero
  double by_duration = 0;   ///< the coefficient of T beside a row
};

/// A step of every unknown.
struct Step {
  std::vector<double> nodes;  ///< (N + 1) × n
  /// What rounding left of them, of a model with 106 bits: M/h makes a force of a last digit.
  std::vector<double> nodes_low;
  AlignedDoubles inner;  ///< laid out as Path::x
  double duration = 0;
};

/// The values of a path as a step from zero.
inline Step values_of(const Path& path) {
  Step step;
  step.nodes.assign(path.nodes().begin(), path.nodes().end());
  step.inner.assign(path.x(0), path.x(path.batches()));
  return step;
}

/// What a second variation is taken by: the path alone, T held, or the duration as well.
enum class VariedBy { path, path_and_duration };

/// The second variation under the boundary relation, or an approximation of it, factored; `closing` is null
/// where T is fixed. Keeps memory.
class QuadraticModel {
 public:
  virtual ~QuadraticModel() = default;

  virtual void reset(const Problem& problem, const ElementTables& tables, int elements) = 0;
  /// S_h, its gradient and Hessian at a path, factored. False if the Hessian is singular to working
  /// precision; where the action is not finite nothing is factored (see DiscreteAction::finite).
  virtual bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) = 0;
  /// S_h and its gradient at another path, with the factors there are.
  virtual void evaluate_gradient(DiscreteAction& action, const Path& path) = 0;
  /// The step from the gradient that was evaluated last.
  virtual void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) = 0;
  /// Adds to the gradient by q(0) and q(T) (2n) that was evaluated last.
  virtual void add_at_ends(DiscreteAction& action, std::span<const double> parts);
  /// Directions that evaluate() and solve() hold from now until reset(); null for none.
  void set_phases(const PhaseConditions* phases) { phases_ = phases; }
  /// From now until reset() steps have nothing along directions whose eigenvalue is so small, relative, or
  /// smaller, where ends are free; for the present factors too.
  virtual void set_null_below(double) {}
  /// How many such directions the last step had nothing along.
  virtual int left_out() const { return 0; }
  /// Whether solve() refines (the default), or leaves the error that growth of the factors makes.
  void set_refining(bool on) { refining_ = on; }
  /// Of the second variation. Eigenvalues within `threshold` of zero, relative, count as null, and so do the
  /// directions that are held: the form is taken across them.
  virtual Inertia inertia(double threshold, VariedBy by = VariedBy::path) = 0;

 protected:
  bool refining_ = true;
  const PhaseConditions* phases_ = nullptr;
};

/// The second variation itself.
class SecondVariationModel : public QuadraticModel {
 public:
  /// The step that a load on the nodes between elements, (N + 1) × n, would cause: with K the second
  /// variation and the equation that closes the duration, K·step = load. Loads on the ends are left out. The
  /// gradient is evaluated anew after it.
  virtual void respond(DiscreteAction& action, const ClosingEquation* closing, std::span<const double> load,
                       Step& step) = 0;
  /// In place of the gradient, a load over the local unknowns of the elements, as DiscreteAction::put_load
  /// takes it, and one on T: solve() then gives the step with K·step = −load. The gradient is to be evaluated
  /// anew after it.
  virtual void put_load(DiscreteAction& action, const Path& path, const AlignedDoubles& load,
                        double on_duration) = 0;
};

/// Inner unknowns condensed element by element in lanes, then a chain of dense blocks: few coordinates.
std::unique_ptr<SecondVariationModel> make_condensed_model();

/// The same with 106 bits, and steps from gradients that have them too.
std::unique_ptr<SecondVariationModel> make_extended_model();
/// Whether the system and its elements allow that.
bool extended_model_suits(const Problem& problem, const ElementTables& tables, int elements);

}  // namespace extremal
