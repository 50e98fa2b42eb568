#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/files/guess_file.hpp"

namespace bench {
namespace {

double largest_range(const std::vector<double>& rows, std::size_t n) {
  double result = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double low = rows[a], high = rows[a];
    for (std::size_t i = a; i < rows.size(); i += n) {
      low = std::min(low, rows[i]);
      high = std::max(high, rows[i]);
    }
    result = std::max(result, high - low);
  }
  return result;
}

double largest_difference(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() < y.size()) return std::numeric_limits<double>::infinity();
  double result = 0;
  for (std::size_t i = 0; i < y.size(); ++i) result = std::max(result, std::abs(x[i] - y[i]));
  return result;
}

}  // namespace

Reference read_reference(const std::string& path, const std::vector<std::string>& names) {
  std::vector<std::string> primed;
  for (const std::string& name : names) primed.push_back(name + "'");
  extremal::GuessFile positions = extremal::read_guess_file(path, names, {});
  Reference reference;
  reference.t = std::move(positions.t);
  reference.q = std::move(positions.q);
  reference.v = extremal::read_guess_file(path, primed, {}).q;
  reference.range = largest_range(reference.q, names.size());
  reference.velocity_range = largest_range(reference.v, names.size());
  for (double q : reference.q) reference.rounding = std::max(reference.rounding, 0x1p-53 * std::abs(q));
  return reference;
}

Difference difference(const extremal::Trajectory& trajectory, const Reference& reference) {
  const std::size_t n = trajectory.coordinates;
  std::vector<double> q(reference.q.size()), v(reference.v.size());
  for (std::size_t k = 0; k < reference.t.size(); ++k) {
    const double t = std::min(reference.t[k], trajectory.duration());
    double *here = q.data() + k * n, *speed = v.data() + k * n;
    trajectory.at(t, {here, n}, {speed, n});
    for (std::size_t a = 0; a < n; ++a) here[a] += (reference.t[k] - t) * speed[a];
  }
  return difference(q, v, reference);
}

Difference difference(const std::vector<double>& q, const std::vector<double>& v,
                      const Reference& reference) {
  return {std::max(largest_difference(q, reference.q), reference.rounding),
          largest_difference(v, reference.v)};
}

}  // namespace bench
