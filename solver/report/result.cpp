#include "report/result.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace extremal {

namespace {

void check_columns(const char* what, const std::vector<Column>& columns, const Samples& samples,
                   const std::vector<std::string>& names) {
  if (columns.size() != names.size()) {
    throw std::invalid_argument(
        fmt::format("samples have {} columns of {} for {} coordinates", columns.size(), what, names.size()));
  }
  for (std::size_t a = 0; a < names.size(); ++a) {
    if (columns[a].size() != samples.count()) {
      throw std::invalid_argument(fmt::format("samples have {} {} of \"{}\" at {} times", columns[a].size(),
                                              what, names[a], samples.count()));
    }
  }
}

}  // namespace

std::size_t first_not_finite(const Column& column, bool open_start, bool open_end) {
  for (std::size_t k = 0; k < column.size(); ++k) {
    const bool open = (open_start && k == 0) || (open_end && k + 1 == column.size());
    if (!std::isfinite(column[k]) && !(open && std::isnan(column[k]))) return k;
  }
  return column.size();
}

std::string velocity_key(const std::string& coordinate) { return coordinate + "'"; }

std::string momentum_key(const std::string& coordinate) { return "p_" + coordinate; }

void check_shape(const Samples& samples, const std::vector<std::string>& names) {
  check_columns("values", samples.q, samples, names);
  check_columns("velocities", samples.v, samples, names);
  check_columns("momenta", samples.p, samples, names);
}

}  // namespace extremal
