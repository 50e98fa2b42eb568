#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "report/result.hpp"

/// \file Samples by columns: as comma-separated values, and as arrays of NumPy.

namespace extremal {

/// A header and one row a time: t, coordinates, velocities, momenta, keyed as in JSON; numbers read back as
/// the same double. Throws std::invalid_argument if the columns do not fit the names, std::logic_error with
/// column and row if a number is not finite.
void write_csv(std::ostream& out, const Samples& samples, const std::vector<std::string>& names);

/// Several solutions below each other, their numbers from 1 in a first column `solution`.
void write_csv(std::ostream& out, const std::vector<Samples>& solutions,
               const std::vector<std::string>& names);

/// The same columns as the bytes of a file .npz, without the row of an end at which L is infinite: arrays
/// have no empty entries. Throws as write_csv() does.
std::string npz_text(const Samples& samples, const std::vector<std::string>& names);

/// The same into a file. Throws std::runtime_error with the path if it cannot be written; what was written
/// in part is removed.
void write_csv(const std::string& path, const Samples& samples, const std::vector<std::string>& names);
void write_csv(const std::string& path, const std::vector<Samples>& solutions,
               const std::vector<std::string>& names);

}  // namespace extremal
