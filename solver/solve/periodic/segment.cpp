#include "solve/periodic/segment.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "solve/periodic/limits.hpp"
#include "solve/periodic/repetition.hpp"

namespace extremal {

using namespace limits::segment;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// "x[3]": x and 3; "x": x and 0.
std::pair<std::string, int> parse(const std::string& name) {
  const std::size_t bracket = name.find('[');
  if (bracket == std::string::npos) return {name, 0};
  return {name.substr(0, bracket), std::atoi(name.c_str() + bracket + 1)};
}

}  // namespace

SegmentSource::SegmentSource(const Problem& problem) : problem_(problem) {
  const int n = problem.coordinates();
  const bool closed = problem.periodic && problem.lagrangian->structure().autonomous;
  usable_ =
      closed && !problem.duration.where && n <= most_coordinates_for_rotations * 2 && !problem.names.empty();
  if (!usable_) return;
  whole_ = closing_map(problem);
  std::map<std::string, int> arrays;
  for (const std::string& name : problem.names) {
    const auto [array, index] = parse(name);
    array_.push_back(arrays.try_emplace(array, static_cast<int>(arrays.size())).first->second);
    index_.push_back(index);
    longest_ = std::max(longest_, index);
  }
  arrays_ = static_cast<int>(arrays.size());
  extent_ = 0;
  for (double q : problem.guess.q) extent_ = std::max(extent_, std::abs(q));
  if (extent_ == 0) extent_ = 1;
}

int SegmentSource::below(int count) {
  return static_cast<int>((random_() >> 8) % static_cast<unsigned>(count));
}

/// Signs times a permutation times a power of the closing map.
MatrixXd SegmentSource::candidate() {
  const int n = problem_.coordinates();
  std::vector<double> sign(arrays_);
  for (double& s : sign) s = below(2) ? 1 : -1;
  std::vector<int> image(longest_ + 1);
  std::iota(image.begin(), image.end(), 0);
  if (longest_ > 1) {
    const int kind = below(4);
    if (kind == 1) std::rotate(image.begin() + 1, image.begin() + 2, image.end());
    if (kind == 2) std::swap(image[1 + below(longest_)], image[1 + below(longest_)]);
    if (kind == 3)
      for (int i = longest_; i > 1; --i) std::swap(image[i], image[1 + below(i)]);
  }
  MatrixXd s = MatrixXd::Zero(n, n);
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      if (array_[a] == array_[b] && index_[b] == image[index_[a]]) s(a, b) = sign[array_[a]];
  for (int power = below(most_parts); power > 0; --power) s = whole_.r * s;
  return s;
}

bool SegmentSource::leaves_unchanged(const MatrixXd& s) {
  const Eigen::Index n = s.rows();
  const auto number = [&] { return 2.0 * random_() / std::minstd_rand::max() - 1; };
  Scratch scratch;
  const auto value = [&](const VectorXd& q, const VectorXd& v) {
    const std::size_t count = static_cast<std::size_t>(n);
    return evaluate_at(*problem_.lagrangian, {q.data(), count}, {v.data(), count}, 0, Order::value, scratch)
        .value;
  };
  int found = 0;
  for (int k = 0; k < most_points && found < points; ++k) {
    VectorXd q(n), v(n);
    for (Eigen::Index a = 0; a < n; ++a) {
      q[a] = extent_ * number();
      v[a] = extent_ / problem_.duration.value * number();
    }
    const double here = value(q, v), there = value(s * q, s * v);
    if (!std::isfinite(here)) continue;
    if (!(std::abs(there - here) <= same * (1 + std::abs(here)))) return false;
    ++found;
  }
  return found == points;
}

/// The least k > 1 with S^k = R; 0 if there is none.
int SegmentSource::parts_of(const MatrixXd& s) const {
  if (!whole_.c.isZero(0)) return 0;
  MatrixXd power = s;
  for (int k = 2; k <= most_parts; ++k) {
    power = s * power;
    if (power.isApprox(whole_.r, same)) return k;
  }
  return 0;
}

Segment SegmentSource::segment(const MatrixXd& s, int parts) const {
  const int n = problem_.coordinates();
  Segment result{problem_, parts, {s, VectorXd::Zero(n)}};
  Problem& part = result.problem;
  part.guess = {};
  part.duration.value /= parts;
  part.boundary = {};
  part.boundary.coordinates = n;
  for (int a = 0; a < n; ++a) {
    const int row = part.boundary.add_row(0);
    part.boundary.add(row, n + a, 1);
    for (int b = 0; b < n; ++b)
      if (s(a, b) != 0) part.boundary.add(row, b, -s(a, b));
  }
  part = make_problem(std::move(part));
  return result;
}

std::optional<Segment> SegmentSource::draw() {
  for (int k = 0; usable_ && k < most_draws; ++k) {
    const MatrixXd s = candidate();
    const int parts = parts_of(s);
    const auto known = [&](const MatrixXd& other) { return other.isApprox(s, same); };
    // All orbits of a symmetry that closes them elsewhere than after a number of whole T repeat themselves.
    if (parts == 0 || segments_to_close({s, VectorXd::Zero(s.rows())}) % parts != 0) continue;
    if (std::any_of(drawn_.begin(), drawn_.end(), known) || !leaves_unchanged(s)) continue;
    drawn_.push_back(s);
    return segment(s, parts);
  }
  return std::nullopt;
}

}  // namespace extremal
