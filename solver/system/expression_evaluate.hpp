#pragma once

#include <cmath>
#include <complex>
#include <stdexcept>

#include "system/expression.hpp"

/// \file Values of an expression in any scalar type. Functions of other types are found by
/// argument-dependent lookup.

namespace extremal {
namespace scalar {

template <class Scalar>
const Scalar& real_part(const Scalar& x) {
  return x;
}
template <class Real>
Real real_part(const std::complex<Real>& x) {
  return x.real();
}

template <class Scalar>
Scalar arctangent(const Scalar& y, const Scalar& x) {
  using std::atan2;
  return atan2(y, x);
}

/// Continues atan2 analytically from real arguments, on the branch that their real parts choose.
template <class Real>
std::complex<Real> arctangent(const std::complex<Real>& y, const std::complex<Real>& x) {
  const Real half = std::acos(Real(0)), side = std::signbit(y.real()) ? -1 : 1;
  if (std::abs(y.real()) > std::abs(x.real())) return side * half - std::atan(x / y);
  return std::atan(y / x) + (std::signbit(x.real()) ? side * 2 * half : Real(0));
}

template <class Scalar>
Scalar power(const Scalar& base, const Scalar& exponent) {
  using std::pow;
  return pow(base, exponent);
}

/// Integer exponents by products: the logarithm of a negative base would leave an imaginary part that
/// hides a complex step.
template <class Real>
std::complex<Real> power(const std::complex<Real>& base, const std::complex<Real>& exponent) {
  const Real k = exponent.real();
  if (exponent.imag() != 0 || k != std::floor(k) || std::abs(k) > 1e9) return std::pow(base, exponent);
  std::complex<Real> result = 1, square = base;
  for (long long rest = std::llabs(std::llround(k)); rest > 0; rest /= 2, square *= square)
    if (rest % 2 == 1) result *= square;
  return k < 0 ? Real(1) / result : result;
}

/// The operation `op` on its arguments; `b` is not read where arity(op) < 2.
template <class Scalar>
Scalar apply(Op op, const Scalar& a, const Scalar& b) {
  using std::sin, std::cos, std::tan, std::asin, std::acos, std::atan, std::sinh, std::cosh, std::tanh;
  using std::sqrt, std::exp, std::log;
  switch (op) {
    case Op::constant:
    case Op::input:
      break;
    case Op::add:
      return a + b;
    case Op::sub:
      return a - b;
    case Op::mul:
      return a * b;
    case Op::div:
      return a / b;
    case Op::pow:
      return power(a, b);
    case Op::atan2:
      return arctangent(a, b);
    case Op::min:
      return real_part(b) < real_part(a) ? b : a;
    case Op::max:
      return real_part(a) < real_part(b) ? b : a;
    case Op::step:
      return Scalar(real_part(a) >= real_part(b) ? 1.0 : 0.0);
    case Op::neg:
      return -a;
    case Op::abs:
      return real_part(a) < 0 ? Scalar(-a) : a;
    case Op::sqrt:
      return sqrt(a);
    case Op::exp:
      return exp(a);
    case Op::log:
      return log(a);
    case Op::sin:
      return sin(a);
    case Op::cos:
      return cos(a);
    case Op::tan:
      return tan(a);
    case Op::asin:
      return asin(a);
    case Op::acos:
      return acos(a);
    case Op::atan:
      return atan(a);
    case Op::sinh:
      return sinh(a);
    case Op::cosh:
      return cosh(a);
    case Op::tanh:
      return tanh(a);
  }
  throw std::invalid_argument("a constant or an input is not an operation");
}

}  // namespace scalar

template <class Scalar>
Scalar evaluate(const Graph& graph, NodeId f, std::span<const Scalar> inputs) {
  std::vector<Scalar> values(f + 1);
  for (const NodeId id : nodes_of(graph, f)) {
    const Node& node = graph[id];
    if (node.op == Op::constant) {
      values[id] = Scalar(node.value);
    } else if (node.op == Op::input) {
      values[id] = inputs[node.index];
    } else {
      values[id] = scalar::apply<Scalar>(node.op, values[node.a], values[node.b]);
    }
  }
  return values[f];
}

extern template double evaluate(const Graph&, NodeId, std::span<const double>);

}  // namespace extremal
