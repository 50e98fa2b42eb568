#include "report/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "report/figure.hpp"
#include "solution/extension_values.hpp"

namespace extremal {

namespace {

/// In characters, of UTF-8.
std::size_t length(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, Table::Align align) {
  const std::string space(width - std::min(width, length(text)), ' ');
  return align == Table::Align::left ? text + space : space + text;
}

/// Lines "name  value"; those without a value, or with one that is not finite, are left out.
class Lines {
 public:
  void add(const std::string& name, const std::string& value) {
    if (!value.empty()) text_ += padded(name, 16, Table::Align::left) + value + "\n";
  }
  void add_number(const std::string& name, double value) {
    if (std::isfinite(value)) add(name, fmt::format("{:.12g}", value));
  }
  void add_small(const std::string& name, double value) {
    if (std::isfinite(value)) add(name, fmt::format("{:.1e}", value));
  }
  std::string text() const { return text_; }

 private:
  std::string text_;
};

std::string energy_text(const Solution& solution) {
  if (!solution.energy || !std::isfinite(*solution.energy)) return "";
  const std::string energy = fmt::format("{:.12g}", *solution.energy);
  const bool drift = solution.energy_drift && std::isfinite(*solution.energy_drift);
  return drift ? fmt::format("{}, drift {:.1e}", energy, *solution.energy_drift) : energy;
}

std::string index_text(const Solution& solution) {
  if (!solution.morse_index) return "";
  std::string text = fmt::format("{}", *solution.morse_index);
  if (solution.nullity) text += fmt::format(", nullity {}", *solution.nullity);
  return text + (solution.minimizing ? ", minimising" : "");
}

std::string windows_text(const Solution& solution) {
  if (!solution.converged() || solution.certificate == Certificate::none) return "";
  std::string text = fmt::format("{}, {}", solution.windows.size(), name(solution.certificate));
  const std::vector<double>& times = solution.conjugate_times;
  if (times.empty()) return text;
  constexpr std::size_t shown = 6;
  text += "; conjugate times ";
  for (std::size_t k = 0; k < std::min(times.size(), shown); ++k)
    text += fmt::format("{}{:.6g}", k ? ", " : "", times[k]);
  return times.size() > shown ? text + fmt::format(", … ({} in all)", times.size()) : text;
}

/// "1 element", "2 elements".
std::string counted(int count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// Of an orbit that repeats itself.
std::string period_text(const Solution& solution) {
  if (!solution.minimal_period || *solution.minimal_period == solution.duration()) return "";
  return fmt::format("{:.12g}, repeated {} times", *solution.minimal_period,
                     std::lround(solution.duration() / *solution.minimal_period));
}

/// Stability by pairs of multipliers λ, 1/λ, and quadruples λ, 1/λ with their conjugates.
std::string stability_text(const Solution& solution) {
  if (!solution.floquet || solution.floquet->multipliers.empty()) return "";
  const Floquet& floquet = *solution.floquet;
  std::string text = floquet.stable() ? "stable" : "unstable";
  const char* separator = ": ";
  if (!floquet.paired && floquet.outside() > 0)
    text += fmt::format(": {} outside of the unit circle", counted(floquet.outside(), "multiplier"));
  const auto list = [&](int count, const char* noun, const char* rest) {
    if (count > 0) text += std::exchange(separator, ", ") + counted(count, noun) + rest;
  };
  list(floquet.real_pairs, "real pair", "");
  list(floquet.quadruples, "complex quadruple", "");
  list(floquet.circle_pairs, "pair", " on the unit circle");
  list(floquet.trivial_pairs, "trivial pair",
       " at ±1 (double: exact for the time shift, else accurate to √ε)");
  return text + fmt::format("; largest modulus {:.9g}", std::abs(floquet.multipliers.front()));
}

/// Widths of the columns, in characters.
std::vector<std::size_t> widths(const Table& table) {
  std::vector<std::size_t> widest;
  for (const Table::Heading& heading : table.head)
    widest.push_back(std::max<std::size_t>(1, length(heading.text)));
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() != table.head.size()) {
      throw std::invalid_argument(
          fmt::format("a row has {} cells under {} headings", row.size(), table.head.size()));
    }
    for (std::size_t c = 0; c < row.size(); ++c) widest[c] = std::max(widest[c], length(row[c]));
  }
  return widest;
}

std::vector<std::string> headings(const Table& table) {
  std::vector<std::string> row;
  for (const Table::Heading& heading : table.head) row.push_back(heading.text);
  return row;
}

std::string plain_row(const Table& table, const std::vector<std::string>& cells,
                      const std::vector<std::size_t>& widest) {
  std::string line;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    line += (c == 0 ? "" : "  ") + padded(cells[c], widest[c], table.head[c].align);
  }
  return line.erase(line.find_last_not_of(' ') + 1) + "\n";
}

/// A row for each solution of a search.
std::string solutions_text(const Result& result) {
  using Align = Table::Align;
  Table table{
      {{"solution"}, {"action"}, {"duration"}, {"energy"}, {"index"}, {"nullity"}, {"strategy", Align::left}},
      {}};
  const auto count = [](const std::optional<int>& value) { return value ? fmt::format("{}", *value) : "–"; };
  for (const Result& each : *result.solutions) {
    const Solution& solution = each.solution;
    const bool energy = solution.energy && std::isfinite(*solution.energy);
    table.rows.push_back(
        {fmt::format("{}", table.rows.size() + 1), fmt::format("{:.12g}", solution.action),
         fmt::format("{:.10g}", solution.duration()), energy ? fmt::format("{:.10g}", *solution.energy) : "–",
         count(solution.morse_index), count(solution.nullity), printable(solution.strategy, 200)});
  }
  return fmt::format("\n{}", plain_text(table));
}

/// A row for each line of each coordinate.
std::string spectrum_text(const Result& result) {
  using Align = Table::Align;
  const SolutionSpectrum& spectrum = *result.spectrum;
  Table table{{{"coordinate", Align::left}, {"frequency"}, {"amplitude"}, {"phase"}}, {}};
  for (std::size_t a = 0; a < result.names.size(); ++a)
    for (const SpectralLine& line : spectrum.motion.coordinates[a].lines)
      table.rows.push_back({result.names[a], fmt::format("{:.14g}", line.frequency),
                            fmt::format("{:.12g}", line.amplitude), fmt::format("{:.10g}", line.phase)});
  Lines rest;
  for (std::size_t a = 0; a < result.names.size(); ++a) {
    if (spectrum.motion.drift[a] != 0)
      rest.add_number(fmt::format("drift of {}", result.names[a]), spectrum.motion.drift[a]);
    const Spectrum& lines = spectrum.motion.coordinates[a];
    rest.add_small(fmt::format("left of {}", result.names[a]), lines.residual);
    if (!spectrum.flat_norm.empty())
      rest.add_number(fmt::format("flat norm of {}", result.names[a]), spectrum.flat_norm[a]);
  }
  return fmt::format("\n{}{}", plain_text(table), rest.text());
}

/// A row for each unknown.
std::string fit_text(const Fitted& fit) {
  using Align = Table::Align;
  Table table{{{"fitted", Align::left}, {"value"}, {"standard deviation"}}, {}};
  std::vector<std::string> names = fit.parameters;
  names.insert(names.end(), fit.open_ends.begin(), fit.open_ends.end());
  for (std::size_t k = 0; k < names.size(); ++k)
    table.rows.push_back({names[k], fmt::format("{:.12g}", fit.values[k]),
                          fmt::format("{:.3g}", std::sqrt(fit.covariance[k][k]))});
  Lines rest;
  rest.add("chi squared", fmt::format("{:.9g}, degrees of freedom: {}{}", fit.chi_squared, fit.freedom,
                                      fit.scaled ? "; deviations by the scatter of the data" : ""));
  return fmt::format("\n{}{}", plain_text(table), rest.text());
}

/// Constants that were found, multipliers of integrals, and impulses.
void add_extension(const ExtensionValues& values, const std::vector<std::string>& names, Lines& lines) {
  for (const auto& [name, value] : values.unknowns) lines.add_number(name, value);
  for (const double nu : values.integral_multipliers) lines.add_number("multiplier", nu);
  for (const WaypointImpulse& waypoint : values.waypoints) {
    std::string text = fmt::format("t = {:.12g}, impulse", waypoint.time);
    for (const auto& [a, jump] : waypoint.impulse) text += fmt::format(" {} {:.12g}", names.at(a), jump);
    lines.add("waypoint", text);
  }
}

}  // namespace

std::string summary(const Result& result) {
  const Solution& solution = result.solution;
  const Trajectory& trajectory = solution.trajectory;
  Lines lines;
  lines.add("title", printable(result.title, 200));
  lines.add("status", name(solution.status));
  if (solution.converged()) lines.add("message", printable(solution.message, 2000));
  lines.add("strategy", printable(solution.strategy, 200));
  if (result.natural_conditions > 0 && !result.fit)  // of a fit open ends are unknowns
    lines.add("boundary", counted(result.natural_conditions, "natural condition"));
  if (trajectory.elements() > 0) {
    lines.add_number("duration", solution.duration());
    lines.add_number("action", solution.action);
    if (solution.extension) add_extension(*solution.extension, result.names, lines);
    lines.add("energy", energy_text(solution));
    if (solution.work) lines.add_number("work of forces", *solution.work);
    if (solution.converged()) lines.add_small("error estimate", solution.error_estimate);
    lines.add_small("residual", solution.residual);
    lines.add("index", index_text(solution));
    lines.add("period", period_text(solution));
    lines.add("stability", stability_text(solution));
    lines.add("windows", windows_text(solution));
    lines.add("mesh", fmt::format("{} of degree {}, {}", counted(trajectory.elements(), "element"),
                                  solution.degree, counted(solution.unknowns, "unknown")));
  }
  lines.add("iterations", fmt::format("{}", solution.iterations));
  lines.add("time",
            fmt::format("read {}, solve {}, analyse {}", duration_text(result.seconds_read),
                        duration_text(solution.seconds_solve), duration_text(solution.seconds_analyse)));
  std::string text = lines.text();
  if (result.solutions && result.solutions->size() > 1) text += solutions_text(result);
  if (result.fit && solution.converged()) text += fit_text(*result.fit);
  if (result.spectrum && solution.converged()) text += spectrum_text(result);
  return text;
}

std::string duration_text(double seconds) {
  struct Unit {
    double size;
    const char* name;
  };
  static constexpr Unit units[] = {{1e-9, "ns"}, {1e-6, "µs"}, {1e-3, "ms"}, {1, "s"}};
  const Unit* unit = units;
  while (unit->size < 1 && seconds / unit->size >= 999.5) ++unit;
  const double value = seconds / unit->size;
  const int decimals = value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f} {}", value, decimals, unit->name);
}

std::string plain_text(const Table& table) {
  const std::vector<std::size_t> widest = widths(table);
  std::string text = plain_row(table, headings(table), widest);
  for (const std::vector<std::string>& row : table.rows) text += plain_row(table, row, widest);
  return text;
}

}  // namespace extremal
