#include "solve/branch/root.hpp"

#include <span>

namespace extremal {

namespace {

/// The polynomial through samples.
double polynomial(std::span<const Sample> samples, double at) {
  double sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double factor = 1;
    for (std::size_t j = 0; j < samples.size(); ++j)
      if (j != i) factor *= (at - samples[j].at) / (samples[i].at - samples[j].at);
    sum += factor * samples[i].value;
  }
  return sum;
}

/// The last sample at or before `low`, the first at or after `high`, and those nearest to both, four in all
/// at most.
std::vector<Sample> around(const std::vector<Sample>& samples, double low, double high) {
  constexpr std::size_t most = 4;
  std::size_t after = 0;
  while (samples[after].at < high) ++after;
  std::size_t before = after - 1;
  while (samples[before].at > low) --before;
  std::vector<Sample> found = {samples[before], samples[after++]};
  while (found.size() < most && (before > 0 || after < samples.size())) {
    const bool back =
        after == samples.size() || (before > 0 && low - samples[before - 1].at < samples[after].at - high);
    found.push_back(back ? samples[--before] : samples[after++]);
  }
  return found;
}

/// Where, between samples of one sign, the interpolant less its difference from another one is least, if that
/// is of another sign.
std::optional<double> lowest(const Sample& low, const Sample& high, std::span<const Sample> through,
                             std::span<const Sample> others) {
  constexpr int parts = 16;
  const double sign = low.value < 0 ? -1 : 1;
  double least = 0;
  std::optional<double> where;
  for (int i = 1; i < parts; ++i) {
    const double at = low.at + (high.at - low.at) * i / parts, value = polynomial(through, at);
    const double margin = sign * value - std::abs(value - polynomial(others, at));
    if (margin < least) least = margin, where = at;
  }
  return where;
}

}  // namespace

bool may_dip(const std::vector<Sample>& samples) {
  const Sample &low = samples.end()[-2], &high = samples.back();
  if (!(low.value * high.value > 0)) return false;
  double fastest = 0;
  for (std::size_t k = 1; k < samples.size(); ++k)
    fastest = std::max(
        fastest, std::abs((samples[k].value - samples[k - 1].value) / (samples[k].at - samples[k - 1].at)));
  if (std::abs(low.value + high.value) < 2 * fastest * (high.at - low.at)) return true;
  const std::vector<Sample> through = around(samples, low.at, high.at);
  return through.size() > 2 && lowest(low, high, through, std::span(through).first(through.size() - 1));
}

std::optional<double> unresolved(const std::vector<Sample>& before, const std::vector<Sample>& after,
                                 double low, double high) {
  const std::vector<Sample> through = around(after, low, high), others = around(before, low, high);
  if (changes_sign(through[0].value, through[1].value)) return std::nullopt;
  return lowest(through[0], through[1], through, others);
}

}  // namespace extremal
