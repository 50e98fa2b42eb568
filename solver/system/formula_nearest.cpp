#include <algorithm>
#include <string_view>
#include <utility>

#include "system/formula.hpp"

namespace extremal {

namespace {

/// Edits that turn a into b: insertion, deletion, replacement, exchange of neighbours (optimal string
/// alignment). Anything above `limit` is returned where the lengths alone differ by more.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > limit) return limit + 1;
  std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, previous);
    std::swap(previous, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::string velocity_meant(const std::string& name, std::span<const Coordinate> coordinates) {
  for (const Coordinate& c : coordinates)
    for (const auto& [before, after] :
         {std::pair("d", ""), std::pair("d", "dt"), std::pair("d", "_dt"), std::pair("v", ""),
          std::pair("v_", ""), std::pair("", "_dot"), std::pair("", "dot"), std::pair("dot_", ""),
          std::pair("", "_t"), std::pair("", "_prime")})
      if (name == before + c.name + after) return c.name;
  return {};
}

std::string nearest_name(const std::string& name, std::span<const std::string> known) {
  constexpr std::size_t longest = 64, shortest_beginning = 3;
  const auto same_letters = [&](const std::string& other) {
    return std::ranges::equal(name, other, {}, lower, lower);
  };
  if (const auto found = std::ranges::find_if(known, same_letters); found != known.end()) return *found;
  if (name.size() < 2 || name.size() > longest) return {};  // one letter is near to every other
  std::size_t least = std::max<std::size_t>(1, name.size() / 3) + 1;
  std::string nearest;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate, least - 1);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  if (!nearest.empty() || name.size() < shortest_beginning) return nearest;
  const auto longer = [&](const std::string& other) { return other.starts_with(name); };
  const auto found = std::ranges::find_if(known, longer);
  return found == known.end() ? nearest : *found;
}

}  // namespace extremal
