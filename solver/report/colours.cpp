#include <algorithm>

#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr Colour sequential[] = {0x440154, 0x3B528B, 0x21918C, 0x5EC962, 0xFDE725};
constexpr Colour diverging[] = {0x0B4F8A, 0x6BAED6, 0xF7F7F7, 0xF4A261, 0xA63603};
/// Yellow is darker: it would not be seen on white.
constexpr Colour curves[] = {0x440154, 0x3B528B, 0x21918C, 0x5EC962, 0xC9B70A};

}  // namespace

std::span<const Colour> palette_colours(Palette palette) {
  if (palette == Palette::sequential) return sequential;
  return palette == Palette::diverging ? diverging : curves;
}

Colour shade(Palette palette, double place) {
  const std::span<const Colour> stops = palette_colours(palette);
  const double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto before = std::min<std::size_t>(static_cast<std::size_t>(at), stops.size() - 2);
  const double weight = at - static_cast<double>(before);
  Colour mixed = 0;
  for (const int shift : {16, 8, 0}) {
    const double low = (stops[before] >> shift) & 0xFF, high = (stops[before + 1] >> shift) & 0xFF;
    mixed |= static_cast<Colour>((1 - weight) * low + weight * high + 0.5) << shift;
  }
  return mixed;
}

std::vector<Colour> distinct_colours(std::size_t count) {
  static constexpr Colour distinct[longest_legend] = {first_colour, second_colour, 0x009E73,
                                                      0xCC79A7,     0xE69F00,      0x56B4E9};
  if (count <= longest_legend) return {distinct, distinct + count};
  std::vector<Colour> colours;
  for (std::size_t k = 0; k < count; ++k)
    colours.push_back(shade(Palette::curves, static_cast<double>(k) / static_cast<double>(count - 1)));
  return colours;
}

}  // namespace extremal
