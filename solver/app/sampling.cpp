#include "app/sampling.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "app/commands.hpp"

namespace extremal::app {

std::vector<double> parse_times(const std::string& text) {
  std::vector<double> times;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string cell = text.substr(begin, end - begin);
    double t = 0;
    const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), t);
    if (error != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(t))
      throw OptionError(fmt::format("--at: '{}' is not a time; write T1,T2,…", cell));
    if (t < 0) throw OptionError(fmt::format("--at: {} is before the start; times run from 0", t));
    times.push_back(t);
    begin = end + 1;
  }
  return times;
}

void check_times(const std::vector<double>& times, double duration) {
  for (const double t : times)
    if (t > duration) throw OptionError(fmt::format("--at: {} is beyond the duration {}", t, duration));
}

}  // namespace extremal::app
