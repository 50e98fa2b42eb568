#include <qd/dd_real.h>

#include <algorithm>
#include <cmath>

#include "system/tape_lagrangian.hpp"

/// \file A tape played at one point in numbers with more digits, for equations whose roundoff is amplified.

namespace extremal {

namespace {

/// What QD complains of on the error stream, or knows for positive bases alone, as the standard library has
/// it.
Extended defined(Code, const Extended&, const Extended&) { return 0; }
double defined(Code code, const DoubleDouble& a, const DoubleDouble& b) {
  const double x = to_double(a), y = to_double(b);
  switch (code) {
    case Code::square_root:
    case Code::reciprocal_root:
      return x < 0 ? NAN : 0;
    case Code::logarithm:
      return x > 0 ? 0 : std::log(x);
    case Code::arcsine:
    case Code::arccosine:
      return abs(a) > 1.0 ? NAN : 0;
    case Code::arctangent2:
      return x == 0 && y == 0 ? NAN : 0;
    default:
      return 0;
  }
}

Extended power(const Extended& a, const Extended& b) { return std::pow(a, b); }
DoubleDouble power(const DoubleDouble& a, const DoubleDouble& b) {
  constexpr double largest_integer = 1 << 30;
  const double x = to_double(a), y = to_double(b);
  if (x == 0 || !std::isfinite(x) || !std::isfinite(y)) return std::pow(x, y);
  if (b == floor(b) && std::abs(y) < largest_integer) return npwr(a, static_cast<int>(y));
  return x > 0 ? pow(a, b) : DoubleDouble(NAN);
}

template <class Number>
Number elementary(Code code, const Number& a, const Number& b) {
  // Those of dd_real are found by their arguments.
  using std::abs, std::exp, std::log, std::sin, std::cos, std::tan, std::asin, std::acos, std::atan,
      std::atan2, std::sinh, std::cosh, std::tanh;
  switch (code) {
    case Code::step:
      return Number(a >= b ? 1 : 0);
    case Code::minimum:
      return b < a ? b : a;
    case Code::maximum:
      return a < b ? b : a;
    case Code::absolute:
      return abs(a);
    case Code::power:
      return power(a, b);
    case Code::exponential:
      return exp(a);
    case Code::logarithm:
      return log(a);
    case Code::sine:
    case Code::sine_cosine:
      return sin(a);
    case Code::cosine:
      return cos(a);
    case Code::tangent:
      return tan(a);
    case Code::arcsine:
      return asin(a);
    case Code::arccosine:
      return acos(a);
    case Code::arctangent:
      return atan(a);
    case Code::arctangent2:
      return atan2(a, b);
    case Code::hyperbolic_sine:
      return sinh(a);
    case Code::hyperbolic_cosine:
      return cosh(a);
    default:
      return tanh(a);
  }
}

template <class Number>
Number value(Code code, const Number& a, const Number& b, const Number& c, double s) {
  using std::sqrt;
  if (const auto instead = defined(code, a, b); instead != 0) return Number(instead);
  switch (code) {
    case Code::copy:
      return a;
    case Code::negate:
      return -a;
    case Code::fill:
      return Number(s);
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
      return 1.0 / a;
    case Code::square_root:
      return sqrt(a);
    case Code::reciprocal_root:
      return 1.0 / sqrt(a);
    default:
      return elementary(code, a, b);
  }
}

}  // namespace

template <class Number>
void play_extended(const Instruction* code, int length, Number* const* operands, const double* scalars) {
  using std::cos;
  for (const Instruction* i = code; i != code + length; ++i) {
    const Number a = *operands[i->a];
    *operands[i->d] = value<Number>(i->code, a, *operands[i->b], *operands[i->c], scalars[i->s]);
    if (i->code == Code::sine_cosine) *operands[i->c] = cos(a);
  }
}
template void play_extended(const Instruction*, int, Extended* const*, const double*);
template void play_extended(const Instruction*, int, DoubleDouble* const*, const double*);

template <class Number>
void Tape::play_extended(const Number* q, const Number* v, const Number& t, Number* out,
                         PointScratch<Number>& scratch) const {
  scratch.memory.resize(std::max<std::size_t>(scratch.memory.size(), slots_));
  scratch.operands.resize(std::max<std::size_t>(scratch.operands.size(), operands_));
  Number** const operands = scratch.operands.data();
  for (std::size_t j = 0; j < tracks_->size(); ++j) {
    const Track& track = (*tracks_)[j];
    const Program& program = track.program;
    const Kernel& kernel = *track.kernel;
    Number **outputs = operands + program.inputs, **slots = outputs + program.outputs;
    for (int k = 0; k < program.slots; ++k) slots[k] = scratch.memory.data() + k;
    for (int r = 0; r < kernel.rows; ++r) {
      const std::uint32_t* source = kernel.table.data() + static_cast<std::size_t>(r) * program.inputs;
      const Target* target = track.targets.data() + static_cast<std::size_t>(r) * program.outputs;
      for (int k = 0; k < program.inputs; ++k) {
        const Variable kind = kernel.kinds[k];
        operands[k] = const_cast<Number*>(kind == Variable::coordinate ? q + source[k]
                                          : kind == Variable::velocity ? v + source[k]
                                                                       : &t);
      }
      for (int k = 0; k < program.outputs; ++k) {
        outputs[k] = out + target[k].row;
        if (target[k].clear) *outputs[k] = Number(0);
      }
      extremal::play_extended(program.code.data(), static_cast<int>(program.code.size()), operands,
                              scalars_[j].row(r));
    }
  }
  for (const int row : untouched_) out[row] = Number(0);
}

bool TapeLagrangian::evaluate_extended(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                                       PointScratch<Extended>& scratch) const {
  orders_[static_cast<int>(Order::gradient)].play_extended(q, v, t, out, scratch);
  return true;
}

bool TapeLagrangian::evaluate_extended(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                                       DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const {
  orders_[static_cast<int>(Order::gradient)].play_extended(q, v, t, out, scratch);
  return true;
}

void TapeLagrangian::evaluate_hessian(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                                      DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const {
  orders_[static_cast<int>(Order::hessian)].play_extended(q, v, t, out, scratch);
}

void TapeLagrangian::evaluate_hessian(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                                      PointScratch<Extended>& scratch) const {
  orders_[static_cast<int>(Order::hessian)].play_extended(q, v, t, out, scratch);
}

}  // namespace extremal
