#include "problem/point_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace extremal {

std::string point_text(const std::vector<std::string>& names, std::span<const double> q, int digits) {
  constexpr std::size_t most_named = 6;
  std::string text;
  for (std::size_t a = 0; a < std::min(q.size(), most_named); ++a)
    text += fmt::format("{}{} = {:.{}g}", a ? ", " : "",
                        a < names.size() ? names[a] : fmt::format("q[{}]", a + 1), q[a], digits);
  return text + (q.size() > most_named ? ", …" : "");
}

}  // namespace extremal
