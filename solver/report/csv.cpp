#include "report/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ostream>
#include <stdexcept>

#include "report/file.hpp"
#include "study/files/numpy.hpp"

namespace extremal {

namespace {

struct Keyed {
  std::string key;
  const Column* values;
};

std::vector<Keyed> keyed_columns(const Samples& samples, const std::vector<std::string>& names) {
  std::vector<Keyed> columns{{"t", &samples.t}};
  for (std::size_t a = 0; a < names.size(); ++a) columns.push_back({names[a], &samples.q[a]});
  for (std::size_t a = 0; a < names.size(); ++a) columns.push_back({velocity_key(names[a]), &samples.v[a]});
  for (std::size_t a = 0; a < names.size(); ++a) columns.push_back({momentum_key(names[a]), &samples.p[a]});
  for (std::size_t k = 0; k < samples.constraint_forces.size(); ++k)
    columns.push_back({fmt::format("constraint_forces[{}]", k + 1), &samples.constraint_forces[k]});
  for (std::size_t k = 0; k < samples.path_forces.size(); ++k)
    columns.push_back({fmt::format("path_forces[{}]", k + 1), &samples.path_forces[k]});
  return columns;
}

void check_finite(const Keyed& column) {
  const auto bad = std::find_if_not(column.values->begin(), column.values->end(),
                                    [](double x) { return std::isfinite(x); });
  if (bad != column.values->end())
    throw std::logic_error(
        fmt::format("column {} is {} in row {}", column.key, *bad, bad - column.values->begin() + 1));
}

/// `prefix` begins each line, also that of the keys, which is left out where it is not wanted.
void write_rows(std::ostream& out, const Samples& samples, const std::vector<std::string>& names,
                const std::string& heading, const std::string& prefix, bool with_keys) {
  check_shape(samples, names);
  const std::vector<Keyed> columns = keyed_columns(samples, names);
  for (const Keyed& column : columns) check_finite(column);
  fmt::memory_buffer line;
  const auto end_line = [&] {
    line[line.size() - 1] = '\n';
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
    line.clear();
  };
  if (with_keys) {
    fmt::format_to(std::back_inserter(line), "{}", heading);
    for (const Keyed& column : columns) fmt::format_to(std::back_inserter(line), "{},", column.key);
    end_line();
  }
  for (std::size_t row = 0; row < samples.count(); ++row) {
    fmt::format_to(std::back_inserter(line), "{}", prefix);
    for (const Keyed& column : columns) {
      fmt::format_to(std::back_inserter(line), "{},", (*column.values)[row]);
    }
    end_line();
  }
}

}  // namespace

std::string npz_text(const Samples& samples, const std::vector<std::string>& names) {
  check_shape(samples, names);
  std::vector<std::pair<std::string, std::span<const double>>> arrays;
  for (const Keyed& column : keyed_columns(samples, names)) {
    check_finite(column);
    arrays.emplace_back(column.key, *column.values);
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
