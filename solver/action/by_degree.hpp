#pragma once

#include <fmt/format.h>

#include <array>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "action/scheme.hpp"

/// \file What belongs to a degree and to nothing else.

namespace extremal {

/// One T for each degree, made when it is first asked for, by any thread.
template <class T>
class ByDegree {
 public:
  explicit ByDegree(T (*make)(int degree)) : make_(make) {}

  /// Throws std::invalid_argument unless 1 <= degree <= max_degree.
  const T& at(int degree) {
    if (degree < 1 || degree > max_degree)
      throw std::invalid_argument(fmt::format("degree = {}; need 1 to {}", degree, max_degree));
    std::call_once(made_[degree], [&] { kept_[degree].emplace(make_(degree)); });
    return *kept_[degree];
  }

 private:
  T (*make_)(int degree);
  std::array<std::once_flag, max_degree + 1> made_;
  std::array<std::optional<T>, max_degree + 1> kept_;
};

}  // namespace extremal
