#include "action/path.hpp"

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "machine/long_sum.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Beyond its end a polynomial of degree s is about (x + √(x² − 1))^s times as wrong as within, x = |2τ − 1|:
/// so much at most.
constexpr double most_growth = 1e6;
/// Elements of a piece of which the one that goes on best is looked for.
constexpr int most_inward = 64;

}  // namespace

void Path::reset(const ElementTables& tables, std::span<const double> mesh, double duration,
                 std::span<const double> lengths) {
  n_ = tables.coordinates();
  degree_ = tables.scheme().degree;
  unknowns_ = tables.unknowns();
  elements_ = static_cast<int>(mesh.size()) - 1;
  batches_ = (elements_ + lanes_ - 1) / lanes_;
  mesh_.assign(mesh.begin(), mesh.end());
  lengths_.assign(lengths.begin(), lengths.end());
  if (lengths.empty()) measure_mesh();
  lobatto_.assign(tables.scheme().lobatto.begin(), tables.scheme().lobatto.end());
  high_.assign(static_cast<std::size_t>(elements_ + 1) * n_, 0);
  low_.assign(high_.size(), 0);
  x_.assign(static_cast<std::size_t>(batches_) * unknowns_ * lanes_, 0);
  h_.resize(static_cast<std::size_t>(batches_) * lanes_);
  start_.resize(h_.size());
  set_duration(duration);
}

void Path::measure_mesh() {
  lengths_.resize(elements_);
  for (int k = 0; k < elements_; ++k) lengths_[k] = mesh_[k + 1] - mesh_[k];
}

void Path::set_duration(double duration) {
  duration_ = duration;
  for (int k = 0; k < batches_ * lanes_; ++k) {
    const int e = std::min(k, elements_ - 1);
    h_[k] = lengths_[e] * duration;
    start_[k] = mesh_[e] * duration;
  }
}

bool Path::move_mesh(std::span<const double> times, double factor, double least) {
  for (int k = 0; k < elements_; ++k)
    if (!(factor * (times[k + 1] - times[k]) > (least - 1) * lengths_[k])) return false;
  for (int k = 1; k < elements_; ++k) mesh_[k] += factor * times[k];
  measure_mesh();
  set_duration(duration_);
  return true;
}

/// Beyond the end of a piece, which is that of element k at `tau` out of [0, 1], a longer element of the
/// piece may be worth more than a short one at its end: that whose polynomial may grow least there. False
/// where it may grow too much.
bool Path::goes_on(std::span<const int> kinks, int& k, double& tau) const {
  const auto growth = [this](double at) {
    const double x = std::max(std::abs(2 * at - 1), 1.0);
    return std::pow(x + std::sqrt(x * x - 1), degree_);
  };
  double least = growth(tau), at = tau;
  if (least > 1)
    for (int e = k; std::abs(e - k) < most_inward;) {
      const bool back = at > 1;
      if (back ? e == 0 || kinks[e] > 0 : e + 1 == elements_ || kinks[e + 1] > 0) break;
      at = back ? 1 + at * lengths_[e] / lengths_[e - 1] : (at - 1) * lengths_[e] / lengths_[e + 1];
      e += back ? -1 : 1;
      if (!(growth(at) < least)) continue;
      least = growth(at);
      k = e;
      tau = at;
    }
  return least <= most_growth;
}

bool Path::slide(std::span<const double> shift, double most, std::span<const int> kinks) {
  std::vector<int> changed;
  for (int k = 0; k < elements_; ++k) {
    const double length = lengths_[k] + shift[k + 1] - shift[k];
    if (!(length * most > lengths_[k] && length < most * lengths_[k])) return false;
    if (shift[k] != 0 || shift[k + 1] != 0) changed.push_back(k);
  }
  const std::size_t count = degree_ + 1, size = count * n_;
  std::vector<double> q(changed.size() * size);
  for (std::size_t i = 0; i < changed.size(); ++i)
    for (std::size_t j = 0; j < count; ++j) {
      int k = changed[i];
      double tau = lobatto_[j] + (shift[k] + lobatto_[j] * (shift[k + 1] - shift[k])) / lengths_[k];
      for (; tau > 1 && k + 1 < elements_ && kinks[k + 1] == 0; ++k)
        tau = (tau - 1) * lengths_[k] / lengths_[k + 1];
      for (; tau < 0 && k > 0 && kinks[k] == 0; --k) tau = 1 + tau * lengths_[k] / lengths_[k - 1];
      if (!goes_on(kinks, k, tau)) return false;
      values(k, 1, &tau, q.data() + i * size + j * n_);
    }
  // Of neighbours, the end of one and the start of the other.
  for (std::size_t i = 0; i + 1 < changed.size(); ++i)
    for (int a = 0; a < n_ && changed[i] + 1 == changed[i + 1]; ++a) {
      double &end = q[i * size + degree_ * n_ + a], &start = q[(i + 1) * size + a];
      end = start = 0.5 * (end + start);
    }
  for (const int k : changed) lengths_[k] += shift[k + 1] - shift[k];
  for (int k = 1; k < elements_; ++k) mesh_[k] += shift[k];
  set_duration(duration_);
  const std::vector<double> high = high_, low = low_;
  for (std::size_t i = 0; i < changed.size(); ++i) set_element(changed[i], q.data() + i * size);
  for (int k = 0; k <= elements_; ++k)
    for (int a = 0; a < n_ && shift[k] == 0; ++a)
      set_node(k, a, high[static_cast<std::size_t>(k) * n_ + a], low[static_cast<std::size_t>(k) * n_ + a]);
  load_ends();
  return true;
}

void Path::set_element(int k, const double* q) {
  const double *first = q, *last = q + static_cast<std::size_t>(degree_) * n_;
  for (int a = 0; a < n_; ++a) {
    set_node(k, a, first[a]);
    set_node(k + 1, a, last[a]);
  }
  set_inner(k, q);
}

void Path::set_inner(int k, const double* q) {
  const double *first = q, *last = q + static_cast<std::size_t>(degree_) * n_;
  double* x = this->x(k / lanes_) + k % lanes_;
  for (int j = 1; j < degree_; ++j)
    for (int a = 0; a < n_; ++a)
      x[((j - 1) * n_ + a) * lanes_] = q[j * n_ + a] - (first[a] + lobatto_[j] * (last[a] - first[a]));
}

void Path::set_apart(int k, const double* q) {
  const double *first = q, *last = q + static_cast<std::size_t>(degree_) * n_;
  set_inner(k, q);
  double* to = x(k / lanes_) + static_cast<std::size_t>(unknowns_ - 2 * n_) * lanes_ + k % lanes_;
  for (int a = 0; a < n_; ++a) {
    to[a * lanes_] = first[a];
    to[(n_ + a) * lanes_] = last[a] - first[a];
  }
  if (k == elements_ - 1) repeat_last();
}

void Path::set_image(int k, const Path& other, int j, const SignedPermutation& map, bool backwards) {
  const double* from = other.x(j / lanes_) + j % lanes_;
  double* to = x(k / lanes_) + k % lanes_;
  for (int a = 0; a < n_; ++a) {
    const int b = map.from[a];
    const double sign = map.sign[a];
    for (int end = 0; end < 2; ++end) {
      const int node = j + (backwards ? 1 - end : end);
      set_node(k + end, a, sign * other.node(node)[b], sign * other.rest(node)[b]);
    }
    for (int i = 0; i < degree_ - 1; ++i)
      to[(i * n_ + a) * lanes_] = sign * from[((backwards ? degree_ - 2 - i : i) * n_ + b) * lanes_];
  }
}

void Path::set_node(int k, int a, double high, double low) {
  high_[static_cast<std::size_t>(k) * n_ + a] = high;
  low_[static_cast<std::size_t>(k) * n_ + a] = low;
}

void Path::add(std::span<const double> node_step, const AlignedDoubles& inner_step, double factor) {
  for (std::size_t k = 0; k < high_.size(); ++k) {
    LongSum sum{high_[k], low_[k]};
    sum.add(factor * node_step[k]);
    high_[k] = sum.high;
    low_[k] = sum.low;
  }
  const std::size_t inner = static_cast<std::size_t>(unknowns_ - 2 * n_) * lanes_;
  for (int b = 0; b < batches_; ++b) {
    double* to = x(b);
    const double* from = inner_step.data() + static_cast<std::size_t>(b) * unknowns_ * lanes_;
    for (std::size_t k = 0; k < inner; ++k) to[k] += factor * from[k];
  }
}

void Path::copy_values(const Path& other) {
  high_ = other.high_;
  low_ = other.low_;
  x_ = other.x_;
  if (duration_ != other.duration_) set_duration(other.duration_);
}

void Path::load_ends() {
  for (int k = 0; k < batches_ * lanes_; ++k) {
    const std::size_t e = static_cast<std::size_t>(std::min(k, elements_ - 1)) * n_;
    double* to = x(k / lanes_) + static_cast<std::size_t>(unknowns_ - 2 * n_) * lanes_ + k % lanes_;
    for (int a = 0; a < n_; ++a) {
      to[a * lanes_] = high_[e + a];
      to[(n_ + a) * lanes_] = (high_[e + n_ + a] - high_[e + a]) + (low_[e + n_ + a] - low_[e + a]);
    }
  }
  repeat_last();
}

/// Idle lanes repeat the last element, so that nothing they compute is exceptional.
void Path::repeat_last() {
  for (int k = elements_; k < batches_ * lanes_; ++k) {
    double* last = x(batches_ - 1);
    const int from = (elements_ - 1) % lanes_, to = k % lanes_;
    for (int u = 0; u < unknowns_; ++u) last[u * lanes_ + to] = last[u * lanes_ + from];
  }
}

void Path::interpolate_from(const Path& other, const ElementTables& tables, std::span<const double> matrix) {
  reset(tables, other.mesh(), other.duration(), other.lengths());
  high_ = other.high_;
  low_ = other.low_;
  const int old_inner = other.degree_ - 1, old_count = other.degree_ + 1;
  const std::size_t width = static_cast<std::size_t>(n_) * lanes_;  // from one node to the next
  for (int b = 0; b < batches_; ++b)
    for (int j = 1; j < degree_; ++j) {
      const double* row = matrix.data() + static_cast<std::size_t>(j) * old_count;
      double* to = x(b) + (j - 1) * width;
      for (int i = 0; i < old_inner; ++i) {
        const double* from = other.x(b) + i * width;
        const double factor = row[i + 1];
        for (std::size_t k = 0; k < width; ++k) to[k] += factor * from[k];
      }
    }
  load_ends();
}

void Path::split_from(const Path& other, const ElementTables& tables, std::span<const double> halves) {
  std::vector<double> mesh, lengths;
  for (int k = 0; k < other.elements_; ++k) {
    lengths.insert(lengths.end(), 2, 0.5 * other.lengths_[k]);
    mesh.push_back(other.mesh_[k]);
    mesh.push_back(0.5 * (other.mesh_[k] + other.mesh_[k + 1]));
  }
  mesh.push_back(1);
  reset(tables, mesh, other.duration_, lengths);
  const int count = degree_ + 1;
  std::vector<double> whole(static_cast<std::size_t>(count) * n_), part(whole.size());
  for (int k = 0; k < elements_; ++k) {
    other.element(k / 2, whole.data());
    std::fill(part.begin(), part.end(), 0.0);
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i)
        for (int a = 0; a < n_; ++a)
          part[j * n_ + a] += halves[((k % 2) * degree_ + j) * count + i] * whole[i * n_ + a];
    set_element(k, part.data());
  }
  for (int k = 0; k <= other.elements_; ++k)
    for (int a = 0; a < n_; ++a) {
      high_[2 * k * n_ + a] = other.high_[k * n_ + a];
      low_[2 * k * n_ + a] = other.low_[k * n_ + a];
    }
  load_ends();
}

/// q at `count` points τ of element k, coordinate a of point p at q[a*count + p], by the barycentric formula
/// for the deviation from the chord.
void Path::values(int k, int count, const double* tau, double* q) const {
  constexpr double nothing = 1e-290;  // from a node: its own weight is then all there is
  const std::vector<double>& weights = lobatto_barycentric(degree_).weights;
  const double* x = this->x(k / lanes_) + k % lanes_;
  const double* delta = x + static_cast<std::size_t>(unknowns_ - n_) * lanes_;
  double sum[max_degree + 1] = {}, weight[max_degree + 1];
  std::fill_n(q, static_cast<std::size_t>(n_) * count, 0.0);
  for (int j = 0; j <= degree_; ++j) {
    for (int p = 0; p < count; ++p) {
      const double distance = tau[p] - lobatto_[j];
      weight[p] = weights[j] / (distance == 0 ? nothing : distance);
      sum[p] += weight[p];
    }
    if (j == 0 || j == degree_) continue;
    for (int a = 0; a < n_; ++a) {
      const double deviation = x[((j - 1) * n_ + a) * lanes_];
      for (int p = 0; p < count; ++p) q[a * count + p] += weight[p] * deviation;
    }
  }
  for (int a = 0; a < n_; ++a)
    for (int p = 0; p < count; ++p)
      q[a * count + p] = node(k)[a] + (tau[p] * delta[a * lanes_] + q[a * count + p] / sum[p]);
}

void Path::resample_from(const Path& other, const ElementTables& tables, std::span<const double> mesh) {
  reset(tables, mesh, other.duration_);
  const int count = degree_ + 1;
  std::vector<double> q(static_cast<std::size_t>(count) * n_), part(q.size());
  double tau[max_degree + 1];
  int at = 0;
  for (int k = 0; k < elements_; ++k) {
    // Runs of points that lie in one element of the other path.
    for (int j = 0; j < count;) {
      const auto time = [&](int i) {
        return i == degree_ ? mesh_[k + 1] : mesh_[k] + lobatto_[i] * (mesh_[k + 1] - mesh_[k]);
      };
      while (at + 1 < other.elements_ && time(j) >= other.mesh_[at + 1]) ++at;
      const double from = other.mesh_[at], to = other.mesh_[at + 1];
      int run = 0;
      for (; j + run < count && (time(j + run) < to || at + 1 == other.elements_); ++run)
        tau[run] = std::min((time(j + run) - from) / (to - from), 1.0);
      other.values(at, run, tau, part.data());
      for (int p = 0; p < run; ++p)
        for (int a = 0; a < n_; ++a) q[(j + p) * n_ + a] = part[a * run + p];
      j += run;
    }
    set_element(k, q.data());
    at = std::max(0, at - 1);
  }
  for (int a = 0; a < n_; ++a) {
    high_[a] = other.high_[a];
    low_[a] = other.low_[a];
    const std::size_t last = high_.size() - n_ + a, other_last = other.high_.size() - n_ + a;
    high_[last] = other.high_[other_last];
    low_[last] = other.low_[other_last];
  }
  load_ends();
}

void Path::element(int k, double* q) const {
  const double* x = this->x(k / lanes_) + k % lanes_;
  const double *first = node(k), *last = node(k + 1);
  const std::size_t delta = static_cast<std::size_t>(unknowns_ - n_) * lanes_;
  for (int a = 0; a < n_; ++a) {
    q[a] = first[a];
    q[degree_ * n_ + a] = last[a];
    for (int j = 1; j < degree_; ++j)
      q[j * n_ + a] = first[a] + (lobatto_[j] * x[delta + a * lanes_] + x[((j - 1) * n_ + a) * lanes_]);
  }
}

void Path::element_slopes(int k, std::span<const double> derivative, double* v) const {
  const double* x = this->x(k / lanes_) + k % lanes_;
  const double* delta = x + static_cast<std::size_t>(unknowns_ - n_) * lanes_;
  const double length = h(k / lanes_)[k % lanes_];
  for (int j = 0; j <= degree_; ++j)
    for (int a = 0; a < n_; ++a) {
      double slope = delta[a * lanes_];
      for (int i = 1; i < degree_; ++i)
        slope += derivative[j * (degree_ + 1) + i] * x[((i - 1) * n_ + a) * lanes_];
      v[j * n_ + a] = slope / length;
    }
}

}  // namespace extremal
