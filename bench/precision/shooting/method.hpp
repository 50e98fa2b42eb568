#pragma once

#include <cstddef>
#include <utility>

#include "motion/dop853_tableau.hpp"

/// \file DOP853 for q'' = f(q, q'). In every stage q' is a sum of accelerations. The stages of q are
/// therefore sums of accelerations with the weights Σ_j a_ij a_jk. This is the same method up to roundoff,
/// with half the sums where f does not depend on q'.

namespace bench::shooting {

namespace tableau = extremal::dop853;
inline constexpr int stages = tableau::stages;
using Weights = tableau::Row<double>;

/// Sums of products below this are zero: the order conditions of the tableau cancel them.
inline constexpr long double zero_product = 1e-15L;

/// Weights of accelerations in q, from weights of velocities in q.
constexpr Weights position_weights(const tableau::Row<long double>& velocities) {
  Weights result{};
  for (int k = 0; k < stages; ++k) {
    long double sum = 0;
    for (int j = 0; j < stages; ++j) sum += velocities[j] * tableau::a<long double>[j][k];
    if (sum > zero_product || sum < -zero_product) result[k] = static_cast<double>(sum);
  }
  return result;
}

/// Weights of order 8 less those of order 3.
template <class T>
constexpr tableau::Row<T> third_order_error() {
  tableau::Row<T> result{};
  for (int k = 0; k < stages; ++k) result[k] = tableau::b<T>[k] - tableau::b3<T>[k];
  return result;
}

/// q = q0 + h (c q0' + h Σ position_k f_k), q' = q0' + h Σ velocity_k f_k at stage i.
template <int i>
struct Stage {
  static constexpr double c = tableau::c<double>[i];
  static constexpr Weights position = position_weights(tableau::a<long double>[i]);
  static constexpr Weights velocity = tableau::a<double>[i];
};

/// The same at the end of the step.
struct EndOfStep {
  static constexpr double c = 1;
  static constexpr Weights position = position_weights(tableau::b<long double>);
  static constexpr Weights velocity = tableau::b<double>;
};

/// Differences from the embedded methods of order 5 and 3, over h² in q and over h in q'.
struct Error5 {
  static constexpr Weights position = position_weights(tableau::error5<long double>);
  static constexpr Weights velocity = tableau::error5<double>;
};
struct Error3 {
  static constexpr Weights position = position_weights(third_order_error<long double>());
  static constexpr Weights velocity = third_order_error<double>();
};

enum class Of { position, velocity };

template <class Row, Of of, std::size_t k, class Value>
inline void add_stage(double& sum, const Value& value) {
  constexpr double weight = of == Of::position ? Row::position[k] : Row::velocity[k];
  if constexpr (weight != 0) sum += weight * value(k);
}

/// Σ_k weight_k value(k), written out for the weights that are not zero.
template <class Row, Of of, class Value>
inline double sum_stages(const Value& value) {
  double sum = 0;
  [&]<std::size_t... k>(std::index_sequence<k...>) { (add_stage<Row, of, k>(sum, value), ...); }
  (std::make_index_sequence<stages>());
  return sum;
}

}  // namespace bench::shooting
