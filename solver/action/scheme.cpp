#include "action/scheme.hpp"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

namespace extremal {

namespace {

/// A family is listed with this argument.
constexpr int example_degree = 3;

std::vector<Scheme> make_schemes() {
  using enum Quadrature;
  return {
      {"rectangle", 1, left, 1, 1, "Müller-Ortiz (1.7); Cresson-Safi (2), (6)"},
      {"rectangle-right", 1, right, 1, 1, "Cresson-Safi (2), (6), backward"},
      {"midpoint", 1, midpoint, 1, 2, "Müller-Ortiz (5.5); Chen-Guo-Wu (2.15)"},
      {"trapezoid", 1, ends, 2, 2, "Chen-Guo-Wu 2.2; Störmer-Verlet"},
      {"simpson", 1, simpson, 3, 2, "Chen-Guo-Wu 2.2"},
      {"linear", 1, exact, 3, 2, "Müller-Ortiz (4.4); Chen-Guo-Wu (2.24)"},
      {"quadratic", 2, exact, 4, 4, "Chen-Guo-Wu (2.35)-(2.47)"},
      extremal::lobatto(example_degree),
      extremal::gauss(example_degree),
  };
}

[[noreturn]] void refuse(std::string_view name, std::string_view reason) {
  throw std::invalid_argument(
      fmt::format("scheme \"{}\" {}; schemes are rectangle, rectangle-right, midpoint, trapezoid, simpson, "
                  "linear, quadratic, lobatto(s), gauss(s) with s = 1 to {}",
                  name, reason, max_degree));
}

void check_degree(std::string_view family, int degree) {
  if (degree < 1 || degree > max_degree)
    throw std::invalid_argument(fmt::format("degree of {} = {}; need 1 to {}", family, degree, max_degree));
}

}  // namespace

const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> all = make_schemes();
  return all;
}

Scheme lobatto(int degree) {
  check_degree("lobatto", degree);
  return {fmt::format("lobatto({})", degree),
          degree,
          Quadrature::lobatto,
          degree + 1,
          2 * degree,
          "Galerkin variational integrators, Lobatto quadrature"};
}

Scheme gauss(int degree) {
  check_degree("gauss", degree);
  return {fmt::format("gauss({})", degree),
          degree,
          Quadrature::gauss,
          degree,
          2 * degree,
          "Galerkin variational integrators, Gauss quadrature"};
}

Scheme scheme(std::string_view name) {
  const std::size_t open = name.find('(');
  if (open == std::string_view::npos) {
    for (const Scheme& known : schemes())
      if (known.name == name) return known;
    if (name == "lobatto" || name == "gauss") refuse(name, "needs its degree, as in lobatto(4)");
    refuse(name, "does not exist");
  }
  const std::string_view family = name.substr(0, open);
  if (family != "lobatto" && family != "gauss") {
    for (const Scheme& known : schemes())
      if (known.name == family) refuse(name, "takes no argument");
    refuse(name, "does not exist");
  }
  if (name.back() != ')') refuse(name, "lacks its closing parenthesis");
  const std::string_view argument = name.substr(open + 1, name.size() - open - 2);
  int degree = 0;
  const char* const last = argument.data() + argument.size();
  const auto [end, error] = std::from_chars(argument.data(), last, degree);
  if (error == std::errc::result_out_of_range) refuse(name, "has a degree out of range");
  if (error != std::errc() || end != last) refuse(name, "needs a whole number as its degree");
  if (degree < 1 || degree > max_degree) refuse(name, "has a degree out of range");
  return family == "lobatto" ? lobatto(degree) : gauss(degree);
}

bool suits_phase_space(const Scheme& scheme) {
  const bool rule = scheme.quadrature == Quadrature::gauss || scheme.quadrature == Quadrature::midpoint;
  return rule && scheme.points == scheme.degree;
}

}  // namespace extremal
