#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr std::size_t most_panels = 6;
constexpr double panel_height = 170, gap = 26, right_margin = 24;
/// Room above the largest amplitude, in decades.
constexpr double headroom = 0.3;

/// Whole powers of ten from the smallest amplitude to the largest.
Axis decades(const std::string& label, const std::vector<SpectralLine>& lines) {
  double low = INFINITY, high = -INFINITY;
  for (const SpectralLine& line : lines) {
    low = std::min(low, std::floor(std::log10(line.amplitude)));
    high = std::max(high, std::log10(line.amplitude));
  }
  Axis axis{.label = label, .low = low - 1, .high = std::max(high, low) + headroom, .ticks = {}};
  const int first = static_cast<int>(axis.low), last = static_cast<int>(std::floor(axis.high));
  const int step = (last - first + 4) / 4;
  for (int k = first; k <= last; k += step) axis.ticks.push_back({double(k), fmt::format("1e{}", k)});
  return axis;
}

Panel panel_of(const std::string& name, const std::vector<SpectralLine>& lines, const Axis& frequencies,
               Box box) {
  Panel panel;
  panel.box = box;
  panel.x = frequencies;
  panel.y = decades(name, lines);
  for (const SpectralLine& line : lines) {
    const double height = std::log10(line.amplitude);
    panel.curves.push_back({{line.frequency, line.frequency}, {panel.y.low, height}, first_colour, 1.2});
    panel.marks.push_back({line.frequency, height, first_colour, Shape::disc});
  }
  return panel;
}

}  // namespace

Figure spectrum_layout(const Result& result) {
  std::vector<std::size_t> shown;
  double highest = 0;
  const std::vector<Spectrum>& spectra = result.spectrum->motion.coordinates;
  for (std::size_t a = 0; a < spectra.size() && shown.size() < most_panels; ++a) {
    if (spectra[a].lines.empty()) continue;
    shown.push_back(a);
    for (const SpectralLine& line : spectra[a].lines) highest = std::max(highest, line.frequency);
  }
  if (shown.empty()) throw std::invalid_argument("cannot plot a spectrum without lines");
  if (highest == 0) highest = 1;
  std::string title = result.title;
  if (shown.size() < spectra.size())
    title += fmt::format("{}{} of {} coordinates", title.empty() ? "" : ": ", shown.size(), spectra.size());
  Figure figure = headed_figure(title, {});
  double top = top_of_panels(figure);
  figure.width = std::max(figure.width, 860.0);
  figure.height = top + static_cast<double>(shown.size()) * (panel_height + gap) - gap + bottom;
  for (const std::size_t a : shown) {
    Axis frequencies = make_axis({}, -0.02 * highest, 1.04 * highest, 9);
    if (a == shown.back())
      frequencies.label = "frequency, radians per unit of time";
    else
      frequencies.numbered = false;
    Panel panel = panel_of("amplitude of " + result.names[a], spectra[a].lines, frequencies, {});
    const double left = 44 + number_width(panel.y);
    panel.box = {left, top, figure.width - left - right_margin, panel_height};
    figure.panels.push_back(std::move(panel));
    top += panel_height + gap;
  }
  return figure;
}

std::string spectrum_image(const std::string& path, const Result& result) {
  return plot_image(path, spectrum_layout(result));
}

}  // namespace extremal
