#include "analysis/windows.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/limits.hpp"

namespace extremal {

namespace {

/// By which a window ends before the time conjugate to its start, relative.
constexpr double margin = 1e-6;

/// Of the last piece: farther off, the distance of a conjugate time is not measured.
constexpr double near_piece = 0.05;

/// Conjugate times to the start of piece 0, those at T left out.
void find_conjugate_times(SecondVariation& variation, Minimality& result) {
  JacobiFields fields;
  const int last = variation.count() - 1;
  std::vector<double>& times = result.conjugate_times.emplace();
  fields.begin(variation, 0, 0);
  if (variation.coordinates() > limits::windows::always_found) fields.allow(limits::windows::most_work);
  for (int k = 1; k <= last; ++k) {
    const double start = variation.end(k - 1), length = variation.end(k) - start;
    const double distance = k == last ? fields.distance(variation, k) : INFINITY;
    if (distance < near_piece) result.distance = distance * length;
    for (double tau : fields.advance(variation, k))
      if (k < last || tau < 1) times.push_back(start + tau * length);
    if (fields.given_up()) return result.conjugate_times.reset();
  }
}

/// The first time conjugate to `start`, not after T; infinite if there is none.
double next_conjugate_time(SecondVariation& variation, double start) {
  int k = variation.piece_at(start);
  JacobiFields fields;
  const double from = k > 0 ? variation.end(k - 1) : 0;
  fields.begin(variation, k, std::max(0.0, (start - from) / (variation.end(k) - from)));
  for (++k; k < variation.count(); ++k) {
    const std::vector<double>& found = fields.advance(variation, k, true);
    if (found.empty()) continue;
    const double before = variation.end(k - 1);
    return before + found.front() * (variation.end(k) - before);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

Minimality minimality(SecondVariation& variation, double longest) {
  Minimality result;
  find_conjugate_times(variation, result);
  const double duration = variation.end(variation.count() - 1);
  for (double start = 0; start < duration;) {
    const bool known = start == 0 && result.conjugate_times && !result.conjugate_times->empty();
    const double conjugate = known ? result.conjugate_times->front() : next_conjugate_time(variation, start);
    const double length = std::min(conjugate - start, longest);
    result.within_longest = result.within_longest && longest <= length;
    const double end = start + length <= duration ? start + (1 - margin) * length : duration;
    result.windows.push_back({start, end});
    start = end;
  }
  return result;
}

}  // namespace extremal
