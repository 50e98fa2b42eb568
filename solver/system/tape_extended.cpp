#include <algorithm>
#include <cmath>

#include "system/tape_lagrangian.hpp"

/// \file A tape played at one point in extended precision, for equations whose roundoff is amplified.

namespace extremal {

namespace {

using Real = long double;

Real elementary(Code code, Real a, Real b) {
  switch (code) {
    case Code::step:
      return a >= b ? 1 : 0;
    case Code::minimum:
      return b < a ? b : a;
    case Code::maximum:
      return a < b ? b : a;
    case Code::absolute:
      return std::abs(a);
    case Code::power:
      return std::pow(a, b);
    case Code::exponential:
      return std::exp(a);
    case Code::logarithm:
      return std::log(a);
    case Code::sine:
    case Code::sine_cosine:
      return std::sin(a);
    case Code::cosine:
      return std::cos(a);
    case Code::tangent:
      return std::tan(a);
    case Code::arcsine:
      return std::asin(a);
    case Code::arccosine:
      return std::acos(a);
    case Code::arctangent:
      return std::atan(a);
    case Code::arctangent2:
      return std::atan2(a, b);
    case Code::hyperbolic_sine:
      return std::sinh(a);
    case Code::hyperbolic_cosine:
      return std::cosh(a);
    default:
      return std::tanh(a);
  }
}

Real value(Code code, Real a, Real b, Real c, Real s) {
  switch (code) {
    case Code::copy:
      return a;
    case Code::negate:
      return -a;
    case Code::fill:
      return s;
    case Code::add:
      return a + b;
    case Code::add_scalar:
      return a + s;
    case Code::subtract:
      return a - b;
    case Code::subtract_from:
      return s - a;
    case Code::multiply:
      return a * b;
    case Code::multiply_negate:
      return -(a * b);
    case Code::scale:
      return s * a;
    case Code::divide:
      return a / b;
    case Code::multiply_add:
      return a * b + c;
    case Code::multiply_sub:
      return a * b - c;
    case Code::sub_multiply:
      return c - a * b;
    case Code::negate_all:
      return -(a * b) - c;
    case Code::scale_add:
      return s * a + b;
    case Code::scale_sub:
      return s * a - b;
    case Code::multiply_scalar:
      return a * b + s;
    case Code::scalar_multiply:
      return s - a * b;
    case Code::reciprocal:
      return 1 / a;
    case Code::square_root:
      return std::sqrt(a);
    case Code::reciprocal_root:
      return 1 / std::sqrt(a);
    default:
      return elementary(code, a, b);
  }
}

}  // namespace

void play_extended(const Instruction* code, int length, Real* const* operands, const double* scalars) {
  for (const Instruction* i = code; i != code + length; ++i) {
    const Real a = *operands[i->a];
    *operands[i->d] = value(i->code, a, *operands[i->b], *operands[i->c], scalars[i->s]);
    if (i->code == Code::sine_cosine) *operands[i->c] = std::cos(a);
  }
}

void Tape::play_extended(const Real* q, const Real* v, Real t, Real* out, ExtendedScratch& scratch) const {
  scratch.memory.resize(std::max<std::size_t>(scratch.memory.size(), slots_));
  scratch.operands.resize(std::max<std::size_t>(scratch.operands.size(), operands_));
  Real** const operands = scratch.operands.data();
  for (const Track& track : tracks_) {
    const Program& program = track.program;
    Real **outputs = operands + program.inputs, **slots = outputs + program.outputs;
    for (int k = 0; k < program.slots; ++k) slots[k] = scratch.memory.data() + k;
    for (int r = 0; r < track.rows; ++r) {
      const std::uint32_t* source = track.sources.data() + static_cast<std::size_t>(r) * program.inputs;
      const Target* target = track.targets.data() + static_cast<std::size_t>(r) * program.outputs;
      for (int k = 0; k < program.inputs; ++k) {
        const Variable kind = track.kinds[k];
        operands[k] = kind == Variable::coordinate ? const_cast<Real*>(q + source[k])
                      : kind == Variable::velocity ? const_cast<Real*>(v + source[k])
                                                   : &t;
      }
      for (int k = 0; k < program.outputs; ++k) {
        outputs[k] = out + target[k].row;
        if (target[k].clear) *outputs[k] = 0;
      }
      extremal::play_extended(program.code.data(), static_cast<int>(program.code.size()), operands,
                              track.scalars.row(r));
    }
  }
  for (const int row : untouched_) out[row] = 0;
}

}  // namespace extremal
