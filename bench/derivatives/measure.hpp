#pragma once

#include <ceres/jet.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "hand.hpp"
#include "machine/aligned.hpp"
#include "system/tape.hpp"

namespace bench {

template <int m>
struct Number<ceres::Jet<ceres::Jet<double, m>, m>> {
  static auto of(double x) { return ceres::Jet<ceres::Jet<double, m>, m>(ceres::Jet<double, m>(x)); }
};

/// Processor time of this thread: what other programs take does not count.
inline double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Median over 21 repetitions of the seconds that one call takes; a repetition takes a millisecond or more.
template <class Function>
double seconds(Function&& function) {
  const auto time = [&](int calls) {
    const double start = processor_seconds();
    for (int k = 0; k < calls; ++k) function();
    return processor_seconds() - start;
  };
  int calls = 1;
  while (time(calls) < 1e-3) calls *= 2;
  std::vector<double> samples;
  for (int repetition = 0; repetition < 21; ++repetition) samples.push_back(time(calls) / calls);
  std::nth_element(samples.begin(), samples.begin() + 10, samples.end());
  return samples[10];
}

/// Points as rows of z, random but apart from every singularity.
struct Batch {
  int count;
  extremal::AlignedDoubles rows;
  Batch(int variables, int count) : count(count), rows(static_cast<std::size_t>(variables) * count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.1, 0.9);
    for (int k = 0; k < variables; ++k)
      for (int i = 0; i < count; ++i) rows[k * count + i] = 0.7 * (k / 3) + uniform(random) * (1 + k % 3);
  }
  extremal::Points points(int coordinates) const {
    return {count, count, rows.data(), rows.data() + static_cast<std::ptrdiff_t>(coordinates) * count,
            nullptr};
  }
};

/// Value, gradient and packed Hessian by dual numbers of dual numbers.
template <class System>
void by_jets(System, const double* z, double* out) {
  constexpr int m = System::variables;
  using Inner = ceres::Jet<double, m>;
  using Outer = ceres::Jet<Inner, m>;
  Outer x[m];
  for (int k = 0; k < m; ++k) {
    x[k].a = Inner(z[k], k);
    x[k].v[k] = Inner(1.0);
  }
  const Outer value = System::remainder(x);
  *out++ = value.a.a;
  for (int k = 0; k < m; ++k) *out++ = value.v[k].a;
  for (int k = 0; k < m; ++k)
    for (int l = 0; l <= k; ++l) *out++ = value.v[k].v[l];
}

/// Applies a function of one point to a batch.
template <class System, class Function>
void each_point(System system, const Batch& batch, double* out, Function function) {
  constexpr int m = System::variables, rows = 1 + m + m * (m + 1) / 2;
  for (int i = 0; i < batch.count; ++i) {
    double z[m], values[rows];
    for (int k = 0; k < m; ++k) z[k] = batch.rows[k * batch.count + i];
    function(system, z, values);
    for (int k = 0; k < rows; ++k) out[k * batch.count + i] = values[k];
  }
}

/// The largest difference, relative to the larger of 1 and the row's size.
inline double difference(const extremal::AlignedDoubles& a, const extremal::AlignedDoubles& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    largest = std::max(largest, std::abs(a[k] - b[k]) / std::max(1.0, std::abs(b[k])));
  return largest;
}

}  // namespace bench
