#pragma once

#include <string>
#include <string_view>
#include <vector>

/// \file Schemes: the degree of the elements and the quadrature of the action.

namespace extremal {

enum class Quadrature { left, right, midpoint, ends, simpson, gauss, lobatto, exact };

/// A discretisation by name, as a record: command line, documentation and tests read it from here.
struct Scheme {
  std::string name;  ///< "midpoint", "lobatto(3)"
  int degree = 1;    ///< s, of the polynomial in an element
  Quadrature quadrature = Quadrature::lobatto;
  int points = 2;      ///< r, of the quadrature; for `exact` the first try
  int order = 2;       ///< of the values at the nodes between elements, for smooth L
  std::string source;  ///< paper and equation
};

inline constexpr int max_degree = 24;

/// Every named scheme; the families with the argument 3.
const std::vector<Scheme>& schemes();

/// "lobatto(4)" and so on. Throws std::invalid_argument with the names there are.
Scheme scheme(std::string_view name);
Scheme lobatto(int degree);
Scheme gauss(int degree);

/// Whether a scheme is one of phase space too, whatever ∂²H/∂p∂p: Gauss's rule with as many points as
/// degrees. With more points q' cannot equal ∂H/∂p at all of them; rectangles take q and p at different ends.
bool suits_phase_space(const Scheme& scheme);

}  // namespace extremal
