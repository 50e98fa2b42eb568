#include "report/oem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "report/layout.hpp"

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

std::string date(const Units& units, double t) {
  const double seconds = t * units.time, start = static_cast<double>(units.epoch.time_since_epoch().count());
  if (!(std::abs(start + seconds * 1e9) < latest))
    throw std::invalid_argument("the ephemeris ends beyond the year 2262; [units] or the duration is wrong");
  // Whole seconds and the rest apart, so that no digits are lost.
  const double whole = std::floor(seconds);
  return epoch_text(units.epoch + std::chrono::seconds(static_cast<long long>(whole)) +
                    std::chrono::nanoseconds(std::llround((seconds - whole) * 1e9)));
}

/// What of a title is ASCII, on one line.
std::string object_name(const std::string& title) {
  std::string name;
  for (const char c : title)
    if (c >= ' ' && c <= '~') name += c;
  return name.find_first_not_of(' ') == std::string::npos ? "TRAJECTORY" : name;
}

}  // namespace

void check_oem(const std::vector<std::string>& names) { positions(names); }

std::string oem_text(const Units& units, const std::string& title, const std::vector<std::string>& names,
                     const Samples& samples) {
  check_shape(samples, names);
  const std::vector<Axes> bodies = positions(names);
  std::vector<std::string> dates;
  for (const double t : samples.t) dates.push_back(date(units, t));
  std::string text = fmt::format("CCSDS_OEM_VERS = 2.0\nCREATION_DATE = {}\nORIGINATOR = EXTREMAL\n",
                                 epoch_text(units.epoch));
  const int degree = std::min<int>(largest_degree, 2 * static_cast<int>(dates.size()) - 1);
  const std::array scales{units.length, units.length / units.time};
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string number = bodies.size() > 1 ? fmt::format(" {}", b + 1) : "";
    fmt::format_to(std::back_inserter(text),
                   "\nMETA_START\nOBJECT_NAME = {}{}\nOBJECT_ID = {}\nCENTER_NAME = {}\nREF_FRAME = {}\n"
                   "TIME_SYSTEM = TDB\nSTART_TIME = {}\nSTOP_TIME = {}\nINTERPOLATION = HERMITE\n"
                   "INTERPOLATION_DEGREE = {}\nMETA_STOP\n\n",
                   object_name(title), number, b + 1, units.centre, units.frame, dates.front(), dates.back(),
                   degree);
    for (std::size_t k = 0; k < dates.size(); ++k) {
      text += dates[k];
      for (const bool velocity : {false, true})
        for (const int a : bodies[b]) {
          const double value = a < 0 ? 0 : (velocity ? samples.v : samples.q)[a][k] * scales[velocity];
          if (!std::isfinite(value)) throw std::invalid_argument("[units] take the ephemeris out of range");
          fmt::format_to(std::back_inserter(text), " {:.{}e}", value, decimals);
        }
      text += '\n';
    }
  }
  return text;
}

}  // namespace extremal
