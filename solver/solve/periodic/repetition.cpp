#include "solve/periodic/repetition.hpp"
#include "solve/periodic/limits.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

using namespace limits::repetition;

namespace {

/// The path beyond T.
class Continued {
 public:
  Continued(const Trajectory& path, const ClosingMap& map, int segments)
      : path_(path), map_(map), segments_(segments), v_(path.coordinates) {}

  Eigen::VectorXd at(double t) {
    const double T = path_.duration();
    const int turns = static_cast<int>(std::floor(t / T));
    Eigen::VectorXd q(path_.coordinates);
    path_.at(std::clamp(t - turns * T, 0.0, T), {q.data(), v_.size()}, v_);
    for (int k = 0; k < turns % segments_; ++k) q = map_.r * q + map_.c;
    return q;
  }

 private:
  const Trajectory& path_;
  const ClosingMap& map_;
  int segments_;
  std::vector<double> v_;
};

bool is_prime(int number) {
  for (int k = 2; k * k <= number; ++k)
    if (number % k == 0) return false;
  return true;
}

}  // namespace

int segments_to_close(const ClosingMap& map) {
  Eigen::MatrixXd power = map.r;
  Eigen::VectorXd shift = map.c;
  for (int m = 1; m <= most_segments; ++m) {
    if (power.isIdentity(zero_entry) && shift.isZero(zero_entry)) return m;
    shift = map.r * shift + map.c;
    power = map.r * power;
  }
  return 0;
}

int repetitions(const Trajectory& path, const ClosingMap& map, int segments, double error) {
  constexpr int fewest = 64, most = 1 << 16;
  constexpr double aside = 0.382;  // where no symmetry has its points
  const int samples = std::max(fewest, segments * path.elements() * path.degree);
  const double whole = path.duration() * segments;
  Continued continued(path, map, segments);
  const Eigen::VectorXd first = continued.at(whole * aside / samples);
  const auto repeats = [&](double period) {
    for (int k = 0; k < samples; ++k) {
      const double t = whole * (k + aside) / samples;
      const Eigen::VectorXd moved = continued.at(t + period) - (k == 0 ? first : continued.at(t));
      if (!(moved.cwiseAbs().maxCoeff() <= error)) return false;
    }
    return true;
  };
  int parts = 1;
  for (int prime = 2; 2 * prime <= samples; ++prime)
    while (is_prime(prime) && parts < most && repeats(whole / (parts * prime))) parts *= prime;
  return parts < most ? parts : 0;
}

}  // namespace extremal
