#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "dense.hpp"
#include "integrator.hpp"
#include "shooting.hpp"

/// \file The equations of shooting and their correction.

namespace bench::shooting {

/// States at the beginning of each segment, row by row, and the duration; or a change of these.
struct Iterate {
  std::vector<double> states;
  double duration = 0;
};

/// Continuity between K segments, and the components given at the end. Changes of states are functions of n
/// unknowns u, those of the start and the duration. With the variations Φ_k along segment k:
///   δs_{k+1} = R_k u + d_k,
///   R_k = Φ_k R_{k−1}, plus (q', q'')/K at the end of the segment in the column of the duration,
///   d_k = Φ_k d_{k−1} + end_k − s_{k+1}.
template <class System, bool free_duration>
class Segments {
 public:
  Segments(const System& system, const BoundaryProblem& problem, int count)
      : system_(system),
        problem_(problem),
        count_(count),
        size_(2 * system.n),
        integrator_(system_, {problem.q_scale, problem.v_scale}),
        first_(system_, system.n - free_duration),
        others_(count - 1, Others(system_, size_)),
        next_others_(others_),
        ends_(static_cast<std::size_t>(count) * size_),
        defects_(ends_),
        response_(ends_.size() * system.n),
        steps_(count),
        matrix_(system.n),
        unknowns_(system.n) {}

  void forget_steps() { std::fill(steps_.begin(), steps_.end(), 0.0); }
  /// Adapts the kept lengths of steps to a tolerance that is `ratio` times the last.
  void change_tolerance(double ratio) {
    for (double& step : steps_) step *= std::pow(ratio, 1.0 / 8);
  }

  /// Integrates all segments. False if one of the integrations fails.
  bool evaluate(const Iterate& iterate, double tolerance) {
    return integrate(iterate, [&](int k, double duration) {
      return integrator_.advance(end(k), duration, tolerance, steps_[k]);
    });
  }

  /// The same with variations, which factor() needs.
  bool evaluate_with_variations(const Iterate& iterate, double tolerance) {
    first_.clear();
    for (int j = 0; j < unknowns(); ++j) first_.at(problem_.unknown[j], j) = 1;
    for (Others& other : next_others_) {
      other.clear();
      for (int c = 0; c < size_; ++c) other.at(c, c) = 1;
    }
    return integrate(iterate, [&](int k, double duration) {
      return k == 0 ? integrator_.advance(end(k), duration, tolerance, steps_[k], first_)
                    : integrator_.advance(end(k), duration, tolerance, steps_[k], next_others_[k - 1]);
    });
  }

  /// Matrices of the last variations, for correct(). False if they are singular.
  bool factor() {
    std::swap(others_, next_others_);
    for (int k = 0; k < count_; ++k) add_response(k);
    for (int i = 0; i < n(); ++i)
      for (int j = 0; j < n(); ++j) matrix_.at(i, j) = response(count_ - 1, problem_.given[i])[j];
    return matrix_.factor();
  }

  /// The solution of the linearised equations with the last factors. Returns its largest component, in the
  /// scales.
  double correct(const Iterate& iterate, Iterate& change) {
    for (int k = 0; k < count_; ++k) add_defect(iterate, k);
    for (int i = 0; i < n(); ++i) unknowns_[i] = problem_.value[i] - defect(count_ - 1)[problem_.given[i]];
    matrix_.solve(unknowns_.data());
    std::fill_n(change.states.begin(), size_, 0.0);
    for (int j = 0; j < unknowns(); ++j) change.states[problem_.unknown[j]] = unknowns_[j];
    for (int k = 1; k < count_; ++k)
      for (int c = 0; c < size_; ++c) {
        double sum = defect(k - 1)[c];
        for (int j = 0; j < n(); ++j) sum += response(k - 1, c)[j] * unknowns_[j];
        change.states[k * size_ + c] = sum;
      }
    change.duration = free_duration ? unknowns_[n() - 1] : 0;
    return size(iterate, change);
  }

 private:
  using First = Variations<System, System::first_width(free_duration)>;
  using Others = Variations<System, System::width>;

  int n() const { return system_.n; }
  int unknowns() const { return n() - free_duration; }  ///< of the first state
  double* end(int k) { return ends_.data() + k * size_; }
  double* defect(int k) { return defects_.data() + k * size_; }
  double* response(int k, int component) { return response_.data() + (k * size_ + component) * n(); }

  template <class Advance>
  bool integrate(const Iterate& iterate, const Advance& advance) {
    ends_ = iterate.states;
    for (int k = 0; k < count_; ++k) {
      if (steps_[k] == 0 && k > 0) steps_[k] = steps_[k - 1];
      if (!advance(k, iterate.duration / count_)) return false;
    }
    return true;
  }

  /// Row by row, from those of the segment before.
  void add_response(int k) {
    for (int c = 0; c < size_; ++c) {
      double* const row = response(k, c);
      if (k == 0) {
        for (int j = 0; j < unknowns(); ++j) row[j] = first_.at(c, j);
        if constexpr (free_duration) row[n() - 1] = 0;
        continue;
      }
      std::fill_n(row, n(), 0.0);
      for (int i = 0; i < size_; ++i) {
        const double variation = others_[k - 1].at(c, i);
        const double* const before = response(k - 1, i);
        for (int j = 0; j < n(); ++j) row[j] += variation * before[j];
      }
    }
    if constexpr (free_duration) add_slope(k);
  }

  void add_slope(int k) {
    typename System::Coordinates acceleration = system_.coordinates();
    const double *const q = end(k), *const v = q + n();
    system_.acceleration(q, v, acceleration.data(), nullptr);
    for (int c = 0; c < n(); ++c) {
      response(k, c)[n() - 1] += v[c] / count_;
      response(k, n() + c)[n() - 1] += acceleration[c] / count_;
    }
  }

  void add_defect(const Iterate& iterate, int k) {
    for (int c = 0; c < size_; ++c) {
      double sum = end(k)[c];
      if (k + 1 < count_) sum -= iterate.states[(k + 1) * size_ + c];
      if (k > 0)
        for (int i = 0; i < size_; ++i) sum += others_[k - 1].at(c, i) * defect(k - 1)[i];
      defect(k)[c] = sum;
    }
  }

  double size(const Iterate& iterate, const Iterate& change) const {
    double largest = std::abs(change.duration) / iterate.duration;
    for (std::size_t i = 0; i < change.states.size(); ++i) {
      const double scale = static_cast<int>(i % size_) < n() ? problem_.q_scale : problem_.v_scale;
      largest = std::max(largest, std::abs(change.states[i]) / scale);
    }
    return std::isfinite(largest) ? largest : INFINITY;
  }

  System system_;
  const BoundaryProblem& problem_;
  int count_, size_;
  Integrator<System> integrator_;
  First first_;
  std::vector<Others> others_, next_others_;  ///< of the factors; of the last evaluation
  std::vector<double> ends_, defects_, response_, steps_;
  Lu matrix_;
  std::vector<double> unknowns_;
};

}  // namespace bench::shooting
