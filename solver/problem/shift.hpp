#pragma once

#include <memory>

#include "problem/manifold.hpp"
#include "system/lagrangian.hpp"

/// \file Systems whose time begins later.

namespace extremal {

/// L(q, q', t + by): the same object where L does not depend on t.
std::shared_ptr<const Lagrangian> shift_time(std::shared_ptr<const Lagrangian> lagrangian, double by);

/// The manifold of g(q, t + by) = 0, with L(q, q', t + by).
std::shared_ptr<const Manifold> shift_time(std::shared_ptr<const Manifold> manifold, double by);

}  // namespace extremal
