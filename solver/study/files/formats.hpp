#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/files/csv_file.hpp"
#include "study/files/guess_file.hpp"

/// \file One reader for each kind of guess file. All throw SceneError.

namespace extremal {

/// Throws SceneError unless there are two times or more, each after the one before it; place(k) is where the
/// k-th is written, place(0) also where there is none.
void check_times(std::span<const double> t, const std::function<Location(std::size_t)>& place);

/// Whether the table has the velocity of a coordinate, by one of its names: then its rows are initial states.
bool has_velocities(const CsvFile& table, const std::vector<std::string>& names);

/// The row `orbit` of initial states. Coordinates are called as in the scene, `x` or `x0`; velocities `x'`,
/// `vx` or `vx0`; the duration `period`. Capitals and units in parentheses do not count.
GuessFile read_orbit_table(const CsvFile& table, const std::shared_ptr<const Source>& source,
                           const std::vector<std::string>& names, const std::optional<Number>& orbit);

/// The same in JSON: "fields", the names, and "data", the rows of numbers or of strings that hold numbers.
/// Nothing where the text is no such table.
std::optional<GuessFile> read_json_table(const std::shared_ptr<const Source>& source,
                                         const std::vector<std::string>& names,
                                         const std::optional<Number>& orbit);

/// Whether the text begins like a solution of AUTO: with a line of at least 11 integers.
bool is_auto_file(const std::string& text);

/// The solution with the label `orbit` (E. J. Doedel and B. E. Oldeman, AUTO-07p, section on the format of
/// solution files). PAR(11) is the duration.
GuessFile read_auto_file(const std::shared_ptr<const Source>& source, const std::vector<std::string>& names,
                         const std::optional<Number>& orbit);

/// Loops over one period; body b of loop l moves as R l(±(t − shift)), with the period 1.
GuessFile read_loops(const std::string& path, const std::vector<std::string>& names);

/// Which of `count` rows is meant, from 0: the only one, or the one that `orbit` names from 1.
std::size_t chosen_row(std::size_t count, const std::optional<Number>& orbit,
                       const std::shared_ptr<const Source>& source);

}  // namespace extremal
