#pragma once

#include "machine/simd.hpp"

/// \file The instructions of a tape and who plays them. Kernels include this: no inline functions here.

namespace extremal {

/// d = …, over the points of a chunk. a, b, c: operands that vary; s: a scalar.
enum class Code : unsigned {
  copy,             ///< a
  negate,           ///< −a
  fill,             ///< s
  add,              ///< a + b
  add_scalar,       ///< a + s
  subtract,         ///< a − b
  subtract_from,    ///< s − a
  multiply,         ///< a b
  multiply_negate,  ///< −a b
  scale,            ///< s a
  divide,           ///< a / b
  multiply_add,     ///< a b + c
  multiply_sub,     ///< a b − c
  sub_multiply,     ///< c − a b
  negate_all,       ///< −a b − c
  scale_add,        ///< s a + c
  scale_sub,        ///< s a − c
  multiply_scalar,  ///< a b + s
  scalar_multiply,  ///< s − a b
  reciprocal,       ///< 1 / a
  square_root,      ///< √a
  reciprocal_root,  ///< 1 / √a
  step,
  minimum,
  maximum,
  absolute,
  power,
  exponential,
  logarithm,
  sine,
  cosine,
  sine_cosine,  ///< d = sin a, c = cos a
  tangent,
  arcsine,
  arccosine,
  arctangent,
  arctangent2,
  hyperbolic_sine,
  hyperbolic_cosine,
  hyperbolic_tangent,
};

struct Instruction {
  Code code;
  unsigned d, a, b, c;  ///< operands
  unsigned s;           ///< scalar
};

/// Plays `length` instructions on `batches` of one point for each lane. operands[k] is the first
/// point of operand k, aligned to 64 bytes.
using Player = void (*)(const Instruction* code, int length, double* const* operands, const double* scalars,
                        int batches);

/// The same on one point each, in numbers with more digits: long double or dd_real.
template <class Number>
void play_extended(const Instruction* code, int length, Number* const* operands, const double* scalars);

EXTREMAL_DECLARE_AT_EACH_LEVEL(void play(const Instruction* code, int length, double* const* operands,
                                         const double* scalars, int batches))

}  // namespace extremal
