#include "report/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>

#include "report/blocks.hpp"
#include "report/file.hpp"
#include "report/numbers.hpp"
#include "study/files/numpy.hpp"

namespace extremal {

namespace {

struct Keyed {
  std::string key;
  const Column* values;
  bool rate = false;  ///< a velocity or a momentum
};

std::vector<Keyed> keyed_columns(const Samples& samples, const std::vector<std::string>& names) {
  std::vector<Keyed> columns{{"t", &samples.t}};
  for (std::size_t a = 0; a < names.size(); ++a) columns.push_back({names[a], &samples.q[a]});
  for (std::size_t a = 0; a < names.size(); ++a)
    columns.push_back({velocity_key(names[a]), &samples.v[a], true});
  for (std::size_t a = 0; a < names.size(); ++a)
    columns.push_back({momentum_key(names[a]), &samples.p[a], true});
  for (std::size_t k = 0; k < samples.constraint_forces.size(); ++k)
    columns.push_back({fmt::format("constraint_forces[{}]", k + 1), &samples.constraint_forces[k]});
  for (std::size_t k = 0; k < samples.path_forces.size(); ++k)
    columns.push_back({fmt::format("path_forces[{}]", k + 1), &samples.path_forces[k]});
  return columns;
}

void check_finite(const Samples& samples, const Keyed& column) {
  const std::size_t bad =
      first_not_finite(*column.values, column.rate && samples.open_start, column.rate && samples.open_end);
  if (bad < column.values->size())
    throw std::logic_error(
        fmt::format("column {} is {} in row {}", column.key, (*column.values)[bad], bad + 1));
}

/// `prefix` begins each line, also that of the keys, which is left out where it is not wanted.
void write_rows(std::ostream& out, const Samples& samples, const std::vector<std::string>& names,
                const std::string& heading, const std::string& prefix, bool with_keys) {
  check_shape(samples, names);
  const std::vector<Keyed> columns = keyed_columns(samples, names);
  for (const Keyed& column : columns) check_finite(samples, column);
  if (with_keys) {
    out << heading;
    for (const Keyed& column : columns) out << (&column == columns.data() ? "" : ",") << column.key;
    out << '\n';
  }
  const std::size_t room = prefix.size() + columns.size() * (number_size + 1);
  write_blocks(out, samples.count(), room, [&](std::size_t first, std::size_t end, char* to) {
    for (std::size_t row = first; row < end; ++row) {
      to = std::copy(prefix.begin(), prefix.end(), to);
      for (const Keyed& column : columns) {
        const double value = (*column.values)[row];
        if (!std::isnan(value)) to = write_number(value, to);
        *to++ = ',';
      }
      to[-1] = '\n';
    }
    return to;
  });
}

}  // namespace

std::string npz_text(const Samples& samples, const std::vector<std::string>& names) {
  check_shape(samples, names);
  // Arrays have no empty entries: an end without velocities and momenta is left out.
  const std::size_t first = samples.open_start ? 1 : 0;
  const std::size_t last = samples.count() - (samples.open_end && samples.count() > first ? 1 : 0);
  std::vector<std::pair<std::string, std::span<const double>>> arrays;
  for (const Keyed& column : keyed_columns(samples, names)) {
    check_finite(samples, column);
    arrays.emplace_back(column.key, std::span(*column.values).subspan(first, last - first));
  }
  return npz(arrays);
}

void write_csv(std::ostream& out, const Samples& samples, const std::vector<std::string>& names) {
  write_rows(out, samples, names, "", "", true);
}

void write_csv(std::ostream& out, const std::vector<Samples>& solutions,
               const std::vector<std::string>& names) {
  for (std::size_t k = 0; k < solutions.size(); ++k)
    write_rows(out, solutions[k], names, "solution,", fmt::format("{},", k + 1), k == 0);
}

void write_csv(const std::string& path, const Samples& samples, const std::vector<std::string>& names) {
  write_file(path, [&](std::ostream& out) { write_csv(out, samples, names); });
}

void write_csv(const std::string& path, const std::vector<Samples>& solutions,
               const std::vector<std::string>& names) {
  write_file(path, [&](std::ostream& out) { write_csv(out, solutions, names); });
}

}  // namespace extremal
