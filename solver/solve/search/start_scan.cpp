#include "solve/search/start_scan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/dop853.hpp"
#include "motion/point.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::start_scan;

namespace {

using Vector = StartScan::Vector;

/// Of the finest lattice, in a cell.
constexpr int finest = 1 << (halvings_in_one + further_halvings + 1);

std::span<double> span_of(Vector& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// The momentum that is given at an end left free; zero at a natural one.
double momentum_at(const Problem& problem, int end) {
  return problem.boundary.momenta.empty() ? 0 : problem.boundary.momenta[end];
}

}  // namespace

StartScan::StartScan(const Problem& problem)
    : problem_(problem),
      n_(problem.coordinates()),
      cost_(problem.lagrangian->structure().quadratic ? 1 : implicit_cost) {
  const EndMap& ends = problem.ends;
  // Each end value has a condition of its own: none is coupled to another.
  const auto fixed = static_cast<int>(std::ranges::count_if(ends.fixed, [](char is) { return is != 0; }));
  const bool apart = static_cast<int>(ends.fixed.size()) == 2 * n_ && ends.free == 2 * n_ - fixed;
  usable_ = n_ <= most_coordinates && problem.has_ends() && apart && ends.free > 0 &&
            !problem.duration.free && !problem.initial && !problem.paired && !problem.manifold &&
            !problem.phase && problem.boundary.costs.empty() && Flow::suits(*problem.lagrangian);
  if (usable_) flow_.emplace(*problem.lagrangian);
  cells_ = n_ == 1 ? cells_in_one : cells_in_two;
}

double StartScan::Shell::reach(const Vector& w) const {
  return ((w - centre).array() / unit.array()).abs().maxCoeff();
}

StartScan::Shell StartScan::around(std::span<const double> ends, double extent, double speed) {
  const std::span<const double> q = ends.first(n_);
  Shell shell{Vector::Zero(n_), Vector::Constant(n_, extent), 0, 1};
  std::vector<double> v(n_, 0);
  const Vector rest = unknown(q, v);
  for (int a = 0; a < n_; ++a) {
    if (!problem_.ends.fixed[a]) {
      shell.centre[a] = q[a];
      continue;
    }
    v[a] = speed;
    shell.unit[a] = std::abs(unknown(q, v)[a] - rest[a]);
    v[a] = 0;
  }
  return shell;
}

Vector StartScan::unknown(std::span<const double> q, std::span<const double> v) {
  Vector p(n_);
  if (!flow_->momentum(q, v, 0, span_of(p))) p.setConstant(NAN);
  for (int a = 0; a < n_; ++a)
    if (!problem_.ends.fixed[a]) p[a] = q[a];
  return p;
}

/// (q, p) at the start.
Vector StartScan::start(const Vector& w) const {
  Vector y(2 * n_);
  for (int a = 0; a < n_; ++a) {
    const bool fixed = problem_.ends.fixed[a];
    y[a] = fixed ? problem_.ends.offset[a] : w[a];
    y[n_ + a] = fixed ? w[a] : momentum_at(problem_, a);
  }
  return y;
}

/// What the conditions at the end leave.
Vector StartScan::miss(const Vector& state) const {
  Vector miss(n_);
  for (int a = 0; a < n_; ++a)
    miss[a] = problem_.ends.fixed[n_ + a] ? state[a] - problem_.ends.offset[n_ + a]
                                          : state[n_ + a] - momentum_at(problem_, n_ + a);
  return miss;
}

std::optional<StartScan::State> StartScan::state(const Vector& w) {
  Vector y = start(w);
  State state{{y.begin(), y.begin() + n_}, std::vector<double>(n_, 0)};
  if (!flow_->velocity(state.q, span_of(y).subspan(n_), 0, state.v)) return std::nullopt;
  if (!std::ranges::all_of(state.v, [](double x) { return std::isfinite(x); })) return std::nullopt;
  return state;
}

/// From y to T; false if there is no motion until then.
template <class Slope>
bool StartScan::integrate(const Slope& slope, Vector& y, double tolerance, int cost) {
  DormandPrince<double> method(slope, static_cast<int>(y.size()));
  IntegrationOptions options;
  options.tolerance = tolerance;
  options.block = n_;
  options.controlled = 2 * n_;
  options.max_steps = most_integrator_steps;
  double t = 0;
  const Integrated result = method.advance(t, span_of(y), problem_.duration.value, options);
  more_(cost * cost_ * (method.steps() + method.rejected()));
  return result == Integrated::done;
}

/// The miss of a motion; not finite where there is none until T.
Vector StartScan::fly(const Vector& w) {
  Vector y = start(w);
  const auto slope = [this](double t, std::span<const double> x, std::span<double> s) {
    return flow_->slope(t, x, s);
  };
  const bool lasts = integrate(slope, y, n_ == 1 ? fine_step : coarse_step, 1);
  return lasts ? miss(y) : Vector::Constant(n_, NAN);
}

/// With its derivatives by w.
bool StartScan::fly(const Vector& w, Vector& miss, Eigen::MatrixXd& derivatives) {
  Vector y = Vector::Zero(2 * n_ * (1 + n_));
  y.head(2 * n_) = start(w);
  for (int a = 0; a < n_; ++a) y[2 * n_ * (1 + a) + (problem_.ends.fixed[a] ? n_ + a : a)] = 1;
  const auto slope = [this](double t, std::span<const double> x, std::span<double> s) {
    return flow_->slope_with_variations(t, x, s);
  };
  if (!integrate(slope, y, fine_step, variations_cost)) return false;
  miss = this->miss(y.head(2 * n_));
  derivatives.resize(n_, n_);
  for (int b = 0; b < n_; ++b)
    for (int a = 0; a < n_; ++a)
      derivatives(a, b) = y[2 * n_ * (1 + b) + (problem_.ends.fixed[n_ + a] ? a : n_ + a)];
  return miss.allFinite() && derivatives.allFinite();
}

Vector StartScan::at(Place place) const {
  Vector w = shell_.centre;
  for (int a = 0; a < n_; ++a)
    w[a] += shell_.unit[a] * shell_.farthest * (2.0 * place[a] / (cells_ * finest) - 1);
  return w;
}

const Vector& StartScan::sample(Place place) {
  const auto known = samples_.find(place);
  return known != samples_.end() ? known->second : samples_.emplace(place, fly(at(place))).first->second;
}

/// The corners of a cell and the points in the middle between them, three along each coordinate.
std::vector<StartScan::Place> StartScan::lattice(const Cell& cell) const {
  std::vector<Place> places;
  for (int k = 0; k < (n_ == 1 ? 3 : 9); ++k)
    places.push_back({cell.corner[0] + k % 3 * cell.width / 2, cell.corner[1] + k / 3 * cell.width / 2});
  return places;
}

/// Halves a cell until the function is nearly linear. It is off the values that its corners tell in the
/// middles between them by its curvature; where one of its values keeps its sign by more than that, the cell
/// holds no zero, nor where there are no motions until T.
void StartScan::divide(const Cell& cell, std::deque<Cell>& cells, std::vector<Vector>& found) {
  const std::vector<Place> places = lattice(cell);
  const auto lasts = [&](Place place) { return sample(place).allFinite(); };
  bool straight = true, may_vanish = std::ranges::any_of(places, lasts);
  for (int value = 0; value < n_; ++value) {
    const auto of = [&](int k) { return sample(places[k])[value]; };
    double least = INFINITY, most = -INFINITY, bend = 0;
    for (int k = 0; k < static_cast<int>(places.size()); ++k) {
      const int column = k % 3, row = n_ == 1 ? 0 : k / 3 * 3;
      // The mean of the corners on whose side, edge or face the point is; a corner itself.
      const int left = column == 1 ? 0 : column, right = column == 1 ? 2 : column;
      const int below = row == 3 ? 0 : row, above = row == 3 ? 6 : row;
      const double mean = (of(left + below) + of(right + below) + of(left + above) + of(right + above)) / 4;
      bend = std::max(bend, std::abs(of(k) - mean));
      least = std::min(least, of(k));
      most = std::max(most, of(k));
      if (!std::isfinite(of(k))) bend = INFINITY;
    }
    const double size = std::max(std::abs(least), std::abs(most));
    straight = straight && bend <= nearly_linear * size;
    may_vanish = may_vanish && !(least > sure * bend) && !(-most > sure * bend);
  }
  if (!may_vanish) return;
  const int fine = finest >> (n_ == 1 ? halvings_in_one : halvings_in_two), finer = fine >> further_halvings;
  if ((straight || cell.width <= fine) && (search(cell, places, found) || cell.width <= finer)) return;
  const int half = cell.width / 2;
  for (int k = 0; k < (1 << n_); ++k)
    cells.push_back({{cell.corner[0] + k % 2 * half, cell.corner[1] + k / 2 * half}, half});
}

/// Zeros in a cell that is not divided further: between samples of other signs, or of the linear functions of
/// the triangles that its samples make. False if Newton's method leads from one to none.
bool StartScan::search(const Cell& cell, const std::vector<Place>& places, std::vector<Vector>& found) {
  if (n_ == 1) {
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
    for (int c = 0; c < 3; ++c) linear.col(c) << 1, sample(corners[c]);
    if (!linear.allFinite()) continue;
    const Eigen::Vector3d weights = linear.partialPivLu().solve(Eigen::Vector3d::UnitX());
    if (!weights.allFinite() || weights.minCoeff() < -beyond_triangle) continue;
    Vector w = Vector::Zero(n_);
    for (int c = 0; c < 3; ++c) w += weights[c] * at(corners[c]);
    led = approach(std::move(w), 2.0 * shell_.farthest * cell.width / (cells_ * finest), found) && led;
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
  for (int k = 0; k < (n_ == 1 ? cells_ : cells_ * cells_); ++k) {
    const Place number{k % cells_, k / cells_};
    const auto within = [&](int a) {
      return std::max(std::abs(2.0 * number[a] / cells_ - 1), std::abs(2.0 * (number[a] + 1) / cells_ - 1)) <=
             inside;
    };
    if (within(0) && (n_ == 1 || within(1))) continue;
    cells.push_back({{number[0] * finest, n_ == 1 ? 0 : number[1] * finest}, finest});
  }
  // Large cells first: what steps are enough for is then spread over the box.
  for (; !cells.empty() && more(0); cells.pop_front()) divide(Cell(cells.front()), cells, found);
  return more(0);
}

}  // namespace extremal
