#include "machine/functions.hpp"
#include "machine/lanes.hpp"
#include "system/tape_code.hpp"

/// \file The interpreter: one dispatch for each instruction and chunk, then a loop over the chunk.

namespace extremal::EXTREMAL_LEVEL {

namespace {

/// One instruction with its operands looked up.
struct Step {
  Vec* d;
  const Vec *a, *b;
  Vec* c;
  Vec s;
  int batches;
};

template <Code code>
inline Vec arithmetic(Vec a, Vec b, Vec c, Vec s) {
  if constexpr (code == Code::copy) return a;
  if constexpr (code == Code::negate) return -a;
  if constexpr (code == Code::fill) return s;
  if constexpr (code == Code::add) return a + b;
  if constexpr (code == Code::add_scalar) return a + s;
  if constexpr (code == Code::subtract) return a - b;
  if constexpr (code == Code::subtract_from) return s - a;
  if constexpr (code == Code::multiply) return a * b;
  if constexpr (code == Code::multiply_negate) return -(a * b);
  if constexpr (code == Code::scale) return s * a;
  if constexpr (code == Code::multiply_add) return a * b + c;
  if constexpr (code == Code::multiply_sub) return a * b - c;
  if constexpr (code == Code::sub_multiply) return c - a * b;
  if constexpr (code == Code::negate_all) return -(a * b) - c;
  if constexpr (code == Code::scale_add) return s * a + b;
  if constexpr (code == Code::scale_sub) return s * a - b;
  if constexpr (code == Code::multiply_scalar) return a * b + s;
  if constexpr (code == Code::scalar_multiply) return s - a * b;
  if constexpr (code == Code::divide) return a / b;
  if constexpr (code == Code::reciprocal) return broadcast(1) / a;
  if constexpr (code == Code::square_root) return sqrt(a);
  if constexpr (code == Code::reciprocal_root) return broadcast(1) / sqrt(a);
}

/// Fixed: the number of batches where it is known, so that the loop is unrolled; otherwise 0.
template <int fixed, Code code>
__attribute__((always_inline)) inline void run(const Step& x) {
  if constexpr (fixed > 0) {
#pragma GCC unroll 8
    for (int k = 0; k < fixed; ++k) x.d[k] = arithmetic<code>(x.a[k], x.b[k], x.c[k], x.s);
  } else {
    for (int k = 0; k < x.batches; ++k) x.d[k] = arithmetic<code>(x.a[k], x.b[k], x.c[k], x.s);
  }
}

inline void map(const Step& x, Vec (*function)(Vec)) {
  for (int k = 0; k < x.batches; ++k) x.d[k] = function(x.a[k]);
}

inline void map(const Step& x, Vec (*function)(Vec, Vec)) {
  for (int k = 0; k < x.batches; ++k) x.d[k] = function(x.a[k], x.b[k]);
}

void map_sincos(const Step& x) {
  for (int k = 0; k < x.batches; ++k) {
    Vec sine, cosine;
    sincos(x.a[k], sine, cosine);
    x.d[k] = sine;
    x.c[k] = cosine;
  }
}

__attribute__((noinline)) void elementary(Code code, const Step& x) {
  switch (code) {
    case Code::step:
      return map(x, step);
    case Code::minimum:
      return map(x, min);
    case Code::maximum:
      return map(x, max);
    case Code::absolute:
      return map(x, abs);
    case Code::power:
      return map(x, pow);
    case Code::exponential:
      return map(x, exp);
    case Code::logarithm:
      return map(x, log);
    case Code::sine:
      return map(x, sin);
    case Code::cosine:
      return map(x, cos);
    case Code::sine_cosine:
      return map_sincos(x);
    case Code::tangent:
      return map(x, tan);
    case Code::arcsine:
      return map(x, asin);
    case Code::arccosine:
      return map(x, acos);
    case Code::arctangent:
      return map(x, atan);
    case Code::arctangent2:
      return map(x, atan2);
    case Code::hyperbolic_sine:
      return map(x, sinh);
    case Code::hyperbolic_cosine:
      return map(x, cosh);
    default:
      return map(x, tanh);
  }
}

template <int fixed>
inline void dispatch(Code code, const Step& x) {
  switch (code) {
    case Code::copy:
      return run<fixed, Code::copy>(x);
    case Code::negate:
      return run<fixed, Code::negate>(x);
    case Code::fill:
      return run<fixed, Code::fill>(x);
    case Code::add:
      return run<fixed, Code::add>(x);
    case Code::add_scalar:
      return run<fixed, Code::add_scalar>(x);
    case Code::subtract:
      return run<fixed, Code::subtract>(x);
    case Code::subtract_from:
      return run<fixed, Code::subtract_from>(x);
    case Code::multiply:
      return run<fixed, Code::multiply>(x);
    case Code::multiply_negate:
      return run<fixed, Code::multiply_negate>(x);
    case Code::scale:
      return run<fixed, Code::scale>(x);
    case Code::multiply_add:
      return run<fixed, Code::multiply_add>(x);
    case Code::multiply_sub:
      return run<fixed, Code::multiply_sub>(x);
    case Code::sub_multiply:
      return run<fixed, Code::sub_multiply>(x);
    case Code::negate_all:
      return run<fixed, Code::negate_all>(x);
    case Code::scale_add:
      return run<fixed, Code::scale_add>(x);
    case Code::scale_sub:
      return run<fixed, Code::scale_sub>(x);
    case Code::multiply_scalar:
      return run<fixed, Code::multiply_scalar>(x);
    case Code::scalar_multiply:
      return run<fixed, Code::scalar_multiply>(x);
    case Code::divide:
      return run<fixed, Code::divide>(x);
    case Code::reciprocal:
      return run<fixed, Code::reciprocal>(x);
    case Code::square_root:
      return run<fixed, Code::square_root>(x);
    case Code::reciprocal_root:
      return run<fixed, Code::reciprocal_root>(x);
    default:
      return elementary(code, x);
  }
}

template <int fixed>
void play_chunk(const Instruction* code, int length, double* const* operands, const double* scalars,
                int batches) {
  for (const Instruction* i = code; i != code + length; ++i) {
    dispatch<fixed>(i->code, {&at(operands[i->d]), &at(operands[i->a]), &at(operands[i->b]),
                              &at(operands[i->c]), broadcast(scalars[i->s]), batches});
  }
}

}  // namespace

void play(const Instruction* code, int length, double* const* operands, const double* scalars, int batches) {
  switch (batches) {
    case 1:
      return play_chunk<1>(code, length, operands, scalars, batches);
    case 8:
      return play_chunk<8>(code, length, operands, scalars, batches);
    default:
      return play_chunk<0>(code, length, operands, scalars, batches);
  }
}

}  // namespace extremal::EXTREMAL_LEVEL
