#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file A system for any values of one of its parameters.

namespace extremal {

class SystemForm {
 public:
  /// The parameter is one number.
  SystemForm(const SystemTable& table, const std::string& parameter, Formulation formulation);
  /// With this value. Throws SceneError like make_system().
  System at(double value);
  /// With the last value.
  const SystemTable& table() const { return table_; }

 private:
  std::optional<System> with(const std::map<std::string, ParameterText>& parameters) const;

  SystemTable table_;
  std::size_t parameter_ = 0;  ///< its place in the table
  Formulation formulation_;
  std::vector<std::string> dependent_;  ///< all parameters that change with it
  /// Compiled once, with numbers of these to be put in; none where the number decides on the expressions, as
  /// that of coordinates or an exponent does.
  std::optional<System> compiled_;
};

}  // namespace extremal
