#include "report/oem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <ostream>
#include <stdexcept>

#include "report/blocks.hpp"
#include "report/layout.hpp"
#include "report/numbers.hpp"

namespace extremal {
namespace {

constexpr int largest_degree = 7;  ///< of the interpolation that is advised: what readers have
constexpr int decimals = 15;       ///< section 7.5.7: at most 16 digits, the point behind the first
constexpr double latest = 9.2e18;  ///< nanoseconds from 1970 on that 64 bits hold

/// Where the coordinates x, y, z of a body stand; −1: there is none.
using Axes = std::array<int, 3>;

/// Of each body; empty where the coordinates are no positions.
std::vector<Axes> bodies_in_space(const Bodies& bodies) {
  std::vector<Axes> result;
  for (const std::vector<std::size_t>& place : bodies.places) {
    Axes axes{-1, -1, -1};
    for (std::size_t k = 0; k < bodies.axes.size(); ++k) {
      std::string name = bodies.axes[k];
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
      const std::size_t at = name.find_first_of("xyz");
      if (at == std::string::npos || name.size() > 2) return {};
      axes[name[at] - 'x'] = static_cast<int>(place[k]);
    }
    result.push_back(axes);
  }
  return result;
}

std::vector<Axes> positions(const std::vector<std::string>& names) {
  const std::optional<Bodies> found = bodies(names);
  const std::vector<Axes> result = found ? bodies_in_space(*found) : std::vector<Axes>();
  if (result.empty())
    throw std::invalid_argument(
        "an ephemeris needs positions of bodies as coordinates: x, y and z, or x[n], y[n] and z[n]");
  return result;
}

Epoch date(const Units& units, double t) {
  const double seconds = t * units.time;
  // Whole seconds and the rest apart, so that no digits are lost.
  const double whole = std::floor(seconds);
  return units.epoch + std::chrono::seconds(static_cast<long long>(whole)) +
         std::chrono::nanoseconds(std::llround((seconds - whole) * 1e9));
}

/// Of lengths and velocities.
std::array<double, 2> scales(const Units& units) { return {units.length, units.length / units.time}; }

void check_range(const Units& units, const Samples& samples) {
  const double start = static_cast<double>(units.epoch.time_since_epoch().count());
  for (const double t : samples.t)
    if (!(std::abs(start + t * units.time * 1e9) < latest))
      throw std::invalid_argument(
          "the ephemeris ends beyond the year 2262; [units] or the duration is wrong");
  const auto [length, velocity] = scales(units);
  const auto check = [](const std::vector<Column>& columns, double scale) {
    for (const Column& column : columns)
      for (const double value : column)
        if (!std::isfinite(value * scale))
          throw std::invalid_argument("[units] take the ephemeris out of range");
  };
  check(samples.q, length);
  check(samples.v, velocity);
}

/// What of a title is ASCII, on one line.
std::string object_name(const std::string& title) {
  std::string name;
  for (const char c : title)
    if (c >= ' ' && c <= '~') name += c;
  return name.find_first_not_of(' ') == std::string::npos ? "TRAJECTORY" : name;
}

/// The states of a body, a line each.
void write_states(std::ostream& out, const Units& units, const Samples& samples, const Axes& body) {
  struct Scaled {
    const Column* values;  ///< none along an axis that is not there
    double scale;
  };
  const auto [length, velocity] = scales(units);
  std::vector<Scaled> columns;
  for (const int a : body) columns.push_back({a < 0 ? nullptr : &samples.q[a], length});
  for (const int a : body) columns.push_back({a < 0 ? nullptr : &samples.v[a], velocity});
  const std::size_t room = epoch_size + columns.size() * (number_size + 1);
  write_blocks(out, samples.count(), room, [&](std::size_t first, std::size_t end, char* to) {
    for (std::size_t k = first; k < end; ++k) {
      to = write_epoch(date(units, samples.t[k]), to);
      for (const Scaled& column : columns) {
        const double value = column.values ? (*column.values)[k] * column.scale : 0;
        *to++ = ' ';
        to = std::to_chars(to, to + number_size, value, std::chars_format::scientific, decimals).ptr;
      }
      *to++ = '\n';
    }
    return to;
  });
}

}  // namespace

void check_oem(const std::vector<std::string>& names) { positions(names); }

void write_oem(std::ostream& out, const Units& units, const std::string& title,
               const std::vector<std::string>& names, const Samples& samples) {
  check_shape(samples, names);
  const std::vector<Axes> bodies = positions(names);
  check_range(units, samples);
  out << "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = " << epoch_text(units.epoch) << "\nORIGINATOR = EXTREMAL\n";
  const int degree = static_cast<int>(std::min<std::size_t>(largest_degree, 2 * samples.count() - 1));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string number = bodies.size() > 1 ? fmt::format(" {}", b + 1) : "";
    out << fmt::format(
        "\nMETA_START\nOBJECT_NAME = {}{}\nOBJECT_ID = {}\nCENTER_NAME = {}\nREF_FRAME = {}\n"
        "TIME_SYSTEM = TDB\nSTART_TIME = {}\nSTOP_TIME = {}\nINTERPOLATION = HERMITE\n"
        "INTERPOLATION_DEGREE = {}\nMETA_STOP\n\n",
        object_name(title), number, b + 1, units.centre, units.frame,
        epoch_text(date(units, samples.t.front())), epoch_text(date(units, samples.t.back())), degree);
    write_states(out, units, samples, bodies[b]);
  }
}

}  // namespace extremal
