#include "study/model/integrals.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "study/model/modelling.hpp"
#include "study/model/unknown_constants.hpp"

namespace extremal {

namespace {

/// "g = c".
struct Integral {
  Text integrand;
  std::string value;
  std::size_t value_offset;
};

Integral integral_of(const Text& text) {
  const std::size_t equals = text.value.find('=');
  if (equals == std::string::npos || text.value.find('=', equals + 1) != std::string::npos)
    throw FaultyFormula(
        position(text, 0),
        "an integral is an equation: the integrand on the left, its integral from 0 to T on the "
        "right, as in \"sqrt(1 + y'^2) = 4\"");
  return {{text.value.substr(0, equals), text.at}, text.value.substr(equals + 1), equals + 1};
}

bool of_unknowns(const Integral& integral, const Scene& scene) {
  return any_of(names_in(integral.value), dependents_of(scene));
}

/// g, or g − c/T.
Text integrand_of(const Text& text, const Scene& scene) {
  Integral integral = integral_of(text);
  if (!of_unknowns(integral, scene)) return integral.integrand;
  const Quantity& duration = scene.boundary.duration;
  const std::string* const formula = as_formula(duration);
  if (formula && *formula == "free")
    throw SceneError(
        position(text, integral.value_offset),
        "the right side depends on an unknown, which needs a duration that is given; or write the "
        "integrand less what is to be found, as in \"x - c = 0\", with c its mean");
  integral.integrand.value +=
      formula ? fmt::format(" - ({})/({})", integral.value, *formula)
              : fmt::format(" - ({})/{:.17g}", integral.value, std::get<double>(duration.value));
  return integral.integrand;
}

}  // namespace

double value_of_integral(const Text& text, const Scene& scene, const System& system) {
  const Integral integral = integral_of(text);
  try {
    const double value = number(integral.value, system, "integrals");
    if (std::isfinite(value)) return of_unknowns(integral, scene) ? 0 : value;
  } catch (const FormulaError& e) {
    if (e.where.starts_with("definitions.")) throw;
    throw FaultyFormula(position(text, integral.value_offset + e.offset),
                        fmt::format("{}; the right side of an integral is a number", e.what()));
  }
  throw SceneError(position(text, integral.value_offset), "the value of the integral is not finite");
}

/// Each alone as a Lagrangian, so that its errors are found at their places.
void check_integrands(const Scene& scene) {
  for (const Text& text : scene.boundary.integrals) {
    SystemTable table = scene.system;
    table.lagrangian = integrand_of(text, scene);
    table.force.clear();
    make_system(table);
  }
}

Text law_with(const Scene& scene, const std::vector<std::string>& multipliers) {
  Text law = *scene.system.lagrangian;
  law.value = "(" + law.value + ")";
  for (std::size_t j = 0; j < multipliers.size(); ++j)
    law.value +=
        fmt::format(" + ({})*({})", multipliers[j], integrand_of(scene.boundary.integrals[j], scene).value);
  return law;
}

Text law_at(const Scene& scene, const std::vector<double>& multipliers) {
  if (multipliers.empty()) return scene.system.law();
  std::vector<std::string> texts;
  for (const double nu : multipliers) texts.push_back(fmt::format("{:.17g}", nu));
  return law_with(scene, texts);
}

}  // namespace extremal
