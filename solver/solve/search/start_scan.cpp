#include "solve/search/start_scan.hpp"

#include <algorithm>
#include <cmath>

#include "motion/dop853.hpp"
#include "motion/point.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::start_scan;

namespace {

/// The momentum that is given at an end left free; zero at a natural one.
double momentum_at(const Problem& problem, std::size_t end) {
  return problem.boundary.momenta.empty() ? 0 : problem.boundary.momenta[end];
}

}  // namespace

StartScan::StartScan(const Problem& problem) : problem_(problem) {
  const EndMap& ends = problem.ends;
  // Each end has a condition of its own: none is coupled to the other.
  const bool apart = ends.fixed.size() == 2 && ends.free == 2 - (ends.fixed[0] + ends.fixed[1]);
  usable_ = problem.coordinates() == 1 && problem.has_ends() && apart && ends.free > 0 &&
            !problem.duration.free && !problem.initial && !problem.paired && !problem.manifold &&
            !problem.phase && problem.boundary.costs.empty() && Flow::suits(*problem.lagrangian);
  if (usable_) flow_.emplace(*problem.lagrangian);
}

double StartScan::unknown(State start) {
  if (!problem_.ends.fixed[0]) return start.q;
  double p = NAN;
  return flow_->momentum({&start.q, 1}, {&start.v, 1}, 0, {&p, 1}) ? p : NAN;
}

std::optional<StartScan::State> StartScan::state(double w) {
  const bool fixed = problem_.ends.fixed[0] != 0;
  State start{fixed ? problem_.ends.offset[0] : w, 0};
  const double p = fixed ? w : momentum_at(problem_, 0);
  if (!flow_->velocity({&start.q, 1}, {&p, 1}, 0, {&start.v, 1}) || !std::isfinite(start.v))
    return std::nullopt;
  return start;
}

StartScan::Sample StartScan::sample(double w) {
  const bool fixed = problem_.ends.fixed[0] != 0;
  double y[] = {fixed ? problem_.ends.offset[0] : w, fixed ? w : momentum_at(problem_, 0)};
  DormandPrince<double> method([this](double t, std::span<const double> x,
                                      std::span<double> slope) { return flow_->slope(t, x, slope); },
                               2);
  IntegrationOptions options;
  options.tolerance = step_error;
  options.block = 1;
  options.max_steps = most_integrator_steps;
  double t = 0;
  const Integrated result = method.advance(t, y, problem_.duration.value, options);
  more_(method.steps() + method.rejected());
  if (result != Integrated::done) return {w, NAN};
  return {w, problem_.ends.fixed[1] ? y[0] - problem_.ends.offset[1] : y[1] - momentum_at(problem_, 1)};
}

/// The zero between two samples of other signs, by bisection and the secant in turn.
void StartScan::enclose(Sample a, Sample b, std::vector<double>& found) {
  const double width = std::abs(b.w - a.w), size = std::max(std::abs(a.miss), std::abs(b.miss));
  for (int k = 0; k < most_sections && more_(0); ++k) {
    const double part = k % 2 == 0 ? a.miss / (a.miss - b.miss) : 0.5;
    const Sample middle = sample(a.w + part * (b.w - a.w));
    // Next to rest a step's error by the momentum may be too large for the integrator.
    if (!std::isfinite(middle.miss)) {
      const Sample& best = std::abs(a.miss) < std::abs(b.miss) ? a : b;
      if (std::abs(best.miss) <= nearly_met * size) found.push_back(best.w);
      return;
    }
    ((middle.miss < 0) == (a.miss < 0) ? a : b) = middle;
    if (std::abs(middle.miss) <= met * size || std::abs(b.w - a.w) <= met * width) {
      // A pole or a jump changes the sign too.
      if (std::abs(middle.miss) <= size) found.push_back(middle.w);
      return;
    }
  }
}

/// Samples that the mean of their neighbours tells are dense enough.
void StartScan::divide(const Sample& a, const Sample& b, int halvings, std::vector<double>& found) {
  if (!more_(0)) return;
  if (halvings > 0) {
    const Sample middle = sample(0.5 * (a.w + b.w));
    const double mean = 0.5 * (a.miss + b.miss);
    const double size = std::max(std::abs(a.miss), std::abs(b.miss));
    if (!(std::abs(middle.miss - mean) <= straight * size)) {
      divide(a, middle, halvings - 1, found);
      divide(middle, b, halvings - 1, found);
      return;
    }
  }
  if (std::isfinite(a.miss) && std::isfinite(b.miss) && (a.miss < 0) != (b.miss < 0)) enclose(a, b, found);
}

bool StartScan::zeros(double from, double to, const std::function<bool(int steps)>& more,
                      std::vector<double>& found) {
  more_ = more;
  Sample last = sample(from);
  for (int k = 1; k <= samples && more(0); ++k) {
    const Sample next = sample(from + (to - from) * k / samples);
    divide(last, next, most_halvings, found);
    last = next;
  }
  return more(0);
}

}  // namespace extremal
