#pragma once

#include "scene/document.hpp"
#include "scene/scene.hpp"

/// \file From checked tables to the data of a scene.

namespace extremal {

/// [system] as it is written, not merged with what it uses.
SystemTable read_system_table(const Document& document, const toml::table& table);
BoundaryTable read_boundary_table(const Document& document, const toml::table& table);
std::vector<WaypointTable> read_waypoint_tables(const Document& document, const toml::array& tables);
GuessTable read_guess_table(const Document& document, const toml::table& table);
SolveTable read_solve_table(const Document& document, const toml::table& table);
PathTable read_path_table(const Document& document, const toml::table& table);
SearchTable read_search_table(const Document& document, const toml::table& table);
UnitsTable read_units_table(const Document& document, const toml::table& table);
FitTable read_fit_table(const Document& document, const toml::table& table);
SpectrumTable read_spectrum_table(const Document& document, const toml::table& table);
ContinuationTable read_continuation_table(const Document& document, const toml::table& table);

}  // namespace extremal
