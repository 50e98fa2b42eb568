#include "linear/supernodal.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Wider supernodes are divided: within one, pivots are taken one by one.
constexpr int most_pivots = 64;

/// Multiplications between two questions of the deadline.
constexpr double most_at_once = 5e7;

int padded(int n, int padding) { return (n + padding - 1) / padding * padding; }

std::size_t size_of_u(const FrontShape& s) {
  const std::size_t width = s.stride - s.half;
  return width * width;
}

}  // namespace

bool SupernodalFactor::analyse(const SparsePattern& lower, const Deadline& deadline) {
  fronts_.clear();
  if (deadline.passed()) return false;
  kernels_ = at_simd_level(EXTREMAL_AT_EACH_LEVEL(front_kernels))();
  nodes_ = find_supernodes(lower, most_pivots);
  if (deadline.passed()) return false;
  const int n = int(nodes_.order.size()), count = nodes_.count();
  fronts_.resize(count);
  std::size_t v = 0, most_w = 0, most_stride = 0;
  most_u_ = 0;
  for (int s = 0; s < count; ++s) {
    Front& front = fronts_[s];
    FrontShape& shape = front.shape;
    shape.pivots = nodes_.first[s + 1] - nodes_.first[s];
    shape.rest = nodes_.row_begin[s + 1] - nodes_.row_begin[s];
    shape.half = padded(shape.pivots, kernels_.padding);
    shape.stride = shape.half + padded(shape.rest, kernels_.padding);
    front.first = nodes_.first[s];
    front.rows = nodes_.row_begin[s];
    front.v = v;
    const std::size_t size = std::size_t(shape.pivots) * shape.stride;
    v += size;
    most_w = std::max(most_w, size);
    most_u_ = std::max(most_u_, size_of_u(shape));
    most_stride = std::max(most_stride, std::size_t(shape.stride));
  }
  v_.resize(v);
  w_.resize(most_w);
  u_.resize(most_u_);
  columns_.resize(most_stride);
  work_.resize(most_stride);
  for (auto* vector : {&diagonal_, &size_, &taken_, &x_}) vector->resize(n);
  diagonal_.resize(2 * std::size_t(n));
  rest_.resize(most_stride);
  pivots_.resize(most_stride);
  chosen_.resize(n);
  lay_out(lower);
  plan_stack();
  return true;
}

/// Where the entries of the matrix and the rows of the children go in each front.
void SupernodalFactor::lay_out(const SparsePattern& lower) {
  const int n = int(nodes_.order.size()), count = nodes_.count();
  std::vector<int> position(n), front_of(n), column(n);
  for (int k = 0; k < n; ++k) position[nodes_.order[k]] = k;
  for (int s = 0; s < count; ++s)
    std::fill(front_of.begin() + nodes_.first[s], front_of.begin() + nodes_.first[s + 1], s);
  // Entries by front, children by parent: counted, then placed.
  std::vector<std::size_t> begin(count + 1, 0);
  const auto each_entry = [&](const auto& use) {
    for (int j = 0; j < n; ++j)
      for (int e = lower.begin[j]; e < lower.begin[j + 1]; ++e) {
        const auto [a, b] = std::minmax(position[lower.row[e]], position[j]);
        use(e, a, b);
      }
  };
  each_entry([&](int, int a, int) { ++begin[front_of[a] + 1]; });
  for (int s = 0; s < count; ++s) begin[s + 1] += begin[s];
  std::vector<std::pair<int, int>> places(begin[count]);
  sources_.resize(begin[count]);
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  each_entry([&](int e, int a, int b) {
    const std::size_t at = next[front_of[a]]++;
    sources_[at].entry = e;
    places[at] = {a, b};
  });
  child_begin_.assign(count + 1, 0);
  for (int parent : nodes_.parent)
    if (parent >= 0) ++child_begin_[parent + 1];
  for (int s = 0; s < count; ++s) child_begin_[s + 1] += child_begin_[s];
  child_.resize(child_begin_[count]);
  std::vector<int> next_child(child_begin_.begin(), child_begin_.end() - 1);
  for (int s = 0; s < count; ++s)
    if (nodes_.parent[s] >= 0) child_[next_child[nodes_.parent[s]]++] = s;

  to_.resize(nodes_.row.size());
  run_.resize(nodes_.row.size());
  for (int s = 0; s < count; ++s) {
    Front& front = fronts_[s];
    front.sources = begin[s];
    front.end = begin[s + 1];
    for (int k = 0; k < front.shape.pivots; ++k) column[front.first + k] = k;
    for (int k = 0; k < front.shape.rest; ++k) column[nodes_.row[front.rows + k]] = front.shape.half + k;
    for (std::size_t e = begin[s]; e < begin[s + 1]; ++e)
      sources_[e].place = (places[e].first - front.first) * front.shape.stride + column[places[e].second];
    for (int c = child_begin_[s]; c < child_begin_[s + 1]; ++c) {
      const Front& child = fronts_[child_[c]];
      int* const to = to_.data() + child.rows;
      int* const run = run_.data() + child.rows;
      for (int k = 0; k < child.shape.rest; ++k) to[k] = column[nodes_.row[child.rows + k]];
      for (int k = child.shape.rest - 1; k >= 0; --k)
        run[k] = k + 1 < child.shape.rest && to[k + 1] == to[k] + 1 ? run[k + 1] : k + 1;
    }
  }
}

/// U of the children of a front are the last ones on the stack when its turn comes.
void SupernodalFactor::plan_stack() {
  std::size_t top = 0, most = 0;
  for (int s = 0; s < nodes_.count(); ++s) {
    for (int c = child_begin_[s]; c < child_begin_[s + 1]; ++c) top -= size_of_u(fronts_[child_[c]].shape);
    fronts_[s].below = top;
    top += size_of_u(fronts_[s].shape);
    most = std::max(most, top);
  }
  stack_.resize(most);
}

/// W and U of a front: entries of the matrix, and U of the children, which leave the stack.
void SupernodalFactor::load(std::size_t s, std::span<const double> value) {
  const Front& front = fronts_[s];
  std::fill_n(w_.begin(), std::size_t(front.shape.pivots) * front.shape.stride, 0.0);
  std::fill_n(u_.begin(), size_of_u(front.shape), 0.0);
  for (std::size_t e = front.sources; e < front.end; ++e) w_[sources_[e].place] = value[sources_[e].entry];
  for (int i = 0; i < front.shape.pivots; ++i)
    size_[front.first + i] = w_[std::size_t(i) * (front.shape.stride + 1)];
  std::size_t at = front.below;
  for (int c = child_begin_[s]; c < child_begin_[s + 1]; ++c) {
    const Front& child = fronts_[child_[c]];
    kernels_.extend(child.shape, stack_.data() + at, to_.data() + child.rows, run_.data() + child.rows,
                    front.shape, w_.data(), u_.data());
    at += size_of_u(child.shape);
  }
}

bool SupernodalFactor::eliminate(const Front& front, double shift) {
  const FrontShape& shape = front.shape;
  const int p = shape.pivots;
  double* const size = size_.data() + front.first;
  for (int i = 0; i < p; ++i) {
    w_[std::size_t(i) * (shape.stride + 1)] += shift;
    size[i] = std::abs(size[i] + shift);
    for (int k = 0; k < i; ++k) w_[std::size_t(i) * shape.stride + k] = w_[std::size_t(k) * shape.stride + i];
  }
  const int* const rows = nodes_.row.data() + front.rows;
  std::fill_n(columns_.begin(), shape.stride, 0.0);
  std::copy_n(taken_.begin() + front.first, p, columns_.begin());
  for (int k = 0; k < shape.rest; ++k) columns_[shape.half + k] = taken_[rows[k]];
  FrontMonitor monitor = {growth_.most, growth_.cancellation, 0, 0};
  if (!kernels_.eliminate(shape, w_.data(), v_.data() + front.v, chosen_.data() + front.first,
                          diagonal_.data() + 2 * front.first, size, columns_.data(), work_.data(), &monitor))
    return false;
  for (int k = 0; k < shape.rest; ++k) taken_[rows[k]] = columns_[shape.half + k];
  growth_.most = monitor.most;
  growth_.cancellation = monitor.cancellation;
  growth_.inertia.positive += monitor.positive;
  growth_.inertia.negative += monitor.negative;
  return true;
}

/// In parts of rows, as a front may be large.
bool SupernodalFactor::update(const Front& front, const Deadline& deadline) {
  const FrontShape& shape = front.shape;
  const int rows = shape.stride - shape.half;
  const double wanted = most_at_once / (double(shape.pivots) * rows);
  const int part = padded(int(std::clamp(wanted, 1.0, double(rows))), kernels_.padding);
  for (int i = 0; i < rows; i += part) {
    if (deadline.passed()) return false;
    kernels_.update(shape, v_.data() + front.v, w_.data(), u_.data(), i, std::min(i + part, rows));
  }
  return true;
}

bool SupernodalFactor::factor(std::span<const double> value, double shift, const Deadline& deadline) {
  growth_ = {};
  std::fill(taken_.begin(), taken_.end(), 0.0);
  for (std::size_t s = 0; s < fronts_.size(); ++s) {
    const Front& front = fronts_[s];
    load(s, value);
    if (!eliminate(front, shift)) return false;
    if (front.shape.rest == 0) continue;
    if (!update(front, deadline)) return false;
    std::copy_n(u_.begin(), size_of_u(front.shape), stack_.begin() + front.below);
  }
  return std::isfinite(growth_.most) && std::isfinite(growth_.cancellation);
}

void SupernodalFactor::solve(double* x) {
  // x_ by positions, the pivots of a front in the order they were taken.
  const std::size_t n = nodes_.order.size();
  std::vector<double>& y = pivots_;
  for (std::size_t k = 0; k < n; ++k) x_[k] = x[nodes_.order[k]];
  for (const Front& front : fronts_) {
    const int* const rows = nodes_.row.data() + front.rows;
    const int* const chosen = chosen_.data() + front.first;
    double* const own = x_.data() + front.first;
    for (int i = 0; i < front.shape.pivots; ++i) y[i] = own[chosen[i]];
    std::fill_n(rest_.begin(), front.shape.rest, 0.0);
    kernels_.forward(front.shape, v_.data() + front.v, diagonal_.data() + 2 * front.first, y.data(),
                     rest_.data());
    std::copy_n(y.begin(), front.shape.pivots, own);
    for (int k = 0; k < front.shape.rest; ++k) x_[rows[k]] += rest_[k];
  }
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
    const int* const rows = nodes_.row.data() + front->rows;
    const int* const chosen = chosen_.data() + front->first;
    double* const own = x_.data() + front->first;
    for (int k = 0; k < front->shape.rest; ++k) rest_[k] = x_[rows[k]];
    kernels_.backward(front->shape, v_.data() + front->v, own, rest_.data());
    std::copy_n(own, front->shape.pivots, y.begin());
    for (int i = 0; i < front->shape.pivots; ++i) own[chosen[i]] = y[i];
  }
  for (std::size_t k = 0; k < n; ++k) x[nodes_.order[k]] = x_[k];
}

}  // namespace extremal
