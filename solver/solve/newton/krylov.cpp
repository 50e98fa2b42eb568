#include "solve/newton/krylov.hpp"
#include "solve/newton/limits.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <unsupported/Eigen/IterativeSolvers>

namespace extremal {

using namespace limits::krylov;
namespace {
class ModelledVariation;
}
}  // namespace extremal

template <>
struct Eigen::internal::traits<extremal::ModelledVariation>
    : Eigen::internal::traits<Eigen::SparseMatrix<double>> {};

namespace extremal {

namespace {

/// A⁻¹ δ²S, with A⁻¹ the factors of the model, on steps laid out one part behind the other.
class ModelledVariation : public Eigen::EigenBase<ModelledVariation> {
 public:
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum {
    ColsAtCompileTime = Eigen::Dynamic,
    MaxColsAtCompileTime = Eigen::Dynamic,
    RowsAtCompileTime = Eigen::Dynamic,
    MaxRowsAtCompileTime = Eigen::Dynamic,
    IsRowMajor = false
  };

  ModelledVariation(DiscreteAction& action, QuadraticModel& model, const Path& path,
                    const ClosingEquation* closing, const Step& step)
      : action_(action), model_(model), path_(path), closing_(closing), step_(step) {}

  Eigen::Index rows() const { return std::ssize(step_.nodes) + std::ssize(step_.inner) + 1; }
  Eigen::Index cols() const { return rows(); }
  template <class Right>
  Eigen::Product<ModelledVariation, Right, Eigen::AliasFreeProduct> operator*(
      const Eigen::MatrixBase<Right>& right) const {
    return {*this, right.derived()};
  }

  Eigen::VectorXd flat(const Step& step) const {
    Eigen::VectorXd x(rows());
    std::copy(step.inner.begin(), step.inner.end(),
              std::copy(step.nodes.begin(), step.nodes.end(), x.begin()));
    x[x.size() - 1] = step.duration;
    return x;
  }
  void fold(const Eigen::VectorXd& x, Step& step) const {
    const auto inner = x.begin() + std::ssize(step.nodes);
    std::copy(x.begin(), inner, step.nodes.begin());
    std::copy(inner, x.end() - 1, step.inner.begin());
    step.duration = x[x.size() - 1];
  }
  Eigen::VectorXd apply(const Eigen::VectorXd& x) const;

 private:
  DiscreteAction& action_;
  QuadraticModel& model_;
  const Path& path_;
  const ClosingEquation* closing_;
  mutable Step step_;
};

/// Solved for as a gradient would be, whose step takes it back.
Eigen::VectorXd ModelledVariation::apply(const Eigen::VectorXd& x) const {
  fold(x, step_);
  action_.put_change(path_, {step_.nodes, step_.inner, step_.duration});
  ClosingEquation change;
  if (closing_) {
    change.row = closing_->row;
    const std::size_t n = change.row.size() / 2, last = step_.nodes.size() - 2 * n;
    for (std::size_t e = 0; e < 2 * n; ++e) change.value += change.row[e] * step_.nodes[e < n ? e : last + e];
  }
  model_.solve(action_, closing_ ? &change : nullptr, step_);
  return -flat(step_);
}

}  // namespace

}  // namespace extremal

template <class Right>
struct Eigen::internal::generic_product_impl<extremal::ModelledVariation, Right, Eigen::SparseShape,
                                             Eigen::DenseShape, Eigen::GemvProduct>
    : generic_product_impl_base<extremal::ModelledVariation, Right,
                                generic_product_impl<extremal::ModelledVariation, Right>> {
  template <class To>
  static void scaleAndAddTo(To& to, const extremal::ModelledVariation& variation, const Right& right,
                            const double& factor) {
    to += factor * variation.apply(right);
  }
};

namespace extremal {

void refine_by_krylov(DiscreteAction& action, QuadraticModel& model, const Path& path,
                      const ClosingEquation* closing, Step& step) {
  const ModelledVariation variation(action, model, path, closing, step);
  Eigen::GMRES<ModelledVariation, Eigen::IdentityPreconditioner> gmres;
  gmres.setTolerance(enough).setMaxIterations(most_iterations);
  gmres.set_restart(most_iterations);
  gmres.compute(variation);
  const Eigen::VectorXd better = gmres.solve(variation.flat(step));
  if (better.allFinite()) variation.fold(better, step);
  action.put_gradient(path);
}

}  // namespace extremal
