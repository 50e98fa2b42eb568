#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "method.hpp"

/// \file Variations of a motion.

namespace bench::shooting {

/// Derivatives x of q and y of q' in a number of directions, in blocks of `width` columns, row by row.
template <class System, int width>
class Variations {
 public:
  /// `system` must outlive it.
  Variations(const System& system, int columns)
      : system_(system),
        x_((columns + width - 1) / width, system.template columns<width>()),
        y_(x_),
        stage_x_(system.template columns<width>()),
        stage_y_(stage_x_) {
    w_.fill(stage_x_);
  }

  void clear() {
    for (std::vector<Columns>* half : {&x_, &y_})
      for (Columns& block : *half) std::fill(block.begin(), block.end(), 0.0);
  }
  /// Components are numbered (q, q').
  double& at(int component, int column) {
    std::vector<Columns>& half = component < system_.n ? x_ : y_;
    return half[column / width][component % system_.n * width + column % width];
  }

  /// A step of length h; `slope` holds the derivatives of q'' at the stages of the motion.
  void step(const std::array<typename System::Slope, stages>& slope, double h) {
    for (std::size_t block = 0; block < x_.size(); ++block) {
      system_.template vary<width>(slope[0], x_[block].data(), y_[block].data(), w_[0].data());
      take_stages(slope, x_[block], y_[block], h, std::make_index_sequence<stages - 1>());
      sum<EndOfStep, true>(x_[block], y_[block], h, stage_x_, stage_y_);
      std::swap(x_[block], stage_x_);
      std::swap(y_[block], stage_y_);
    }
  }

 private:
  using Columns = typename System::template Columns<width>;

  template <std::size_t... i>
  void take_stages(const std::array<typename System::Slope, stages>& slope, const Columns& x,
                   const Columns& y, double h, std::index_sequence<i...>) {
    ((sum<Stage<i + 1>, !System::velocity_free>(x, y, h, stage_x_, stage_y_),
      system_.template vary<width>(slope[i + 1], stage_x_.data(), stage_y_.data(), w_[i + 1].data())),
     ...);
  }

  template <class Row, bool velocities>
  void sum(const Columns& x, const Columns& y, double h, Columns& next_x, Columns& next_y) const {
    const double *const from_x = x.data(), *const from_y = y.data();
    double* const __restrict to_x = next_x.data(), * const __restrict to_y = next_y.data();
    const std::array<const double*, stages> w = pointers(std::make_index_sequence<stages>());
    const int size = system_.n * width;
    for (int e = 0; e < size; ++e) {
      const auto value = [&](int k) { return w[k][e]; };
      to_x[e] = from_x[e] + h * (Row::c * from_y[e] + h * sum_stages<Row, Of::position>(value));
      if constexpr (velocities) to_y[e] = from_y[e] + h * sum_stages<Row, Of::velocity>(value);
    }
  }

  template <std::size_t... k>
  std::array<const double*, stages> pointers(std::index_sequence<k...>) const {
    return {w_[k].data()...};
  }

  const System& system_;
  std::vector<Columns> x_, y_;  ///< one a block
  Columns stage_x_, stage_y_;
  std::array<Columns, stages> w_;
};

}  // namespace bench::shooting
