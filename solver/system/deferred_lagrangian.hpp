#pragma once

#include <functional>
#include <memory>
#include <mutex>

#include "system/lagrangian.hpp"

namespace extremal {

/// A Lagrangian that is made when it is first evaluated: it may never be. All derivatives are taken to be
/// there, and points are evaluated one by one; who evaluates many asks for what is made.
class DeferredLagrangian final : public Lagrangian {
 public:
  using Make = std::function<std::shared_ptr<const Lagrangian>()>;
  /// Of a smooth L without t and without active parameters.
  DeferredLagrangian(int coordinates, Make make);

  std::shared_ptr<const Lagrangian> made() const;

  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  /// Throws std::logic_error: there are no parameters.
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override;

 private:
  Make make_;
  mutable std::once_flag once_;
  mutable std::shared_ptr<const Lagrangian> made_;
};

/// A deferred one as it is made; others themselves.
std::shared_ptr<const Lagrangian> as_made(std::shared_ptr<const Lagrangian> lagrangian);

}  // namespace extremal
