#include "linear/extended_kernels.hpp"
#include "machine/lanes.hpp"

// Contraction into fused operations is off for this file: error-free sums and products rely on each
// operation being rounded by itself.

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// a b = high + low exactly.
inline TwoDoubles product(double a, double b) {
  const double high = a * b;
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
  return {high, __builtin_fma(a, b, -high)};
#else
  constexpr double splitter = 134217729;  // 2²⁷ + 1
  const double ca = splitter * a, cb = splitter * b, a1 = ca - (ca - a), b1 = cb - (cb - b), a2 = a - a1,
               b2 = b - b1;
  return {high, ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2};
#endif
}

/// a + b = high + low exactly.
inline TwoDoubles sum(double a, double b) {
  const double high = a + b, part = high - a;
  return {high, (a - (high - part)) + (b - part)};
}

/// The same where |a| >= |b|.
inline TwoDoubles ordered_sum(double a, double b) {
  const double high = a + b;
  return {high, b - (high - a)};
}

inline TwoDoubles times(TwoDoubles a, TwoDoubles b) {
  const TwoDoubles p = product(a.high, b.high);
  return ordered_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

inline TwoDoubles plus(TwoDoubles a, TwoDoubles b) {
  const TwoDoubles high = sum(a.high, b.high), low = sum(a.low, b.low),
                   first = ordered_sum(high.high, high.low + low.high);
  return ordered_sum(first.high, first.low + low.low);
}

void add_scaled(long count, TwoDoubles s, const double* __restrict x_high, const double* __restrict x_low,
                double* __restrict y_high, double* __restrict y_low) {
  if (x_low)
    for (long i = 0; i < count; ++i) {
      const TwoDoubles y = plus({y_high[i], y_low[i]}, times(s, {x_high[i], x_low[i]}));
      y_high[i] = y.high;
      y_low[i] = y.low;
    }
  else
    for (long i = 0; i < count; ++i) {
      const TwoDoubles p = product(s.high, x_high[i]);
      const TwoDoubles y = plus({y_high[i], y_low[i]}, ordered_sum(p.high, p.low + s.low * x_high[i]));
      y_high[i] = y.high;
      y_low[i] = y.low;
    }
}

TwoDoubles multiply(TwoDoubles a, TwoDoubles b) { return times(a, b); }

/// Long division: three quotients of doubles.
TwoDoubles divide(TwoDoubles a, TwoDoubles b) {
  const double first = a.high / b.high;
  TwoDoubles rest = plus(a, times({-first, 0}, b));
  const double second = rest.high / b.high;
  rest = plus(rest, times({-second, 0}, b));
  const TwoDoubles quotient = ordered_sum(first, second);
  return plus(quotient, {rest.high / b.high, 0});
}

}  // namespace

ExtendedKernels extended_kernels() { return {add_scaled, multiply, divide}; }

}  // namespace extremal::EXTREMAL_LEVEL
