#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/guess/first_path.hpp"
#include "solve/search/distinct.hpp"
#include "solve/search/from_motions.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/several.hpp"

/// \file Other extremals from the motions that leave the start.

namespace extremal {

using namespace limits::several;

/// Of the extremals of least action, as many as are wanted.
double Several::wanted_reach(double least, const std::function<double(const Solution&)>& reach_of) const {
  std::vector<std::pair<double, double>> reaches;
  for (const Solution& s : found_) reaches.emplace_back(s.action, reach_of(s));
  std::ranges::sort(reaches);
  double reach = least;
  for (std::size_t k = 0; k < std::min<std::size_t>(reaches.size(), most_); ++k)
    reach = std::max(reach, reaches[k].second);
  return reach;
}

double Several::wanted_reach() {
  return wanted_reach(motions_.least_reach(scale_),
                      [this](const Solution& s) { return motions_.reach_of(s); });
}

/// Extremals found.
int Several::within(double reach) {
  return static_cast<int>(std::count_if(found_.begin(), found_.end(),
                                        [&](const Solution& s) { return motions_.reach_of(s) <= reach; }));
}

/// Whether the path, which a homotopy has led to the problem, is nearly an extremal that was found.
bool Several::reaches_known() {
  Solution candidate;
  candidate.trajectory = trajectory_of(path_);
  candidate.error_estimate = led * scales(path_, pursuit_.tables()).q;
  return find([&](const Solution& other) {
           return same_path(candidate, other, options_.tolerance, scale_);
         }) >= 0;
}

/// Tells whether integrators may take so many more steps. A scan may take this part of all, counted from
/// here.
std::function<bool(int)> Several::scan_budget(double part) {
  const auto most = static_cast<long>(part * most_scan_steps);
  scan_steps_ = 0;
  return [this, most, deadline = options_.deadline.share(part * arrivals_share)](int steps) {
    scan_steps_ += steps;
    return scan_steps_ < most && !deadline.passed();
  };
}

/// All motions that meet the end, of growing reach, until enough are found or no more seem to be in reach.
/// Whether none seems to be missing.
bool Several::trace_arrivals() {
  const std::function<bool(int)> more = scan_budget();
  double nearest = motions_.slowest();
  double farthest = reach_beyond * std::max(wanted_reach(), nearest);
  bool all_complete = true;
  for (int growths = 0; growths < most_growths;) {
    const std::size_t before = found_.size();
    const bool complete = motions_.all(nearest, farthest, more, [&](const Guess& motion, double duration) {
      pursuit_.renew(patience);
      ++scanned_;
      if (refine_motion(pursuit_, guess_, motion, duration, from_arrival)) keep();
    });
    if (!more(0) || (!complete && found_.size() == before)) return false;
    all_complete = all_complete && complete;
    const bool enough = static_cast<int>(found_.size()) >= most_;
    nearest = farthest;
    if (enough && farthest >= wanted_reach()) return all_complete;
    farthest = enough ? reach_beyond * wanted_reach() : farthest * growth_of_arrivals;
    growths = found_.size() > before ? 0 : growths + 1;
  }
  return all_complete;
}

/// Starts as far away and as fast as the guess suggests.
StartScan::Shell Several::first_starts() {
  return starts_.around(guess_.ends(), scale_, guess_.phase() * scale_ / problem_.duration.value);
}

/// Whether the first box of starts holds no motion that is hard to follow.
bool Several::even_starts() {
  if (!starts_.usable()) return false;
  StartScan::Shell shell = first_starts();
  shell.farthest = reach_beyond;
  return shell.state_unit.minCoeff() > 0 && shell.state_unit.allFinite() &&
         starts_.even(shell, scan_budget());
}

/// All motions from starts within a reach that grows until enough are found or no more seem to be in reach.
/// Whether none seems to be missing: one may be where a motion that meets the end leads to no extremal.
bool Several::scan_starts() {
  const std::function<bool(int)> more = scan_budget();
  StartScan::Shell shell = first_starts();
  if (!(shell.state_unit.minCoeff() > 0) || !shell.state_unit.allFinite()) return false;
  const auto reach_of = [&](const Solution& s) {
    const auto n = static_cast<std::size_t>(problem_.coordinates());
    std::vector<double> q(n), v(n);
    s.trajectory.at(0, q, v);
    const double reach = shell.reach(starts_.unknown(q, v));
    return std::isfinite(reach) ? reach : 0;
  };
  // Of two dimensions a box grows by less at a time, as its area would grow too fast, but as far in all.
  const auto dimension = static_cast<int>(shell.unit.size());
  const double growth = std::pow(growth_of_arrivals, 1.0 / dimension);
  shell.nearest = 0;
  shell.farthest = reach_beyond * wanted_reach(1, reach_of);
  // Where motions are cheap, as those of slow starts, the next extremal may be far.
  long steps_before = scan_steps_;
  const auto cheap = [&](int steps) { return more(steps) && scan_steps_ - steps_before <= most_quiet_steps; };
  bool all_led = true;
  for (int growths = 0; growths < most_growths * dimension || (growths < most_cheap_growths && cheap(0));) {
    const bool near = growths < most_growths * dimension;
    std::vector<Eigen::VectorXd> zeros;
    const bool complete = starts_.zeros(shell, near ? more : cheap, zeros);
    const std::size_t before = found_.size();
    std::ranges::sort(zeros, {}, [&](const Eigen::VectorXd& w) { return shell.reach(w); });
    for (const Eigen::VectorXd& w : zeros) {
      const std::optional<StartScan::State> start = starts_.state(w);
      if (!start) continue;
      const Guess motion = motion_from(*problem_.lagrangian, start->q, start->v, problem_.duration.value,
                                       limits::from_motions::step_error, [] { return true; });
      pursuit_.renew(patience);
      ++scanned_;
      const bool led =
          motion.given() && refine_motion(pursuit_, guess_, motion, problem_.duration.value, from_start);
      all_led = (led && keep() >= 0) && all_led;
    }
    // Beyond the last extremals it has been looked in vain.
    if (!complete) return growths > 0 && all_led;
    const bool news = found_.size() > before;
    growths = news ? 0 : growths + 1;
    if (news) steps_before = scan_steps_;
    const bool enough = static_cast<int>(found_.size()) >= most_;
    const double wanted = starts_beyond * wanted_reach(1, reach_of);
    shell.nearest = shell.farthest;
    if (enough && shell.farthest >= wanted) break;
    shell.farthest = enough ? std::min(wanted, shell.farthest * growth) : shell.farthest * growth;
  }
  return all_led;
}

/// From motions that nearly close. False if none leads to an orbit.
bool Several::scan_openings() {
  const ElementTables& tables = pursuit_.open(guess_.mesh(), Refinement::first_degree);
  start_path(problem_, guess_.ends(), tables, path_);
  const double frequency = guess_.phase() / problem_.duration.value;
  if (!closing_.around(guess_.ends(), extents(path_, negligible_extent[0]), frequency)) return false;
  const std::function<bool(int)> more = scan_budget(openings_share);
  const int dimensions = closing_.dimensions();
  const auto wanted = [this] {
    return reach_beyond * wanted_reach(1, [this](const Solution& s) { return closing_.reach_of(s); });
  };
  const auto visit = [this](const Guess& motion) {
    pursuit_.renew(share_of_motion);
    ++scanned_;
    if (refine_open_motion(pursuit_, guess_, motion, from_open_motion)) keep();
  };
  const double growth = std::pow(growth_of_arrivals, 1.0 / dimensions);
  auto across = static_cast<int>(std::round(std::pow(first_points, 1.0 / dimensions)));
  double nearest = 0, farthest = wanted();
  for (int growths = 0; growths < growths_in_vain * dimensions;) {
    const std::size_t before = found_.size();
    if (!closing_.all(nearest, farthest, across, more, visit)) return !found_.empty();
    const bool enough = static_cast<int>(found_.size()) >= most_;
    if (enough && farthest >= wanted()) break;
    nearest = farthest;
    farthest = enough ? wanted() : farthest * growth;
    growths = found_.size() > before ? 0 : growths + 1;
  }
  // As long as denser starts lead to more.
  for (std::size_t before = 0; found_.size() > before;) {
    before = found_.size();
    across *= 2;
    if (!closing_.all(0, wanted(), across, more, visit)) break;
  }
  return !found_.empty();
}

/// Motions to where no extremal between those wanted is likely to be missing; where there are too few, to
/// where none is likely to be in reach.
void Several::scan() {
  pursuit_.renew(patience);
  double reach = reach_beyond * wanted_reach();
  for (int growths = 0, quiet = 0, astray = 0;
       scanned_ < most_motions_each * most_ && !pursuit_.exhausted() && !options_.deadline.passed();) {
    const int known = within(reach);
    if (quiet >= std::max(least_motions, motions_each * known) ||
        astray >= most_astray * std::max(1, known)) {
      if (static_cast<int>(found_.size()) >= most_ || growths++ == most_growths) return;
      reach *= growth_of_reach;
      quiet = astray = 0;
    }
    ++scanned_;
    ++astray;
    if (!motions_.next(reach)) continue;
    astray = 0;
    ++quiet;
    if (reaches_known()) continue;
    const std::size_t before = found_.size();
    refine_and_keep(pursuit_.tables(), from_motion);
    if (found_.size() == before) continue;
    const bool enough = static_cast<int>(found_.size()) >= most_;
    reach = std::max(reach_beyond * wanted_reach(), enough ? 0 : reach);
    quiet = 0;
  }
}

}  // namespace extremal
