#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string_view>

#include "report/blocks.hpp"
#include "report/json_parts.hpp"
#include "report/numbers.hpp"

namespace extremal {

[[noreturn]] void refuse_number(const std::string& field, double value) {
  throw std::logic_error(fmt::format("the result has converged, but its {} is {}", field, value));
}

namespace {

/// NaN, where it is allowed, becomes null.
void write_list(std::ostream& out, const Column& column) {
  out << '[';
  write_blocks(out, column.size(), number_size + 1, [&](std::size_t first, std::size_t end, char* to) {
    constexpr std::string_view null = "null";
    for (std::size_t k = first; k < end; ++k) {
      if (k > 0) *to++ = ',';
      to = std::isnan(column[k]) ? std::copy(null.begin(), null.end(), to) : write_real(column[k], to);
    }
    return to;
  });
  out << ']';
}

void write_column(std::ostream& out, const std::string& indent, const std::string& key, const Column& column,
                  bool open_start = false, bool open_end = false) {
  const std::size_t bad = first_not_finite(column, open_start, open_end);
  if (bad < column.size()) refuse_number(fmt::format("samples.{}[{}]", key, bad), column[bad]);
  out << indent << dumped(key) << ": ";
  write_list(out, column);
}

/// A list of columns, one for each constraint; nothing without constraints.
void write_forces(std::ostream& out, const std::string& indent, const char* key,
                  const std::vector<Column>& forces) {
  if (forces.empty()) return;
  for (const Column& column : forces)
    if (const std::size_t bad = first_not_finite(column); bad < column.size())
      refuse_number(fmt::format("samples.{}[{}]", key, bad), column[bad]);
  out << ",\n" << indent << dumped(key) << ": [";
  for (const Column& column : forces) {
    if (&column != forces.data()) out << ',';
    write_list(out, column);
  }
  out << ']';
}

/// Column by column: a tree of all the samples would cost several times their memory. Left open.
void open_samples(std::ostream& out, const std::string& indent, const Samples& samples,
                  const std::vector<std::string>& names, bool momenta) {
  const std::string inner = indent + "  ";
  out << ",\n" << indent << "\"samples\": {\n";
  write_column(out, inner, "t", samples.t);
  const auto write_columns = [&](const std::vector<Column>& columns, auto key, bool rate) {
    for (std::size_t a = 0; a < names.size(); ++a) {
      out << ",\n";
      write_column(out, inner, key(names[a]), columns[a], rate && samples.open_start,
                   rate && samples.open_end);
    }
  };
  write_columns(
      samples.q, [](const std::string& coordinate) { return coordinate; }, false);
  write_columns(samples.v, velocity_key, true);
  if (momenta) write_columns(samples.p, momentum_key, true);
}

}  // namespace

void write_samples(std::ostream& out, const std::string& indent, const Samples& samples,
                   const std::vector<std::string>& names) {
  check_shape(samples, names);
  open_samples(out, indent, samples, names, true);
  write_forces(out, indent + "  ", "constraint_forces", samples.constraint_forces);
  write_forces(out, indent + "  ", "path_forces", samples.path_forces);
  out << "\n" << indent << "}";
}

void write_motion(std::ostream& out, const std::string& indent, const Samples& samples,
                  const std::vector<std::string>& names) {
  open_samples(out, indent, samples, names, false);
  out << "\n" << indent << "}";
}

namespace {

/// Units and centres of the system.
Json about(const Annotation& annotation) {
  Json units = Json::object(), centres = Json::array(), object = Json::object();
  for (const auto& [name, unit] : annotation.units) append(units, name, unit);
  for (const Centre& centre : annotation.centres)
    centres.push_back({{"name", centre.name}, {"at", centre.at}});
  if (!units.empty()) append(object, "units", std::move(units));
  if (!centres.empty()) append(object, "centres", std::move(centres));
  return object;
}

/// Curves by the names of their axes: two coordinates, or t and a lone one.
void write_boundaries(std::ostream& out, const std::string& indent, const Result& result) {
  const bool lone = result.names.size() == 1;
  const std::string across = lone ? "t" : result.names.at(0), up = result.names.at(lone ? 0 : 1);
  out << ",\n" << indent << "\"boundaries\": [";
  const char* separator = "";
  for (const PlaneCurve& curve : result.boundaries) {
    out << separator << "{";
    if (curve.t) out << "\"at\": " << dumped(*curve.t) << ", ";
    write_column(out, "", across, curve.x);
    out << ", ";
    write_column(out, "", up, curve.y);
    out << "}";
    separator = ", ";
  }
  out << "]";
}

}  // namespace

void write_about(std::ostream& out, const std::string& indent, const Annotation& annotation) {
  if (const Json drawn = about(annotation); !drawn.empty())
    out << ",\n" << indent << "\"about\": " << dumped(drawn);
}

void write_surroundings(std::ostream& out, const std::string& indent, const Result& result) {
  write_about(out, indent, result.annotation);
  if (!result.boundaries.empty()) write_boundaries(out, indent, result);
}

}  // namespace extremal
