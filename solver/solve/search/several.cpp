#include "solve/search/several.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/homotopy/duration_homotopy.hpp"
#include "solve/homotopy/end_homotopy.hpp"
#include "solve/newton/ends.hpp"
#include "solve/periodic/repetition.hpp"
#include "solve/periodic/stability.hpp"
#include "solve/search/deflation.hpp"
#include "solve/search/distinct.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::several;

namespace {

using Clock = std::chrono::steady_clock;

/// Noise of growing size and of few modes and many.
Bend bend_of(unsigned seed) {
  constexpr double sizes[] = {0.1, 0.3, 0.6, 1, 1.8};
  constexpr int modes[] = {3, 1, 5, 2, 8, 3, 12};
  return {sizes[seed % std::size(sizes)], seed, modes[seed % std::size(modes)]};
}

/// First about the origin of the coordinates, then about points by the ends.
Arc arc_of(unsigned seed, const std::vector<double>& ends) {
  constexpr int turns[] = {-1, 1, -2, 2, 0, -3, 3};
  constexpr double excesses[] = {0, 0.5, -0.4, 1};
  const std::size_t n = ends.size() / 2;
  const unsigned round = seed / std::size(turns);
  Arc arc{std::vector<double>(n, 0), turns[seed % std::size(turns)], excesses[round % std::size(excesses)]};
  if (round < std::size(excesses)) return arc;
  double extent = 0;
  for (double x : ends) extent = std::max(extent, std::abs(x));
  Noise noise(round);
  for (std::size_t a = 0; a < n; ++a) arc.centre[a] = (ends[a] + ends[n + a]) / 2 + extent * noise();
  return arc;
}

}  // namespace

Several::Several(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem),
      options_(options),
      w_(workspace),
      search_(problem, options, workspace),
      path_(search_.path()),
      loops_(problem, options, workspace, search_),
      motions_(problem, search_),
      starts_(problem) {}

/// Whether an orbit is one of a shorter period, run through several times. One that a symmetry of L closes
/// after m segments may repeat itself after any number of these.
bool Several::repeats(const Solution& candidate) const {
  if (!problem_.periodic || !problem_.lagrangian->structure().autonomous) return false;
  const ClosingMap map = closing_map(problem_);
  const int segments = segments_to_close(map);
  if (segments == 0) return false;
  const double size = scales(path_, *search_.outcome().tables).q;
  const int parts = repetitions(candidate.trajectory, map, segments, distinct_distance(candidate, size));
  return parts == 0 || segments % parts != 0;
}

/// The number of the extremal that the search found, which is added if it is new; -1 if it is none.
int Several::keep() {
  Solution candidate;
  candidate.trajectory = trajectory_of(path_);
  candidate.error_estimate = search_.outcome().error;
  const bool held = search_.outcome().shifts_held;
  if (held) candidate.error_estimate = held_apart * scales(path_, search_.tables()).q;
  const int number =
      find([&](const Solution& other) { return same_path(candidate, other, options_.tolerance, scale_); });
  if (number >= 0) return number;
  candidate = accept(problem_, options_, search_.outcome(), w_);
  analysing_ += candidate.seconds_analyse;
  return candidate.converged() ? add(std::move(candidate), held) : -1;
}

/// The same for a solution that was accepted. Those whose shifts are `held` are members of a continuum each,
/// but all of them were shifted to where energies agree.
int Several::add(Solution candidate, bool held) {
  candidate.seconds_solve = std::chrono::duration<double>(Clock::now() - start_).count() - analysing_;
  if (repeats(candidate)) {
    if (!repeating_) repeating_ = std::move(candidate);
    return -1;
  }
  const bool closed = problem_.periodic && problem_.lagrangian->structure().autonomous;
  const bool adrift = !problem_.periodic && problem_.boundary.rows == 0 && problem_.boundary.momenta.empty();
  const int number = find([&](const Solution& other) {
    return closed   ? same_orbit(candidate, other, options_.tolerance)
           : adrift ? same_but_for_place(*problem_.lagrangian, candidate, other, options_.tolerance)
                    : !held && same_continuum(candidate, other, options_.tolerance);
  });
  if (number >= 0) return number;
  found_.push_back(std::move(candidate));
  traced_.emplace_back(families_, 0);
  search_.renew(patience);
  in_vain_ = returns_ = 0;
  if (static_cast<int>(found_.size()) == most_) enough_at_ = seed_;
  return static_cast<int>(found_.size()) - 1;
}

int Several::refine_and_keep(const ElementTables& tables, const char* strategy) {
  meet_ends(problem_, path_);
  return search_.refine(tables, strategy) ? keep() : -1;
}

/// The largest |q| along the guess, or 1 where that is zero.
double Several::size_of_guess() {
  const ElementTables& tables = search_.open(search_.mesh(), Refinement::first_degree);
  start_path(problem_, search_.ends(), tables, path_);
  const double size = scales(path_, tables).magnitude;
  return size > 0 ? size : 1;
}

/// Again from the guess as long as that leads to another.
void Several::deflate() {
  DeflatedNewton newton(problem_, path_, w_, [this] { return search_.count_step(); });
  while (wanted()) {
    const ElementTables& tables = search_.open(search_.mesh(), family_degree);
    start_path(problem_, search_.ends(), tables, path_);
    const std::size_t before = found_.size();
    if (!newton.run(tables, found_)) return;
    refine_and_keep(tables, "deflated newton from the guess");
    if (found_.size() == before) return;
  }
}

void Several::guess() {
  const unsigned most = loops_.usable() ? loops : guesses;
  for (unsigned k = 0; k < most && wanted(); ++k, ++seed_, ++in_vain_) {
    if (loops_.usable()) {
      if (loops_.next()) {
        const std::size_t before = found_.size();
        const bool orbit = keep() >= 0;
        if (orbit) loops_.credit();
        if (orbit && found_.size() == before) ++returns_;
      }
      search_.renew();
      continue;
    }
    bend();
    if (problem_.coordinates() > 1 && wanted()) wind();
  }
}

/// Downhill from the guess. Saddles are left both ways along their direction of most negative curvature: a
/// symmetric one for a pair of extremals of less action.
void Several::descend() {
  int arrived = 0;
  const auto take = [&](bool minimum) {
    if (minimum) keep();
    arrived += minimum;
  };
  if (descended_ == 0)
    for (double side : {1.0, -1.0}) take(search_.descend_from_guess(side));
  for (int saddles = 0; descended_ < found_.size() && saddles < most_saddles && !search_.exhausted() &&
                        !options_.deadline.passed();
       ++descended_) {
    if (found_[descended_].morse_index.value_or(0) == 0) continue;
    ++saddles;
    const Trajectory saddle = found_[descended_].trajectory;
    for (double side : {-1.0, 1.0}) take(search_.descend_from(saddle, side));
    // The action has no minimum, it seems.
    if (arrived == 0) return;
  }
}

void Several::bend() {
  const Bend bend = bend_of(seed_);
  const ElementTables& tables = search_.open(search_.mesh(), Refinement::first_degree);
  start_path(problem_, moved_ends(problem_, search_.ends(), bend.size, seed_), tables, path_);
  bend_path(problem_, bend, tables, path_);
  refine_and_keep(tables, "newton from the guess plus smooth noise");
}

/// A duration in which the action of an arc is stationary against its radius: forces bend it about as much as
/// it is bent. That which is wanted where there is none.
double Several::natural_duration(Arc arc, const ElementTables& tables) {
  constexpr int octaves = 6, steps = 4;  // either side, steps each
  constexpr double small = 1e-3;
  const double excess = arc.excess;
  const auto duration = [&](double k) {
    return problem_.duration.value * std::pow(2.0, k / steps - octaves);
  };
  std::vector<double> slope(2 * octaves * steps + 1, 0);
  for (double side : {-1, 1}) {
    arc.excess = excess + side * small;
    arc_path(arc, search_.ends(), tables, path_);
    for (std::size_t k = 0; k < slope.size(); ++k) {
      path_.set_duration(duration(static_cast<double>(k)));
      w_.iteration.action().evaluate_plain(path_);
      slope[k] += side * w_.iteration.action().action();
    }
  }
  for (std::size_t k = 0; k + 1 < slope.size(); ++k)
    if (slope[k] * slope[k + 1] < 0)
      return duration(static_cast<double>(k) + slope[k] / (slope[k] - slope[k + 1]));
  return problem_.duration.value;
}

/// An arc of a circle run through in its natural duration; from there through extremals with ends between,
/// and then through those of durations between.
void Several::wind() {
  constexpr const char* strategy = "homotopy from an arc of a circle";
  const auto count = [this] { return search_.count_step(); };
  const Arc arc = arc_of(seed_, search_.ends());
  const std::vector<double> mesh = uniform_mesh(elements_a_turn * std::max(1, std::abs(arc.turns)));
  const ElementTables& tables = search_.open(mesh, family_degree);
  const bool autonomous = problem_.lagrangian->structure().autonomous;
  const double duration = autonomous ? natural_duration(arc, tables) : problem_.duration.value;
  EndHomotopy ends(problem_, path_, w_, count, arc_path(arc, search_.ends(), tables, path_), 1);
  path_.set_duration(duration);
  if (!ends.trace(tables, 1)) return;
  meet_ends(problem_, path_);
  DurationHomotopy durations(problem_, path_, w_, count);
  if (problem_.duration.free || !autonomous || durations.trace(tables)) refine_and_keep(tables, strategy);
}

/// Makes the path a solution, on the elements of a family.
void Several::load(const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  const std::size_t n = trajectory.coordinates;
  const ElementTables& tables = w_.levels.at(family_degree);
  std::vector<double> mesh;
  for (double t : trajectory.times) mesh.push_back(t / trajectory.duration());
  path_.reset(tables, mesh, trajectory.duration());
  std::vector<double> q((family_degree + 1) * n), v(n);
  for (int k = 0; k < trajectory.elements(); ++k) {
    const double from = trajectory.times[k], h = trajectory.times[k + 1] - from;
    for (int j = 0; j <= family_degree; ++j)
      trajectory.at(std::min(from + tables.scheme().lobatto[j] * h, trajectory.duration()),
                    {q.data() + j * n, n}, v);
    path_.set_element(k, q.data());
  }
  path_.load_ends();
}

/// The family number 0 is that of other durations, the next those of other values in each row of the boundary
/// relation. From the extremal that the path is; null if it cannot be left.
std::unique_ptr<Homotopy> Several::leave(int family, bool onward) {
  const auto count = [this] { return search_.count_step(); };
  const ElementTables& tables = w_.levels.at(family_degree);
  if (family == 0) {
    auto curve = std::make_unique<DurationHomotopy>(problem_, path_, w_, count);
    if (curve->leave(tables, onward)) return curve;
  } else {
    const double extent = scales(path_, tables).q;
    auto curve = std::make_unique<EndHomotopy>(problem_, path_, w_, count,
                                               unit_displacement(problem_.boundary, family - 1), extent);
    if (curve->leave(tables, onward)) return curve;
  }
  return nullptr;
}

/// All extremals that the family comes by, both ways; of those it need not be traced again.
void Several::trace_family(std::size_t solution, int family) {
  const char* strategy =
      family == 0 ? "family of extremals of other durations" : "family of extremals with other ends";
  for (bool onward : {false, true}) {
    load(found_[solution]);
    const std::unique_ptr<Homotopy> curve = leave(family, onward);
    for (int met = 0; curve && wanted() && curve->reach(); ++met) {
      const int number = refine_and_keep(w_.levels.at(family_degree), strategy);
      if (number >= 0) traced_[number][family] = 1;
      if (number == static_cast<int>(solution) && met > 0) return;  // a closed curve
      curve->resume();
    }
  }
}

/// The next family of the first extremal that has one; false if all have been traced.
bool Several::trace_families() {
  const bool durations = !problem_.duration.free && problem_.lagrangian->structure().autonomous;
  for (int family = durations ? 0 : 1; family < families_; ++family)
    for (std::size_t k = 0; k < found_.size(); ++k)
      if (!traced_[k][family]) {
        traced_[k][family] = 1;
        ++traced_count_;
        trace_family(k, family);
        return true;
      }
  return false;
}

/// Whether loops come back to known orbits as often as they would if no more of the wanted were missing.
bool Several::returns_suffice() const {
  if (!loops_.usable()) return true;
  return returns_ >= returns_each * static_cast<int>(found_.size()) ||
         seed_ >= (1 + spare_loops) * enough_at_;
}

bool Several::wanted() const {
  return !(static_cast<int>(found_.size()) >= most_ && returns_suffice()) &&
         in_vain_ < (loops_.usable() ? most_loops_in_vain : most_in_vain) && !search_.exhausted();
}

/// Of the extremals of least action, as many as are wanted.
double Several::wanted_reach() const {
  std::vector<std::pair<double, double>> reaches;
  for (const Solution& s : found_) reaches.emplace_back(s.action, motions_.reach_of(s));
  std::sort(reaches.begin(), reaches.end());
  double reach = motions_.least_reach(scale_);
  for (std::size_t k = 0; k < std::min<std::size_t>(reaches.size(), most_); ++k)
    reach = std::max(reach, reaches[k].second);
  return reach;
}

/// Extremals found.
int Several::within(double reach) const {
  return static_cast<int>(std::count_if(found_.begin(), found_.end(),
                                        [&](const Solution& s) { return motions_.reach_of(s) <= reach; }));
}

/// Whether the path, which a homotopy has led to the problem, is nearly an extremal that was found.
bool Several::reaches_known() {
  Solution candidate;
  candidate.trajectory = trajectory_of(path_);
  candidate.error_estimate = led * scales(path_, search_.tables()).q;
  return find([&](const Solution& other) {
           return same_path(candidate, other, options_.tolerance, scale_);
         }) >= 0;
}

/// All motions that meet the end, of growing reach, until enough are found or no more seem to be in reach.
/// Whether that can be told.
bool Several::trace_arrivals() {
  const Deadline deadline = options_.deadline.share(arrivals_share);
  double nearest = motions_.slowest();
  double farthest = reach_beyond * std::max(wanted_reach(), nearest);
  for (int growths = 0; growths < most_growths;) {
    const std::size_t before = found_.size();
    const auto more = [&](int steps) {
      scan_steps_ += steps;
      return scan_steps_ < most_scan_steps && !deadline.passed();
    };
    const bool complete = motions_.all(nearest, farthest, more, [&](const Guess& motion, double duration) {
      search_.renew(patience);
      ++scanned_;
      if (search_.refine_motion(motion, duration, from_arrival)) keep();
    });
    if (!complete) return false;
    const bool enough = static_cast<int>(found_.size()) >= most_;
    nearest = farthest;
    if (enough && farthest >= wanted_reach()) return true;
    farthest = enough ? reach_beyond * wanted_reach() : farthest * growth_of_arrivals;
    growths = found_.size() > before ? 0 : growths + 1;
  }
  return true;
}

/// All motions from starts within a reach that grows until enough are found or no more seem to be in reach.
/// Whether that can be told.
bool Several::scan_starts() {
  const Deadline deadline = options_.deadline.share(arrivals_share);
  const auto more = [&](int steps) {
    scan_steps_ += steps;
    return scan_steps_ < most_scan_steps && !deadline.passed();
  };
  const double cycles = std::max(1.0, w_.frequency.phase());
  StartScan::Shell shell = starts_.around(search_.ends(), scale_, cycles * scale_ / problem_.duration.value);
  double known = 1;
  const auto n = static_cast<std::size_t>(problem_.coordinates());
  std::vector<double> q(n), v(n);
  for (const Solution& s : found_) {
    s.trajectory.at(0, q, v);
    const double reach = shell.reach(starts_.unknown(q, v));
    if (std::isfinite(reach)) known = std::max(known, reach);
  }
  shell.nearest = 0;
  shell.farthest = reach_beyond * known;
  if (!(shell.unit.minCoeff() > 0) || !shell.unit.allFinite()) return false;
  for (int growths = 0; growths < most_growths; shell.farthest *= growth_of_arrivals) {
    std::vector<Eigen::VectorXd> zeros;
    // Beyond the last extremals it has been looked in vain.
    if (!starts_.zeros(shell, more, zeros)) return growths > 0;
    const std::size_t before = found_.size();
    std::ranges::sort(zeros, {}, [&](const Eigen::VectorXd& w) { return shell.reach(w); });
    for (const Eigen::VectorXd& w : zeros) {
      const std::optional<StartScan::State> start = starts_.state(w);
      if (!start) continue;
      const Guess motion =
          motion_from(*problem_.lagrangian, start->q, start->v, problem_.duration.value, [] { return true; });
      search_.renew(patience);
      ++scanned_;
      if (motion.given() && search_.refine_motion(motion, problem_.duration.value, from_start)) keep();
    }
    shell.nearest = shell.farthest;
    if (static_cast<int>(found_.size()) >= most_) return true;
    growths = found_.size() > before ? 0 : growths + 1;
  }
  return true;
}

/// Motions to where no extremal between those wanted is likely to be missing; where there are too few, to
/// where none is likely to be in reach.
void Several::scan() {
  search_.renew(patience);
  double reach = reach_beyond * wanted_reach();
  for (int growths = 0, quiet = 0, astray = 0;
       scanned_ < most_motions_each * most_ && !search_.exhausted() && !options_.deadline.passed();) {
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
    refine_and_keep(search_.tables(), from_motion);
    if (found_.size() == before) continue;
    const bool enough = static_cast<int>(found_.size()) >= most_;
    reach = std::max(reach_beyond * wanted_reach(), enough ? 0 : reach);
    quiet = 0;
  }
}

/// What was done to find `all`.
std::string Several::searched(std::size_t all) const {
  std::string text =
      fmt::format("from the guess and {} {}", seed_, loops_.usable() ? "random loops" : "others");
  if (traced_count_ > 0) text += fmt::format(", along {} families", traced_count_);
  if (scanned_ > 0) text += fmt::format(", from {} motions", scanned_);
  text += fmt::format(", {} Newton steps in all", search_.outcome().iterations);
  if (options_.deadline.passed())
    text += fmt::format("; {} (solve.budget) is spent", options_.deadline.budget_text());
  const std::size_t kept = std::min<std::size_t>(all, most_);
  if (kept < static_cast<std::size_t>(most_))
    return fmt::format("{} of up to {} extremals found: no more {}; others may exist", kept, most_, text);
  return fmt::format("the {} of least action of {} extremals found {}; others may exist, also between them",
                     kept, all, text);
}

std::vector<Solution> Several::run(int most) {
  most_ = most;
  start_ = Clock::now();
  Acceptance acceptance(problem_, options_, w_);
  const Outcome& first = search_.run(&acceptance);
  const bool converged = first.status == Status::converged;
  Solution solution = acceptance.result(first);
  analysing_ = acceptance.seconds();
  const auto solving = [&] {
    return std::chrono::duration<double>(Clock::now() - start_).count() - analysing_;
  };
  solution.seconds_solve = solving();
  families_ = 1 + (problem_.periodic ? 0 : std::min(problem_.boundary.rows, most_rows));
  const bool begun = converged && add(solution) >= 0;
  std::optional<Solution> failed;
  if (!begun) failed = repeating_ ? std::move(*repeating_) : std::move(solution);
  if (!begun && !loops_.usable() && !motions_.has_curves() && !starts_.usable()) return {std::move(*failed)};
  scale_ = size_of_guess();
  if (begun) descend();
  const bool told = (most_ > 1 || !begun) &&
                    ((motions_.has_curves() && trace_arrivals()) || (starts_.usable() && scan_starts()));
  if (!told && (!found_.empty() || loops_.usable())) {
    if (begun) deflate();
    guess();
    while (wanted())
      if (!trace_families()) guess();
    descend();
  }
  if (found_.empty()) {
    if (failed->converged())
      failed->message += fmt::format(
          "; the duration is that of several turns: {} random loops led to no orbit that closes only after "
          "it",
          seed_);
    failed->seconds_solve = solving();
    return {std::move(*failed)};
  }
  if (most_ > 1 && motions_.usable() && !told) scan();
  sort_by_action(found_);
  const std::size_t all = found_.size();
  if (all > static_cast<std::size_t>(most_)) found_.resize(most_);
  if (most_ > 1) found_.front().message += "; " + searched(all);
  return std::move(found_);
}

}  // namespace extremal
