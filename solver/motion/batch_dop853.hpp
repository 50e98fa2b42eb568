#pragma once

#include <functional>
#include <span>
#include <vector>

#include "machine/aligned.hpp"
#include "machine/deadline.hpp"
#include "motion/dop853_tableau.hpp"
#include "motion/lane_flow.hpp"

/// \file Many pieces of motion integrated by the method of Dormand and Prince, one in each lane.

namespace extremal {

/// A piece of motion.
struct MotionSpan {
  double start = 0, end = 0;
  const double* initial = nullptr;  ///< (q, p), then its variations, 2n each
  double* final = nullptr;          ///< the same at the end
  double first_step = 0;            ///< to begin with; as it was found fit, for the next time. 0: none known
  double tolerance = 0;             ///< that first_step belongs to
  bool complete = false;
  int steps = 0;
};

/// Lanes, each with its own time, step length and error control; a lane that has finished takes the
/// next span. Error and step length are those of the state without its variations.
class BatchDop853 {
 public:
  /// `flow` must outlive it.
  explicit BatchDop853(LaneFlow& flow);

  /// Integrates every span, with `columns` variations each, to an error of a step relative to the largest |q|
  /// and |p|. False if one could not be completed. `most_steps` is for each span.
  bool run(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps,
           const Deadline& deadline = {});

  /// The same, but the others go on where a span cannot be completed. `more` is told how many steps lanes
  /// have taken; once it is false, no more spans are completed. Returns whether it stayed true.
  bool run_each(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps,
                const std::function<bool(int steps)>& more);

  int steps() const { return steps_; }  ///< of all lanes together, in all

 private:
  struct Lane {
    MotionSpan* span = nullptr;
    double t = 0, h = 0;  ///< h: as planned
    bool last = false;    ///< the step being taken ends the span
    bool rejected = false;
  };
  void begin(std::span<MotionSpan> spans, int columns, double tolerance, int most_steps);
  int advance(int columns);
  void take_span(int l);
  void choose_first_steps();
  void plan_steps();
  void step(int columns);
  void judge();
  bool judge_lane(int l, double error);
  void accept(int l);
  void stop();
  bool under_way() const;
  void list(const dop853::Row<double>& row, std::vector<LaneStage>& stages) const;

  LaneFlow& flow_;
  const LaneKernels& kernels_;
  const int lanes_ = simd_lanes();
  Lane lane_[most_lanes];
  std::vector<MotionSpan*> waiting_;  ///< the next one last
  AlignedDoubles y_, next_, k_, t_, h_, stage_t_, sums_;
  std::vector<LaneStage> stages_, others_;
  std::size_t rows_ = 0;
  double tolerance_ = 0;
  int most_steps_ = 0, steps_ = 0;
  bool each_ = false;    ///< others go on where a span fails
  bool failed_ = false;  ///< a span could not be completed
};

}  // namespace extremal
