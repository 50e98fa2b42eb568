#include "solve/search/start_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "linear/dense.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/state_motion.hpp"

namespace extremal {

using namespace limits::start_scan;
using namespace limits::scanned_motions;

namespace {

using Vector = StartScan::Vector;

/// Of the finest lattice, in a cell: middles of the smallest cells are on it.
constexpr std::int64_t finest = std::int64_t{2}
                                << std::max(halvings_in_one, halvings_in_two + further_halvings);

/// Whether isolated motions meet the ends in the given duration: a closed orbit's other phases do as well.
bool has_isolated_motions(const Problem& problem) {
  const Lagrangian& lagrangian = *problem.lagrangian;
  return !problem.infinite && !(problem.periodic && lagrangian.structure().autonomous) &&
         !problem.duration.free && !problem.initial && !problem.paired && !problem.manifold &&
         !problem.phase && problem.boundary.costs.empty() && Flow::suits(lagrangian);
}

}  // namespace

StartScan::StartScan(const Problem& problem)
    : problem_(problem),
      n_(problem.coordinates()),
      cost_(problem.lagrangian->structure().quadratic ? 1 : implicit_cost) {
  if (n_ > most_unknowns || !has_isolated_motions(problem)) return;
  conditions_.emplace(problem);
  unknowns_ = conditions_->unknowns();
  if (unknowns_ < 1 || unknowns_ > most_unknowns) {
    conditions_.reset();
    return;
  }
  flow_.emplace(*problem.lagrangian);
  lane_flow_.emplace(*problem.lagrangian);
  integrator_.emplace(*lane_flow_);
  cells_ = unknowns_ == 1 ? cells_in_one : cells_in_two;
}

double StartScan::Shell::reach(const Vector& w) const {
  return ((w - centre).array() / unit.array()).abs().maxCoeff();
}

/// Of a momentum, by a velocity of that size, or smaller where it has a bound.
double StartScan::momentum_unit(std::span<const double> q, int coordinate, double speed) {
  std::vector<double> v(n_, 0);
  Vector rest(n_), p(n_);
  if (!flow_->momentum(q, v, 0, span_of(rest))) return NAN;
  for (double part = 1; part > least_part; part /= 2) {
    v[coordinate] = part * speed;
    if (flow_->momentum(q, v, 0, span_of(p)) && p.allFinite())
      return std::abs(p[coordinate] - rest[coordinate]) / part;
  }
  return NAN;
}

StartScan::Shell StartScan::around(std::span<const double> ends, double extent, double speed) {
  const std::span<const double> q = ends.first(n_);
  const Vector rest = unknown(q, std::vector<double>(n_, 0));
  Vector unit = Vector::Constant(2 * n_, extent);
  for (int a = 0; a < n_; ++a) unit[n_ + a] = momentum_unit(q, a, speed);
  Shell shell{rest, conditions_->unknown(unit), unit, 0, 1};
  return shell;
}

Vector StartScan::unknown(std::span<const double> q, std::span<const double> v) {
  Vector y(2 * n_);
  std::ranges::copy(q, y.begin());
  if (!flow_->momentum(q, v, 0, span_of(y).subspan(n_))) y.tail(n_).setConstant(NAN);
  return conditions_->unknown(y);
}

std::optional<StartScan::State> StartScan::state(const Vector& w) {
  Vector y = conditions_->start(w);
  State state{{y.begin(), y.begin() + n_}, std::vector<double>(n_, 0)};
  if (!flow_->velocity(state.q, span_of(y).subspan(n_), 0, state.v)) return std::nullopt;
  if (!std::ranges::all_of(state.v, [](double x) { return std::isfinite(x); })) return std::nullopt;
  return state;
}

/// Of samples.
double StartScan::step_error() const { return unknowns_ == 1 ? fine_step : coarse_step; }

/// Columns of states, perhaps with their variations, to T, side by side. Those of motions that do not last
/// until then become not finite. The steps that each has taken.
std::vector<int> StartScan::move(Eigen::MatrixXd& states, double tolerance) {
  const double T = problem_.duration.value;
  const auto variations = static_cast<int>(states.rows() / (2 * n_)) - 1;
  const double cost = cost_ * (variations > 0 ? variations_cost : 1);
  double spent = 0;
  const auto count = [&](int steps) {
    spent += cost / abreast * steps;
    const auto whole = static_cast<int>(spent);
    spent -= whole;
    return more_(whole);
  };
  Eigen::MatrixXd ends(states.rows(), states.cols());
  std::vector<MotionSpan> spans(states.cols());
  for (Eigen::Index k = 0; k < states.cols(); ++k)
    spans[k] = {.end = T, .initial = states.col(k).data(), .final = ends.col(k).data()};
  integrator_->run_each(spans, variations, tolerance, limits::scanned_motions::most_integrator_steps, count);
  const auto slope = [&](double t, std::span<const double> x, std::span<double> s) {
    return variations > 0 ? flow_->slope_with_variations(t, x, s) : flow_->slope(t, x, s);
  };
  const bool alone = !problem_.lagrangian->structure().quadratic;
  for (Eigen::Index k = 0; k < states.cols(); ++k) {
    if (spans[k].complete) continue;
    // Where momenta hardly depend on velocities, these are found with shorter steps of Newton's method.
    Vector y = states.col(k);
    const bool lasts =
        alone && more_(0) && move_state(slope, n_, T, tolerance, static_cast<int>(cost), more_, y);
    ends.col(k) = lasts ? y : Vector::Constant(y.size(), NAN);
  }
  states.swap(ends);
  std::vector<int> steps;
  for (const MotionSpan& span : spans) steps.push_back(span.steps);
  return steps;
}

bool StartScan::even(const Shell& shell, const std::function<bool(int steps)>& more) {
  more_ = more;
  Eigen::MatrixXd states(2 * n_, unknowns_ == 1 ? even_places : even_places * even_places);
  for (int k = 0; k < states.cols(); ++k) {
    Vector w = shell.centre;
    for (int a = 0; a < unknowns_; ++a) {
      const int place = a == 0 ? k % even_places : k / even_places;
      w[a] += shell.unit[a] * shell.farthest * (2.0 * place / (even_places - 1) - 1);
    }
    states.col(k) = conditions_->start(w);
  }
  const std::vector<int> steps = move(states, coarse_step);
  const double sum = std::accumulate(steps.begin(), steps.end(), 0.0);
  return states.allFinite() && std::ranges::max(steps) <= uneven * sum / static_cast<double>(steps.size());
}

/// Of a motion, with one unknown.
double StartScan::miss(const Vector& w) {
  const Vector start = conditions_->start(w);
  Eigen::MatrixXd end = start;
  move(end, fine_step);
  return conditions_->miss(start, end)[0];
}

/// A length on the finest lattice.
double StartScan::part_of_box(std::int64_t length) const {
  return static_cast<double>(length) / (static_cast<double>(finest) * cells_);
}

Vector StartScan::at(Place place) const {
  Vector w = shell_.centre;
  for (int a = 0; a < unknowns_; ++a)
    w[a] += shell_.unit[a] * shell_.farthest * (2 * part_of_box(place[a]) - 1);
  return w;
}

/// The corners of a cell and the points in the middle between them, three along each coordinate.
std::vector<StartScan::Place> StartScan::lattice(const Cell& cell) const {
  std::vector<Place> places;
  for (int k = 0; k < (unknowns_ == 1 ? 3 : 9); ++k)
    places.push_back({cell.corner[0] + k % 3 * cell.width / 2, cell.corner[1] + k / 3 * cell.width / 2});
  return places;
}

/// The values of motions from the corners and middles of cells, the miss and the state at T by units: those
/// that are not known yet. Not finite where there is no motion until T. False if there were not enough steps.
bool StartScan::sample_all(std::span<const Cell> cells) {
  std::vector<Place> places;
  for (const Cell& cell : cells)
    for (const Place place : lattice(cell))
      if (samples_.try_emplace(place).second) places.push_back(place);
  Eigen::MatrixXd starts(2 * n_, places.size());
  for (std::size_t k = 0; k < places.size(); ++k) starts.col(k) = conditions_->start(at(places[k]));
  Eigen::MatrixXd ends = starts;
  move(ends, step_error());
  for (std::size_t k = 0; k < places.size(); ++k) {
    Vector& values = samples_[places[k]];
    values.resize(unknowns_ + 2 * n_);
    values << conditions_->miss(starts.col(k), ends.col(k)), ends.col(k).cwiseQuotient(shell_.state_unit);
  }
  return more_(0);
}

std::vector<const double*> StartScan::samples(const std::vector<Place>& places) const {
  std::vector<const double*> values;
  for (const Place place : places) values.push_back(samples_.at(place).data());
  return values;
}

/// How far one of the values of a cell is off what its corners tell.
double StartScan::bend(const std::vector<const double*>& samples, int value) const {
  const auto of = [&](int k) { return samples[k][value]; };
  double bend = 0;
  for (int k = 0; k < static_cast<int>(samples.size()); ++k) {
    const int column = k % 3, row = unknowns_ == 1 ? 0 : k / 3 * 3;
    // The mean of the corners on whose side, edge or face the point is; a corner itself.
    const int left = column == 1 ? 0 : column, right = column == 1 ? 2 : column;
    const int below = row == 3 ? 0 : row, above = row == 3 ? 6 : row;
    const double mean = (of(left + below) + of(right + below) + of(left + above) + of(right + above)) / 4;
    const double off = std::abs(of(k) - mean);
    bend = std::isfinite(off) ? std::max(bend, off) : INFINITY;
  }
  return bend;
}

/// Cells of this width are searched, whatever the function is like in them.
std::int64_t StartScan::fine() const {
  return finest >> (unknowns_ == 1 ? halvings_in_one : halvings_in_two);
}
/// Cells of this width are not divided, whatever a search of them leads to.
std::int64_t StartScan::finest_searched() const {
  return unknowns_ == 1 ? fine() : fine() >> further_halvings;
}

/// A cell is halved until the function is nearly linear. Few values of it may be on a line by chance: so the
/// whole state at T must be. Between its samples it is off a line by the curvature that they show; where a
/// value keeps its sign by more than that, the cell holds no zero, nor where there are no motions until T.
StartScan::Verdict StartScan::judge(const Cell& cell) const {
  const std::vector<const double*> values = samples(lattice(cell));
  const auto lasts = [&](const double* sample) { return std::isfinite(sample[unknowns_]); };
  const double sure = unknowns_ == 1 ? sure_in_one : sure_in_two;
  double state_bend = 0;
  for (int entry = 0; entry < 2 * n_; ++entry)
    state_bend = std::max(state_bend, bend(values, unknowns_ + entry));
  const Vector by_state = state_bend * conditions_->miss_unit(shell_.state_unit);
  bool straight = state_bend <= nearly_linear, may_vanish = std::ranges::any_of(values, lasts);
  for (int value = 0; value < unknowns_; ++value) {
    double least = INFINITY, most = -INFINITY;
    for (const double* sample : values) {
      least = std::min(least, sample[value]);
      most = std::max(most, sample[value]);
    }
    const double own = bend(values, value), margin = sure * std::max(own, by_state[value]);
    straight = straight && own <= nearly_linear * (most - least);
    may_vanish = may_vanish && !(least > margin) && !(-most > margin);
  }
  if (!may_vanish) return Verdict::empty;
  return straight || cell.width <= fine() ? Verdict::search : Verdict::divide;
}

/// Zeros between samples of other signs, with one unknown.
void StartScan::search_between(const Cell& cell, std::vector<Vector>& found) {
  const std::vector<Place> places = lattice(cell);
  const std::vector<const double*> values = samples(places);
  for (int k = 0; k < 2; ++k) {
    const double a = values[k][0], b = values[k + 1][0];
    if (std::isfinite(a) && std::isfinite(b) && (a < 0) != (b < 0))
      enclose({at(places[k]), a}, {at(places[k + 1]), b}, found);
  }
}

/// Zeros of the linear functions of the triangles that samples make, with two.
void StartScan::add_candidates(std::size_t number, const Cell& cell,
                               std::vector<Candidate>& candidates) const {
  const std::vector<Place> places = lattice(cell);
  const std::vector<const double*> values = samples(places);
  // Around the middle, number 4.
  constexpr int ring[] = {0, 1, 2, 5, 8, 7, 6, 3, 0};
  for (int k = 0; k < 8; ++k) {
    const int corners[] = {4, ring[k], ring[k + 1]};
    Eigen::Matrix3d linear;
    for (int c = 0; c < 3; ++c) linear.col(c) << 1, values[corners[c]][0], values[corners[c]][1];
    if (!linear.allFinite()) continue;
    const Eigen::Vector3d weights = linear.partialPivLu().solve(Eigen::Vector3d::UnitX());
    if (!weights.allFinite() || weights.minCoeff() < -beyond_triangle) continue;
    Vector w = Vector::Zero(unknowns_);
    for (int c = 0; c < 3; ++c) w += weights[c] * at(places[corners[c]]);
    candidates.push_back(
        {.cell = number, .w = w, .first = w, .width = 2 * shell_.farthest * part_of_box(cell.width)});
  }
}

/// The zero between two starts with values of other signs, by bisection and the secant in turn.
void StartScan::enclose(Side a, Side b, std::vector<Vector>& found) {
  const double width = (b.w - a.w).norm(), size = std::max(std::abs(a.miss), std::abs(b.miss));
  for (int k = 0; k < most_sections && more_(0); ++k) {
    const double part = k % 2 == 0 ? a.miss / (a.miss - b.miss) : 0.5;
    const Vector w = a.w + part * (b.w - a.w);
    const Side middle{w, miss(w)};
    // Next to rest a step's error by the momentum may be too large for the integrator.
    if (!std::isfinite(middle.miss)) {
      const Side& best = std::abs(a.miss) < std::abs(b.miss) ? a : b;
      if (std::abs(best.miss) <= nearly_met * size) found.push_back(best.w);
      return;
    }
    ((middle.miss < 0) == (a.miss < 0) ? a : b) = middle;
    if (std::abs(middle.miss) <= met * size || (b.w - a.w).norm() <= met * width) {
      // A pole or a jump changes the sign too.
      if (std::abs(middle.miss) <= size) found.push_back(middle.w);
      return;
    }
  }
}

/// By units.
double StartScan::distance(const Vector& d) const {
  return (d.array() / shell_.unit.array()).matrix().norm();
}

/// A step of Newton's method, from the state at T with its variations by w.
void StartScan::approach(Candidate& c, const Vector& end) const {
  const Vector miss = conditions_->miss(conditions_->start(c.w), end.head(2 * n_));
  const Eigen::MatrixXd slope =
      conditions_->derivatives(end.tail(2 * n_ * unknowns_).reshaped(2 * n_, unknowns_));
  using Fate = Candidate::Fate;
  if (!miss.allFinite() || !slope.allFinite()) {
    // At rest, see enclose().
    c.fate = c.last_step <= nearly_met * c.width ? Fate::found : Fate::lost;
    return;
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(slope * shell_.unit.asDiagonal());
  if (!(lu.rcond() > isolated)) {
    c.fate = Fate::of_family;
    return;
  }
  const Vector step = -(shell_.unit.asDiagonal() * lu.solve(miss));
  c.w += step;
  c.last_step = distance(step);
  if (!(distance(c.w - c.first) <= strays * c.width))
    c.fate = Fate::lost;
  else if (c.last_step <= met * c.width)
    c.fate = Fate::found;
}

/// Newton's method from all candidates, until each has met its fate.
void StartScan::approach(std::vector<Candidate>& candidates, std::vector<Vector>& found) {
  using Fate = Candidate::Fate;
  std::vector<Candidate*> open;
  for (Candidate& c : candidates) open.push_back(&c);
  for (int k = 0; k < most_newton_steps && !open.empty() && more_(0); ++k) {
    Eigen::MatrixXd states(2 * n_ * (1 + unknowns_), open.size());
    for (std::size_t j = 0; j < open.size(); ++j)
      states.col(j) << conditions_->start(open[j]->w), conditions_->variations().reshaped();
    move(states, fine_step);
    for (std::size_t j = 0; j < open.size(); ++j) approach(*open[j], states.col(j));
    std::erase_if(open, [](const Candidate* c) { return c->fate != Fate::open; });
  }
  for (Candidate* c : open) c->fate = c->last_step <= nearly_met * c->width ? Fate::found : Fate::lost;
  for (Candidate& c : candidates) {
    const auto same = [&](const Vector& other) { return distance(other - c.w) <= nearly_met * c.width; };
    if (c.fate == Fate::found && std::ranges::none_of(found, same)) found.push_back(std::move(c.w));
  }
}

bool StartScan::zeros(const Shell& shell, const std::function<bool(int steps)>& more,
                      std::vector<Vector>& found) {
  more_ = more;
  shell_ = shell;
  samples_.clear();
  const double inside = shell.nearest / shell.farthest;
  std::deque<Cell> cells;
  for (int k = 0; k < (unknowns_ == 1 ? cells_ : cells_ * cells_); ++k) {
    const Place number{k % cells_, k / cells_};
    const auto within = [&](int a) {
      const auto far = [&](std::int64_t n) { return std::abs(2 * part_of_box(n * finest) - 1); };
      return std::max(far(number[a]), far(number[a] + 1)) <= inside;
    };
    if (within(0) && (unknowns_ == 1 || within(1))) continue;
    cells.push_back({{number[0] * finest, unknowns_ == 1 ? 0 : number[1] * finest}, finest});
  }
  // Large cells first: what steps are enough for is then spread over the box.
  while (!cells.empty()) {
    const auto last = cells.begin() + static_cast<std::ptrdiff_t>(std::min(cells.size(), cells_at_once));
    const std::vector<Cell> next(cells.begin(), last);
    cells.erase(cells.begin(), last);
    if (!sample_all(next)) return false;
    std::vector<Candidate> candidates;
    std::vector<bool> divided(next.size(), false);
    for (std::size_t k = 0; k < next.size(); ++k) {
      const Verdict verdict = judge(next[k]);
      divided[k] = verdict == Verdict::divide;
      if (verdict != Verdict::search) continue;
      if (unknowns_ == 1)
        search_between(next[k], found);
      else
        add_candidates(k, next[k], candidates);
    }
    approach(candidates, found);
    for (const Candidate& c : candidates)
      if (c.fate == Candidate::Fate::lost) divided[c.cell] = next[c.cell].width > finest_searched();
    for (std::size_t k = 0; k < next.size(); ++k) {
      if (!divided[k]) continue;
      const std::int64_t half = next[k].width / 2;
      for (int part = 0; part < (1 << unknowns_); ++part)
        cells.push_back({{next[k].corner[0] + part % 2 * half, next[k].corner[1] + part / 2 * half}, half});
    }
  }
  return more(0);
}

}  // namespace extremal
