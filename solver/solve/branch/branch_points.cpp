#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "solve/branch/continuation.hpp"
#include "solve/branch/root.hpp"
#include "solve/periodic/doubled_orbit.hpp"
#include "solve/periodic/stability.hpp"

/// \file Where other branches cross on a step, and where orbits of twice the period begin.

namespace extremal {

namespace {

constexpr int most_trials = 80, most_crossings = 8;
/// Responses on either side of a crossing point opposite ways, to a cosine of this.
constexpr double opposite = -0.9;
/// Beyond a crossing, by so much of the step, the next one is sought.
constexpr double beyond_it = 1e-4;
/// From a seed to the crossing.
constexpr double seed_distance = 1e-4;

double product(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 1.0, std::multiplies());
}

}  // namespace

/// One end of the interval that holds a crossing.
struct Continuation::Side {
  double at = 0, weight = 1;
  Move response = {};
  double size = 0;  ///< of the response; 0: not known
};

/// A crossing, or, where the equations are too singular there, a point next to it: what varies is then
/// interpolated by the cubic through points on either side.
std::optional<BranchPoint> Continuation::crossing_at(const Stand& from, double at, double length) {
  if (stays(from, at)) return read(PointKind::branch);
  for (const double share : {1e-7, 1e-5, 1e-3, 1e-2, 3e-2, 0.1}) {
    const double off = share * length;
    if (!stays(from, at + off)) continue;
    const Stand after = here_;
    if (!stays(from, at - off) || !differs(here_, after)) continue;
    BranchPoint point = read(PointKind::branch);
    point.parameter = 0.5 * (here_.varied + after.varied) - 0.25 * off * (after.rate - here_.rate);
    return point;
  }
  return std::nullopt;
}

/// Between low, where the branch is as `before`, and high. `response` is that next to it: at it, there may be
/// none. NaN where the branch cannot be followed.
double Continuation::find_crossing(const Stand& from, const Stand& before, double low, double high,
                                   Move& response) {
  Side sides[2] = {{.at = low}, {.at = high}};
  const double at = narrow(from, before, sides);
  response = std::move(sides[sides[0].size > sides[1].size ? 0 : 1].response);
  return response.step.nodes.empty() ? NAN : at;
}

/// By halves as the orientation tells, then by the secant of ±1/|response|, which passes zero at a crossing.
double Continuation::narrow(const Stand& from, const Stand& before, Side (&sides)[2]) {
  Move response;
  double last = sides[0].at, best = NAN;
  bool lower_before = false, balanced = false;
  std::optional<double> aside_of;
  for (int k = 0; k < most_trials; ++k) {
    const bool known = sides[0].size > 0 && sides[1].size > 0;
    const bool near =
        known && branch_.dot(sides[0].response, sides[1].response) < opposite * sides[0].size * sides[1].size;
    const double a = near ? sides[0].weight / sides[0].size : 1,
                 b = near ? sides[1].weight / sides[1].size : 1;
    const double secant = (sides[0].at * b + sides[1].at * a) / (a + b);
    const double guess = aside_of ? *std::exchange(aside_of, std::nullopt) : secant;
    // Where the crossing lies just there, nothing can be solved.
    const double aside = near ? 0.03 : 0.3;
    if (near) best = secant;
    double at = guess;
    if (!stays(from, at, true) && !stays(from, at = guess + aside * (sides[1].at - guess), true) &&
        !stays(from, at = guess - aside * (guess - sides[0].at), true))
      return best;
    branch_.respond(here_.tangent, response);
    const double size = std::sqrt(branch_.dot(response, response));
    const bool lower = near ? branch_.dot(response, sides[0].response) > 0 : !differs(here_, before);
    // At the crossing itself the way along the other branch may count as null and be left out. The secant
    // between points as far on either side tells where that is.
    const bool gone = near && size < std::min(sides[0].size, sides[1].size);
    if (gone && !balanced) {
      balanced = true;
      const Side& nearer = at - sides[0].at < sides[1].at - at ? sides[0] : sides[1];
      aside_of = 2 * at - nearer.at;
      continue;
    }
    // Without a response that grows the index was miscounted, as it may be where elements are very unequal;
    // where both sides were known, nothing nearer can be told from roundoff.
    if (!std::isfinite(size) || size == 0 || gone || settled(at - last) || at == last)
      return near ? at : best;
    last = at;
    // The same side again: the other one counts less (Illinois).
    if (near && lower == lower_before) sides[lower ? 1 : 0].weight *= 0.5;
    sides[lower ? 0 : 1] = {at, 1, response, size};
    lower_before = lower;
  }
  return NAN;
}

/// A change of the index alone is a fold of the duration, or of what varies.
bool Continuation::differs(const Stand& a, const Stand& b) {
  return a.orientation != b.orientation || std::abs(a.index - b.index) >= 2;
}

void Continuation::find_crossings(const Stand& from, const Stand& to, double length,
                                  std::vector<Meeting>& met) {
  Stand before = from;
  double low = 0;
  for (int k = 0; k < most_crossings && differs(before, to); ++k) {
    Move response;
    const double at = find_crossing(from, before, low, length, response);
    if (!std::isfinite(at)) return;
    Stand base = from;
    double there = at;
    if (auto finer = resolved_for(from, response)) {
      const bool begins = go(*finer, low, true) && !differs(here_, before);
      const double again = begins ? find_crossing(*finer, Stand(here_), low, length, response) : NAN;
      if (begins && !std::isfinite(again)) return;  // on those elements alone
      if (begins) {
        base = *std::move(finer);
        there = again;
      }
    }
    std::optional<BranchPoint> point = crossing_at(base, there, length);
    if (!point) return;
    met.push_back({at, {*std::move(point), seed_at(PointKind::branch, base, there)}});
    low = at + beyond_it * length;
    if (!(low < length) || !go(from, low, true)) return;
    before = here_;
  }
}

/// Of the place, by multipliers as they are, however near to −1. NaN if they are not known.
std::vector<double> Continuation::read_gaps() {
  const Problem& problem = branch_.problem();
  const Trajectory trajectory = trajectory_of(here_.path);
  if (!w_.variation.assemble(problem.lagrangian, trajectory, condensed())) return {NAN};
  const std::optional<Floquet> found = floquet(w_.variation, closed_orbit(problem, trajectory, 0));
  return found ? doubling_gaps(*found) : std::vector<double>{NAN};
}

/// Where on a step gap k may pass zero twice: it keeps its sign, and would not if it went on as before, but
/// bends away from zero. Where the parabola through its last three values is level.
std::optional<double> Continuation::nearing_doubling(const Stand& from, const Stand& to, double length,
                                                     std::size_t k) {
  if (from.gaps_before.size() != from.gaps.size()) return std::nullopt;
  const double gap = from.gaps[k], change = to.gaps[k] - gap;
  const double before = (gap - from.gaps_before[k]) / from.back;
  if (!(gap * to.gaps[k] > 0 && gap * (gap + before * length) <= 0)) return std::nullopt;
  const double bend = (change / length - before) / (length + from.back);
  const double level = 0.5 * (length - change / (length * bend));
  return std::clamp(level, 0.1 * length, 0.9 * length);
}

bool Continuation::may_double(const Stand& from, const Stand& to, double length) {
  if (from.gaps.size() != to.gaps.size()) return changes_sign(product(from.gaps), product(to.gaps));
  for (std::size_t k = 0; k < from.gaps.size(); ++k)
    if (changes_sign(from.gaps[k], to.gaps[k]) || nearing_doubling(from, to, length, k)) return true;
  return false;
}

/// Gap by gap, in their order; of all together where pairs have met or parted.
void Continuation::find_doublings(const Stand& from, const Stand& to, double length,
                                  std::vector<Meeting>& met) {
  const bool same = from.gaps.size() == to.gaps.size();
  const std::size_t count = same ? from.gaps.size() : 1;
  for (std::size_t k = 0; k < count; ++k) {
    const auto of = [&](const std::vector<double>& gaps) {
      return same && gaps.size() == count ? gaps[k] : product(gaps);
    };
    const auto gap = [&] { return of(read_gaps()); };
    std::vector<Reading> places = {{0, of(from.gaps)}, {length, of(to.gaps)}};
    if (const auto level = same ? nearing_doubling(from, to, length, k) : std::nullopt)
      if (const auto between = dip(from, places[0], places[1], *level, gap))
        places.insert(places.begin() + 1, *between);
    std::optional<Reading> before;
    if (from.back > 0) before = {-from.back, of(from.gaps_before)};
    find_roots(from, places, before, gap, [&](double at) {
      BranchPoint point = read(PointKind::period_doubling);
      met.push_back({at, {std::move(point), seed_at(PointKind::period_doubling, from, at)}});
    });
  }
}

std::optional<Seed> Continuation::seed_at(PointKind kind, const Stand& from, double at) {
  if (!options_.seeds) return std::nullopt;
  if (!go(from, at - seed_distance) && !go(from, at + seed_distance)) return std::nullopt;
  Seed seed{kind, here_.path, here_.coordinate, here_.units};
  if (kind == PointKind::branch) return seed;
  double_path(branch_.problem(), here_.path, branch_.tables(), seed.path);
  seed.units.duration *= 2;
  if (family_.varied != Varied::parameter) seed.coordinate *= 2;
  return seed;
}

}  // namespace extremal
