#include "study/model/system_form.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "study/model/dependence.hpp"
#include "study/model/modelling.hpp"

namespace extremal {

SystemForm::SystemForm(const SystemTable& table, const std::string& parameter, Formulation formulation)
    : table_(table), formulation_(formulation) {
  const std::set<std::string> names = with_dependent({parameter}, table);
  for (std::size_t k = 0; k < table.parameters.size(); ++k) {
    const std::string& name = table.parameters[k].name;
    if (name == parameter) parameter_ = k;
    if (names.contains(name)) dependent_.push_back(name);
  }
  try {
    compiled_ = make_system(table_, dependent_, formulation_, true);
    if (!with(compiled_->parameters)) compiled_.reset();
  } catch (const SceneError&) {
  }
}

System SystemForm::at(double value) {
  table_.parameters[parameter_].values.front().value = value;
  if (compiled_) {
    try {
      // Without the terms that a zero takes out the system may be another: one that does not depend on t.
      const std::map<std::string, ParameterText> parameters = system_text(table_).parameters;
      const bool zero = std::ranges::any_of(dependent_, [&](const std::string& name) {
        return std::ranges::count(parameters.at(name).value, 0);
      });
      if (std::optional<System> system = zero ? std::nullopt : with(parameters)) return *std::move(system);
    } catch (const FormulaError& e) {
      throw at_its_place(table_, e);
    }
  }
  return make_system(table_, {}, formulation_);
}

std::optional<System> SystemForm::with(const std::map<std::string, ParameterText>& parameters) const {
  if (compiled_->hamiltonian) return std::nullopt;
  std::vector<double> numbers;
  for (const std::string& name : dependent_) {
    const Parameter& value = parameters.at(name).value;
    numbers.insert(numbers.end(), value.begin(), value.end());
  }
  System system = *compiled_;
  system.parameters = parameters;
  system.lagrangian = system.lagrangian->with(numbers);
  if (system.copies) system.copies = system.copies->with(numbers);
  if (!system.lagrangian || (compiled_->copies && !system.copies)) return std::nullopt;
  return system;
}

}  // namespace extremal
