#include "motion/batch_dop853.hpp"

#include <algorithm>
#include <cmath>

#include "machine/roundoff.hpp"
#include "motion/dop853_steps.hpp"

namespace extremal {

namespace {

/// The error of a step is of this order in its length.
constexpr double order = 8;
/// So many steps before the end of a span, what is left is divided evenly.
constexpr double last_steps = 3;

int count(const std::vector<LaneStage>& stages) { return static_cast<int>(stages.size()); }

}  // namespace

BatchDop853::BatchDop853(LaneFlow& flow)
    : flow_(flow), kernels_(flow.kernels()), t_(lanes_), h_(lanes_), stage_t_(lanes_), sums_(2 * lanes_) {}

bool BatchDop853::under_way() const {
  return std::any_of(lane_, lane_ + lanes_, [](const Lane& lane) { return lane.span != nullptr; });
}

void BatchDop853::begin(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps) {
  rows_ = static_cast<std::size_t>(2 * flow_.coordinates()) * (1 + columns);
  y_.resize(rows_ * lanes_);
  next_.resize(rows_ * lanes_);
  k_.resize(rows_ * lanes_ * dop853::stages);
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
}

/// A step of all lanes; returns how many have taken one.
int BatchDop853::advance(int columns) {
  const auto taken =
      std::count_if(lane_, lane_ + lanes_, [](const Lane& lane) { return lane.span != nullptr; });
  plan_steps();
  step(columns);
  judge();
  return static_cast<int>(taken);
}

bool BatchDop853::run(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps,
                      const Deadline& deadline) {
  if (spans.empty()) return true;
  each_ = false;
  begin(spans, columns, tolerance, most_steps);
  while (under_way()) {
    advance(columns);
    if (deadline.passed()) {
      failed_ = true;
      stop();
    }
  }
  return !failed_;
}

bool BatchDop853::run_each(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps,
                           const std::function<bool(int steps)>& more) {
  for (MotionSpan& span : spans) span.complete = false;
  if (spans.empty()) return true;
  each_ = true;
  begin(spans, columns, tolerance, most_steps);
  while (under_way())
    if (!more(advance(columns))) {
      stop();
      return false;
    }
  return true;
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
    lane.h = std::max(lane.h, dop853::shortest_start * (lane.span->end - lane.t));
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

void BatchDop853::judge() {
  const int n = flow_.coordinates();
  std::fill(sums_.begin(), sums_.end(), 0.0);
  list(dop853::error5<double>, stages_);
  list(dop853::error3<double>, others_);
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
    if (!judge_lane(l, dop853::error_norm(sums_[l], sums_[lanes_ + l], h_[l], 2 * n))) {
      failed_ = true;
      if (!each_) return stop();
      lane_[l].span = nullptr;
    }
    if (!lane_[l].span && !waiting_.empty()) {
      take_span(l);
      taken = true;
    }
  }
  if (taken) choose_first_steps();
}

/// Takes or rejects the step of a lane; false if its span cannot be completed.
bool BatchDop853::judge_lane(int l, double error) {
  Lane& lane = lane_[l];
  const double h = h_[l];
  if (h <= 4 * machine_epsilon * std::abs(lane.t) || ++lane.span->steps > most_steps_) return false;
  const double factor = std::isfinite(error) ? dop853::growth(error) : dop853::retreat;
  if (!std::isfinite(error) || error > 1) {
    lane.h = h * std::min(factor, dop853::safety);
    lane.rejected = true;
    return true;
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
  return true;
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

void BatchDop853::stop() {
  for (Lane& lane : lane_) lane.span = nullptr;
  waiting_.clear();
}

}  // namespace extremal
