#include "solve/search/start_scan.hpp"

#include <algorithm>
#include <cmath>
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

/// From y to T; false if there is no motion until then.
template <class Slope>
bool StartScan::integrate(const Slope& slope, Vector& y, double tolerance, int cost) {
  return move_state(slope, n_, problem_.duration.value, tolerance, cost * cost_, more_, y);
}

/// The miss of a motion, and its state at T by units; not finite where there is none until T.
Vector StartScan::fly(const Vector& w) {
  const Vector start = conditions_->start(w);
  Vector y = start;
  const auto slope = [this](double t, std::span<const double> x, std::span<double> s) {
    return flow_->slope(t, x, s);
  };
  const bool lasts = integrate(slope, y, unknowns_ == 1 ? fine_step : coarse_step, 1);
  Vector values = Vector::Constant(unknowns_ + 2 * n_, NAN);
  if (lasts) values << conditions_->miss(start, y), y.cwiseQuotient(shell_.state_unit);
  return values;
}

/// With its derivatives by w.
bool StartScan::fly(const Vector& w, Vector& miss, Eigen::MatrixXd& derivatives) {
  const int states = 2 * n_;
  const Vector start = conditions_->start(w);
  Vector y(states * (1 + unknowns_));
  y << start, conditions_->variations().reshaped();
  const auto slope = [this](double t, std::span<const double> x, std::span<double> s) {
    return flow_->slope_with_variations(t, x, s);
  };
  if (!integrate(slope, y, fine_step, variations_cost)) return false;
  miss = conditions_->miss(start, y.head(states));
  derivatives = conditions_->derivatives(y.tail(states * unknowns_).reshaped(states, unknowns_));
  return miss.allFinite() && derivatives.allFinite();
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

const Vector& StartScan::sample(Place place) {
  const auto known = samples_.find(place);
  return known != samples_.end() ? known->second : samples_.emplace(place, fly(at(place))).first->second;
}

/// The corners of a cell and the points in the middle between them, three along each coordinate.
std::vector<StartScan::Place> StartScan::lattice(const Cell& cell) const {
  std::vector<Place> places;
  for (int k = 0; k < (unknowns_ == 1 ? 3 : 9); ++k)
    places.push_back({cell.corner[0] + k % 3 * cell.width / 2, cell.corner[1] + k / 3 * cell.width / 2});
  return places;
}

/// How far one of the values of a cell is off what its corners tell.
double StartScan::bend(const std::vector<Place>& places, int value) {
  const auto of = [&](int k) { return sample(places[k])[value]; };
  double bend = 0;
  for (int k = 0; k < static_cast<int>(places.size()); ++k) {
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

/// Halves a cell until the function is nearly linear. Few values of it may be on a line by chance: so the
/// whole state at T must be. Between its samples it is off a line by the curvature that they show; where a
/// value keeps its sign by more than that, the cell holds no zero, nor where there are no motions until T.
void StartScan::divide(const Cell& cell, std::deque<Cell>& cells, std::vector<Vector>& found) {
  const std::vector<Place> places = lattice(cell);
  const auto lasts = [&](Place place) { return sample(place).allFinite(); };
  const double sure = unknowns_ == 1 ? sure_in_one : sure_in_two;
  double state_bend = 0;
  for (int entry = 0; entry < 2 * n_; ++entry)
    state_bend = std::max(state_bend, bend(places, unknowns_ + entry));
  const Vector by_state = state_bend * conditions_->miss_unit(shell_.state_unit);
  bool straight = state_bend <= nearly_linear, may_vanish = std::ranges::any_of(places, lasts);
  for (int value = 0; value < unknowns_; ++value) {
    double least = INFINITY, most = -INFINITY;
    for (Place place : places) {
      least = std::min(least, sample(place)[value]);
      most = std::max(most, sample(place)[value]);
    }
    const double own = bend(places, value), margin = sure * std::max(own, by_state[value]);
    straight = straight && own <= nearly_linear * (most - least);
    may_vanish = may_vanish && !(least > margin) && !(-most > margin);
  }
  if (!may_vanish) return;
  const std::int64_t fine = finest >> (unknowns_ == 1 ? halvings_in_one : halvings_in_two);
  const std::int64_t finer = unknowns_ == 1 ? fine : fine >> further_halvings;
  if ((straight || cell.width <= fine) && (search(cell, places, found) || cell.width <= finer)) return;
  const std::int64_t half = cell.width / 2;
  for (int k = 0; k < (1 << unknowns_); ++k)
    cells.push_back({{cell.corner[0] + k % 2 * half, cell.corner[1] + k / 2 * half}, half});
}

/// Zeros in a cell that is not divided further: between samples of other signs, or of the linear functions of
/// the triangles that its samples make. False if Newton's method leads from one to none.
bool StartScan::search(const Cell& cell, const std::vector<Place>& places, std::vector<Vector>& found) {
  if (unknowns_ == 1) {
    for (int k = 0; k < 2; ++k) {
      const double a = sample(places[k])[0], b = sample(places[k + 1])[0];
      if (std::isfinite(a) && std::isfinite(b) && (a < 0) != (b < 0))
        enclose({at(places[k]), a}, {at(places[k + 1]), b}, found);
    }
    return true;
  }
  bool led = true;
  // Around the middle, number 4.
  constexpr int ring[] = {0, 1, 2, 5, 8, 7, 6, 3, 0};
  for (int k = 0; k < 8; ++k) {
    const Place corners[] = {places[4], places[ring[k]], places[ring[k + 1]]};
    Eigen::Matrix3d linear;
    for (int c = 0; c < 3; ++c) linear.col(c) << 1, sample(corners[c]).head(unknowns_);
    if (!linear.allFinite()) continue;
    const Eigen::Vector3d weights = linear.partialPivLu().solve(Eigen::Vector3d::UnitX());
    if (!weights.allFinite() || weights.minCoeff() < -beyond_triangle) continue;
    Vector w = Vector::Zero(unknowns_);
    for (int c = 0; c < 3; ++c) w += weights[c] * at(corners[c]);
    led = approach(std::move(w), 2 * shell_.farthest * part_of_box(cell.width), found) && led;
  }
  return led;
}

/// The zero between two starts with values of other signs, by bisection and the secant in turn.
void StartScan::enclose(Side a, Side b, std::vector<Vector>& found) {
  const double width = (b.w - a.w).norm(), size = std::max(std::abs(a.miss), std::abs(b.miss));
  for (int k = 0; k < most_sections && more_(0); ++k) {
    const double part = k % 2 == 0 ? a.miss / (a.miss - b.miss) : 0.5;
    const Vector w = a.w + part * (b.w - a.w);
    const Side middle{w, fly(w)[0]};
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

/// Newton's method for a zero about as near as the width of a cell, by units. True if it leads to one, also
/// of a family.
bool StartScan::approach(Vector w, double width, std::vector<Vector>& found) {
  const auto distance = [this](const Vector& d) { return (d.array() / shell_.unit.array()).matrix().norm(); };
  const Vector first = w;
  double last_step = INFINITY;
  for (int k = 0; k < most_newton_steps && last_step > met * width && more_(0); ++k) {
    Vector miss;
    Eigen::MatrixXd slope;
    if (!fly(w, miss, slope)) {
      if (last_step > nearly_met * width) return false;
      break;  // at rest, see enclose()
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(slope * shell_.unit.asDiagonal());
    if (!(lu.rcond() > isolated)) return true;
    const Vector step = -(shell_.unit.asDiagonal() * lu.solve(miss));
    w += step;
    last_step = distance(step);
    if (!(distance(w - first) <= strays * width)) return false;
  }
  const auto same = [&](const Vector& other) { return distance(other - w) <= nearly_met * width; };
  if (!(last_step <= nearly_met * width)) return false;
  if (std::ranges::none_of(found, same)) found.push_back(std::move(w));
  return true;
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
  for (; !cells.empty() && more(0); cells.pop_front()) divide(Cell(cells.front()), cells, found);
  return more(0);
}

}  // namespace extremal
