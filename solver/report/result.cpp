#include "report/result.hpp"

#include <fmt/format.h>

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

std::string velocity_key(const std::string& coordinate) { return coordinate + "'"; }

std::string momentum_key(const std::string& coordinate) { return "p_" + coordinate; }

void check_shape(const Samples& samples, const std::vector<std::string>& names) {
  check_columns("values", samples.q, samples, names);
  check_columns("velocities", samples.v, samples, names);
  check_columns("momenta", samples.p, samples, names);
}

}  // namespace extremal
