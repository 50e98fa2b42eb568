#include "rivals/batch_dop853.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace extremal {

namespace {

constexpr double safety = 0.9, most_growth = 6, most_shrinking = 1.0 / 3;
/// Shortening where the slope cannot be evaluated.
constexpr double retreat = 0.25;
/// Of the time ahead, for the first step: q or p may be all but zero.
constexpr double shortest_start = 1e-6;
/// The error of a step is of this order in its length.
constexpr double order = 8;
/// So many steps before the end of a span, what is left is divided evenly.
constexpr double last_steps = 3;

int count(const std::vector<LaneStage>& stages) { return static_cast<int>(stages.size()); }

/// Order 8 less order 3.
constexpr dop853::Row<double> third_order_error() {
  dop853::Row<double> row{};
  for (int i = 0; i < dop853::stages; ++i) row[i] = dop853::b<double>[i] - dop853::b3<double>[i];
  return row;
}
constexpr dop853::Row<double> error3 = third_order_error();

}  // namespace

BatchDop853::BatchDop853(LaneFlow& flow)
    : flow_(flow), kernels_(flow.kernels()), t_(lanes_), h_(lanes_), stage_t_(lanes_), sums_(2 * lanes_) {}

void BatchDop853::resize(int columns) {
  rows_ = static_cast<std::size_t>(2 * flow_.coordinates()) * (1 + columns);
  y_.resize(rows_ * lanes_);
  next_.resize(rows_ * lanes_);
  k_.resize(rows_ * lanes_ * dop853::stages);
}

bool BatchDop853::under_way() const {
  return std::any_of(lane_, lane_ + lanes_, [](const Lane& lane) { return lane.span != nullptr; });
}

bool BatchDop853::run(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps,
                      const Deadline& deadline) {
  if (spans.empty()) return true;
  resize(columns);
  tolerance_ = tolerance;
  most_steps_ = most_steps;
  failed_ = false;
  waiting_.clear();
  for (std::size_t k = spans.size(); k-- > 0;) waiting_.push_back(&spans[k]);
  for (int l = 0; l < lanes_; ++l) {
    // A lane without a span of its own stays where the first one starts.
    const bool idle = waiting_.empty();
    if (idle) waiting_.push_back(&spans.front());
    take_span(l);
    if (idle) lane_[l].span = nullptr;
  }
  choose_first_steps();
  while (under_way()) {
    plan_steps();
    step(columns);
    judge();
    if (deadline.passed()) {
      failed_ = true;
      fail();
    }
  }
  return !failed_;
}

void BatchDop853::take_span(int l) {
  MotionSpan& span = *waiting_.back();
  waiting_.pop_back();
  for (std::size_t r = 0; r < rows_; ++r) y_[r * lanes_ + l] = span.initial[r];
  span.complete = false;
  span.steps = 0;
  const double longer = span.first_step > 0 ? std::pow(tolerance_ / span.tolerance, 1 / order) : 0;
  lane_[l] = {&span, span.start, span.first_step * longer, false, false};
}

/// For lanes that know none: a part of the time in which q or p would change by its own size.
void BatchDop853::choose_first_steps() {
  if (std::none_of(lane_, lane_ + lanes_, [](const Lane& lane) { return lane.span && lane.h == 0; })) return;
  const int n = flow_.coordinates();
  for (int l = 0; l < lanes_; ++l) t_[l] = lane_[l].t;
  flow_.slope(t_.data(), y_.data(), 0, k_.data());
  for (int l = 0; l < lanes_; ++l) {
    Lane& lane = lane_[l];
    if (!lane.span || lane.h > 0) continue;
    lane.h = lane.span->end - lane.t;
    for (const int begin : {0, n}) {
      double value = 0, slope = 0;
      for (int r = begin; r < begin + n; ++r) {
        value = std::max(value, std::abs(y_[r * lanes_ + l]));
        slope = std::max(slope, std::abs(k_[r * lanes_ + l]));
      }
      if (value > 0 && slope > 0)
        lane.h = std::min(lane.h, 2 * std::pow(tolerance_, 1 / order) * value / slope);
    }
    lane.h = std::max(lane.h, shortest_start * (lane.span->end - lane.t));
  }
}

void BatchDop853::plan_steps() {
  for (int l = 0; l < lanes_; ++l) {
    Lane& lane = lane_[l];
    t_[l] = lane.t;
    h_[l] = 0;
    if (!lane.span) continue;
    const double left = lane.span->end - lane.t, steps = std::ceil(left / lane.h * (1 - 1e-10));
    lane.last = steps <= 1;
    h_[l] = lane.last ? left : steps <= last_steps ? left / steps : lane.h;
  }
}

void BatchDop853::list(const dop853::Row<double>& row, std::vector<LaneStage>& stages) const {
  stages.clear();
  for (int j = 0; j < dop853::stages; ++j)
    if (row[j] != 0) stages.push_back({row[j], k_.data() + j * rows_ * lanes_});
}

void BatchDop853::step(int columns) {
  const auto combine = [&](const dop853::Row<double>& row) {
    list(row, stages_);
    kernels_.combine(y_.data(), h_.data(), stages_.data(), count(stages_), next_.data(),
                     static_cast<int>(rows_));
  };
  flow_.slope(t_.data(), y_.data(), columns, k_.data());
  for (int i = 1; i < dop853::stages; ++i) {
    combine(dop853::a<double>[i]);
    for (int l = 0; l < lanes_; ++l) stage_t_[l] = t_[l] + dop853::c<double>[i] * h_[l];
    flow_.slope(stage_t_.data(), next_.data(), columns, k_.data() + i * rows_ * lanes_);
  }
  combine(dop853::b<double>);
  ++steps_;
}

/// Hairer, Nørsett and Wanner (10.17): |h| e5² / √(e5² + 0.01 e3²), in units of the tolerance.
void BatchDop853::judge() {
  const int n = flow_.coordinates();
  std::fill(sums_.begin(), sums_.end(), 0.0);
  list(dop853::error5<double>, stages_);
  list(error3, others_);
  const std::size_t half = static_cast<std::size_t>(n) * lanes_;
  for (const std::size_t begin : {std::size_t(0), half}) {
    kernels_.add_errors(y_.data() + begin, next_.data() + begin, stages_.data(), count(stages_),
                        others_.data(), count(others_), tolerance_, sums_.data(), n);
    for (std::vector<LaneStage>* stages : {&stages_, &others_})
      for (LaneStage& stage : *stages) stage.slope += half;
  }
  bool taken = false;
  for (int l = 0; l < lanes_; ++l) {
    if (!lane_[l].span) continue;
    const double sum5 = sums_[l], sum3 = sums_[lanes_ + l];
    judge_lane(l, sum5 == 0 ? 0 : h_[l] * sum5 / std::sqrt((sum5 + 0.01 * sum3) * 2 * n));
    if (failed_) return fail();
    if (!lane_[l].span && !waiting_.empty()) {
      take_span(l);
      taken = true;
    }
  }
  if (taken) choose_first_steps();
}

void BatchDop853::judge_lane(int l, double error) {
  Lane& lane = lane_[l];
  const double h = h_[l];
  failed_ =
      h <= 4 * std::numeric_limits<double>::epsilon() * std::abs(lane.t) || ++lane.span->steps > most_steps_;
  if (failed_) return;
  const bool known = std::isfinite(error);
  const double best = !known ? retreat : error > 0 ? safety * std::pow(error, -1 / order) : most_growth;
  const double factor = known ? std::clamp(best, most_shrinking, most_growth) : retreat;
  if (!known || error > 1) {
    lane.h = h * std::min(factor, safety);
    lane.rejected = true;
    return;
  }
  const double planned = h * (lane.rejected ? std::min(factor, 1.0) : factor);
  if (lane.t == lane.span->start) {
    lane.span->first_step = planned;
    lane.span->tolerance = tolerance_;
  }
  lane.h = planned;
  lane.rejected = false;
  lane.t = lane.last ? lane.span->end : lane.t + h;
  accept(l);
}

void BatchDop853::accept(int l) {
  Lane& lane = lane_[l];
  if (!lane.last) {
    for (std::size_t r = 0; r < rows_; ++r) y_[r * lanes_ + l] = next_[r * lanes_ + l];
    return;
  }
  for (std::size_t r = 0; r < rows_; ++r) lane.span->final[r] = next_[r * lanes_ + l];
  lane.span->complete = true;
  lane.span = nullptr;
}

void BatchDop853::fail() {
  for (Lane& lane : lane_) lane.span = nullptr;
  waiting_.clear();
}

}  // namespace extremal
