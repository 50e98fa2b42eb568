#pragma once

#include <cmath>

#include "system/expression.hpp"

namespace extremal {

/// A scalar that records what is computed with it; every operation and function of the formula
/// language is defined for it (found by argument-dependent lookup). Without a graph it is a number.
class Symbol {
 public:
  Symbol(double value = 0) : value_(value) {}
  Symbol(Graph* graph, NodeId id) : graph_(graph), id_(id) {}
  Graph* graph() const { return graph_; }
  double value() const { return value_; }
  NodeId node(Graph& graph) const { return graph_ ? id_ : graph.constant(value_); }

  Symbol& operator+=(const Symbol& b);
  Symbol& operator-=(const Symbol& b);
  Symbol& operator*=(const Symbol& b);
  Symbol& operator/=(const Symbol& b);

 private:
  Graph* graph_ = nullptr;
  NodeId id_ = 0;
  double value_ = 0;
};

/// op(a) and op(a, b). Symbols of two different graphs do not mix: throws std::invalid_argument.
Symbol record(Op op, const Symbol& a);
Symbol record(Op op, const Symbol& a, const Symbol& b);

inline Symbol operator+(const Symbol& a) { return a; }
inline Symbol operator-(const Symbol& a) { return record(Op::neg, a); }
inline Symbol operator+(const Symbol& a, const Symbol& b) { return record(Op::add, a, b); }
inline Symbol operator-(const Symbol& a, const Symbol& b) { return record(Op::sub, a, b); }
inline Symbol operator*(const Symbol& a, const Symbol& b) { return record(Op::mul, a, b); }
inline Symbol operator/(const Symbol& a, const Symbol& b) { return record(Op::div, a, b); }
inline Symbol& Symbol::operator+=(const Symbol& b) { return *this = *this + b; }
inline Symbol& Symbol::operator-=(const Symbol& b) { return *this = *this - b; }
inline Symbol& Symbol::operator*=(const Symbol& b) { return *this = *this * b; }
inline Symbol& Symbol::operator/=(const Symbol& b) { return *this = *this / b; }

inline Symbol pow(const Symbol& a, const Symbol& b) { return record(Op::pow, a, b); }
inline Symbol atan2(const Symbol& y, const Symbol& x) { return record(Op::atan2, y, x); }
inline Symbol min(const Symbol& a, const Symbol& b) { return record(Op::min, a, b); }
inline Symbol max(const Symbol& a, const Symbol& b) { return record(Op::max, a, b); }
inline Symbol abs(const Symbol& a) { return record(Op::abs, a); }
inline Symbol sqrt(const Symbol& a) { return record(Op::sqrt, a); }
inline Symbol exp(const Symbol& a) { return record(Op::exp, a); }
inline Symbol log(const Symbol& a) { return record(Op::log, a); }
inline Symbol sin(const Symbol& a) { return record(Op::sin, a); }
inline Symbol cos(const Symbol& a) { return record(Op::cos, a); }
inline Symbol tan(const Symbol& a) { return record(Op::tan, a); }
inline Symbol asin(const Symbol& a) { return record(Op::asin, a); }
inline Symbol acos(const Symbol& a) { return record(Op::acos, a); }
inline Symbol atan(const Symbol& a) { return record(Op::atan, a); }
inline Symbol sinh(const Symbol& a) { return record(Op::sinh, a); }
inline Symbol cosh(const Symbol& a) { return record(Op::cosh, a); }
inline Symbol tanh(const Symbol& a) { return record(Op::tanh, a); }

}  // namespace extremal
