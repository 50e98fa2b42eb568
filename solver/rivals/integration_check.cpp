#include "rivals/integration_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "machine/roundoff.hpp"

namespace extremal {

namespace {

/// With more coordinates, a few variations tell the growth and the distance is not computed.
constexpr std::size_t most_complete = 40, probes = 8;
constexpr double longer = 10;
/// The integrator's own error stays this much below what is allowed, within its reach.
constexpr double tighter = 1e-3, tightest = 1e-15, loosest = 1e-10;
/// A piece is shortened to a share between these, and lengthened where it may become so many times longer.
constexpr double most_cut = 1.0 / 16, least_cut = 0.5, worth_a_step = 1.1;
/// Numbers kept in waypoints, at most.
constexpr std::size_t most_kept = 4'000'000;
/// A range below this part of the values is none.
constexpr double negligible = 1e-12;
/// Momenta are not asked for more digits than this share of the mean speed gives.
constexpr double nearly_uniform = 1e-3;

/// Largest range over coordinates, or the largest value where that is negligible; rows of n.
struct Extents {
  double range = 0, magnitude = 0;
  double size() const { return range > negligible * magnitude ? range : magnitude; }
};

Extents extents(const std::vector<double>& rows, std::size_t n) {
  Extents result;
  for (std::size_t a = 0; a < n; ++a) {
    double low = rows[a], high = rows[a];
    for (std::size_t i = a; i < rows.size(); i += n) {
      low = std::min(low, rows[i]);
      high = std::max(high, rows[i]);
    }
    result.range = std::max(result.range, high - low);
    result.magnitude = std::max({result.magnitude, std::abs(low), std::abs(high)});
  }
  return result;
}

/// Deterministic, in [−1, 1].
double noise(std::size_t k) {
  const double x = 0.5 + 0.618033988749895 * static_cast<double>(k);
  return 2 * (x - std::floor(x)) - 1;
}

Eigen::VectorXd vector(std::span<const double> x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

}  // namespace

IntegrationCheck::IntegrationCheck(const Problem& problem, const Trajectory& trajectory,
                                   const VerifyOptions& options)
    : problem_(problem),
      trajectory_(trajectory),
      options_(options),
      n_(problem.coordinates()),
      complete_(n_ <= most_complete),
      columns_(complete_ ? 2 * n_ : probes),
      flow_(problem.motion(), problem.motion_copies()),
      integrator_([this](double t, auto y, auto slope) { return flow_.slope_with_variations(t, y, slope); },
                  static_cast<int>(2 * n_ * (1 + columns_))),
      shorter_([this](double t, auto y, auto slope) { return flow_.slope(t, y, slope); },
               static_cast<int>(2 * n_)),
      y_(2 * n_ * (1 + columns_)),
      v_(n_),
      motion_v_(n_),
      interpolated_(2 * n_),
      next_(2 * n_) {}

bool IntegrationCheck::state_at(double t, std::span<double> y) {
  trajectory_.at(t, y.first(n_), v_);
  return flow_.momentum(y.first(n_), v_, t, y.subspan(n_, n_));
}

std::string IntegrationCheck::sample() {
  const int points = 2 * trajectory_.degree;
  // The momenta that velocities make, less those of rest: most probable paths have velocities and no momenta.
  std::vector<double> p_samples, made_samples;
  const std::vector<double> rest(n_, 0);
  for (int k = 0; k < trajectory_.elements(); ++k) {
    const double start = trajectory_.times[k], end = trajectory_.times[k + 1];
    for (int i = k == 0 ? 0 : 1; i <= points; ++i) {
      const double t = i == points ? end : start + (end - start) * i / points;
      if (!state_at(t, next_)) return fmt::format("L or a derivative is not finite at t = {:.9g}", t);
      t_samples_.push_back(t);
      q_samples_.insert(q_samples_.end(), next_.begin(), next_.begin() + n_);
      p_samples.insert(p_samples.end(), next_.begin() + n_, next_.end());
      v_samples_.insert(v_samples_.end(), v_.begin(), v_.end());
      if (flow_.momentum(std::span(next_).first(n_), rest, t, std::span(interpolated_).first(n_)))
        for (std::size_t a = 0; a < n_; ++a) made_samples.push_back(next_[n_ + a] - interpolated_[a]);
    }
  }
  const auto row = [&](const std::vector<double>& rows, bool last) {
    return vector(last ? std::span(rows).last(n_) : std::span(rows).first(n_));
  };
  ends_ = {row(q_samples_, false), row(p_samples, false), row(v_samples_, false), row(q_samples_, true),
           row(p_samples, true)};
  const Extents q = extents(q_samples_, n_), v = extents(v_samples_, n_), p = extents(p_samples, n_);
  scales_ = {q.size(), p.size(), v.size()};
  if (made_samples.size() == p_samples.size())
    scales_.p = std::max(scales_.p, extents(made_samples, n_).size());
  // A motion that is nearly uniform has hardly a range of velocity: its momenta are those of so much at
  // least.
  const double slowest = nearly_uniform * q.size() / trajectory_.duration();
  if (v.size() > 0) scales_.p *= std::max(1.0, slowest / v.size());
  reach_ = q.magnitude > 0 ? q.size() / q.magnitude : 1;
  allowed_q_ = std::max(options_.tolerance * scales_.q, 16 * machine_epsilon * q.magnitude);
  allowed_v_ = std::max(velocity_factor * options_.tolerance * scales_.v, 16 * machine_epsilon * v.magnitude);
  for (double* scale : {&scales_.q, &scales_.p, &scales_.v})
    if (*scale == 0) *scale = 1;
  return {};
}

void IntegrationCheck::begin_piece(double t) {
  state_at(t, std::span(y_).first(2 * n_));
  std::fill(y_.begin() + 2 * n_, y_.end(), 0.0);
  for (std::size_t c = 0; c < columns_; ++c) {
    double* const column = y_.data() + 2 * n_ * (c + 1);
    for (std::size_t i = 0; i < 2 * n_; ++i)
      column[i] = (complete_ ? double(i == c) : noise(2 * n_ * c + i)) * (i < n_ ? scales_.q : scales_.p);
  }
}

/// What the errors that are allowed at the start, of q and ten times that of p, may have become in q: at
/// most, or with probes the largest seen.
double IntegrationCheck::growth() const {
  double largest = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    double sum = 0, most = 0;
    for (std::size_t c = 0; c < columns_; ++c) {
      const double entry = std::abs(y_[2 * n_ * (c + 1) + i]) / scales_.q;
      sum += c < n_ ? entry : velocity_factor * entry;
      most = std::max(most, velocity_factor * entry);
    }
    largest = std::max(largest, complete_ ? sum : most);
  }
  return largest;
}

/// Without the distance from the extremal only long pieces show errors that vary slowly.
double IntegrationCheck::growth_limit() const {
  return complete_ ? options_.growth : longer * options_.growth;
}

/// How far q and q' are from a state.
bool IntegrationCheck::measure(double t, std::span<const double> q, std::span<const double> v,
                               std::span<const double> state, Miss& miss) {
  if (!flow_.velocity(state.first(n_), state.subspan(n_, n_), t, motion_v_)) return false;
  const auto unit = [](double difference, double allowed) {
    return difference > 0 ? difference / allowed : 0;
  };
  miss = {};
  for (std::size_t a = 0; a < n_; ++a) {
    miss.q = std::max(miss.q, unit(std::abs(state[a] - q[a]), allowed_q_));
    miss.v = std::max(miss.v, unit(std::abs(motion_v_[a] - v[a]), allowed_v_));
  }
  return true;
}

void IntegrationCheck::note(double t, const Miss& miss, Verification& result) {
  if (std::max(miss.q, miss.v) > std::max(result.defect, result.velocity_defect)) result.worst_time = t;
  result.defect = std::max(result.defect, miss.q);
  result.velocity_defect = std::max(result.velocity_defect, miss.v);
}

/// At the samples within the step. Where the interpolation, which is less exact than the step, misses one, a
/// step that ends there counts.
bool IntegrationCheck::compare_step(double before, double now, Verification& result) {
  if (compared_ == t_samples_.size() || t_samples_[compared_] > now) return true;
  if (!integrator_.prepare_interpolation(y_, static_cast<int>(2 * n_))) return false;
  for (; compared_ < t_samples_.size() && t_samples_[compared_] <= now; ++compared_) {
    const double t = t_samples_[compared_];
    integrator_.interpolate(std::clamp((t - before) / (now - before), 0.0, 1.0), interpolated_);
    const std::span<const double> q(q_samples_.data() + compared_ * n_, n_);
    const std::span<const double> v(v_samples_.data() + compared_ * n_, n_);
    Miss miss;
    if (!measure(t, q, v, interpolated_, miss)) return false;
    if (std::max(miss.q, miss.v) > 1) {
      if (!shorter_.step(before, std::span(saved_).first(2 * n_), t - before)) return false;
      if (!measure(t, q, v, shorter_.next(), miss)) return false;
    }
    note(t, miss, result);
  }
  return true;
}

/// For the distance between the ends of pieces.
void IntegrationCheck::keep_waypoint(double t) {
  const auto n = static_cast<Eigen::Index>(n_);
  if (!complete_ || kept_ > most_kept) return;
  trajectory_.at(t, std::span(next_).first(n_), v_);
  Waypoint waypoint{.transition = Eigen::MatrixXd(n, 2 * n), .defect = Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    waypoint.defect[i] = (y_[i] - next_[i]) / scales_.q;
    for (Eigen::Index c = 0; c < 2 * n; ++c) waypoint.transition(i, c) = y_[2 * n * (c + 1) + i] / scales_.q;
  }
  kept_ += static_cast<std::size_t>(waypoint.transition.size());
  waypoints_.push_back(std::move(waypoint));
}

bool IntegrationCheck::end_piece(double start, double end, Verification& result) {
  ++result.pieces;
  result.growth = std::max(result.growth, growth());
  if (!state_at(end, next_)) return false;
  const std::span<const double> y(y_);
  Miss miss;
  if (!measure(end, std::span(next_).first(n_), v_, y.first(2 * n_), miss)) return false;
  note(end, miss, result);
  if (!complete_) return true;
  const auto size = static_cast<Eigen::Index>(2 * n_);
  Eigen::VectorXd unit(size);
  unit << Eigen::VectorXd::Constant(size / 2, scales_.q), Eigen::VectorXd::Constant(size / 2, scales_.p);
  MotionPiece piece{.start = start,
                    .end = end,
                    .transition = {},
                    .defect = {},
                    .by_duration = {},
                    .waypoints = std::exchange(waypoints_, {})};
  piece.transition =
      unit.cwiseInverse().asDiagonal() * Eigen::Map<const Eigen::MatrixXd>(y_.data() + size, size, size);
  piece.defect = (vector(y.first(2 * n_)) - vector(next_)).cwiseQuotient(unit);
  if (problem_.duration.free) {
    if (!flow_.slope(end, y.first(2 * n_), next_)) return false;
    piece.by_duration = vector(next_).cwiseQuotient(unit) * ((end - start) / trajectory_.duration());
  }
  pieces_.push_back(std::move(piece));
  return true;
}

/// Takes steps until a piece is complete: at `limit`, or where errors have grown enough; steps end where
/// along a line they would have. What failed.
std::string IntegrationCheck::run_piece(double& t, double limit, const IntegrationOptions& integration,
                                        Verification& result) {
  const double start = t, allowed = options_.ends.empty() ? growth_limit() : INFINITY;
  begin_piece(t);
  const double first = growth();
  double near = start + length_;
  while (t < limit && t < near) {
    const double before = t;
    saved_ = y_;
    if (result.steps == options_.max_steps)
      return fmt::format("{} steps of the integrator end at t = {:.9g}", result.steps, t);
    ++result.steps;
    const Integrated taken = integrator_.accept_step(t, y_, std::min(limit, near), integration);
    if (taken == Integrated::deadline)
      return fmt::format("{} is spent at t = {:.9g}", options_.deadline.budget_text(), t);
    if (taken != Integrated::done) return fmt::format("it cannot be integrated beyond t = {:.9g}", t);
    const double grown = growth(), share = grown > first ? (allowed - first) / (grown - first) : INFINITY;
    if (grown > allowed) {
      near = before > start ? before : start + (t - start) * std::clamp(share, most_cut, least_cut);
      t = before;
      y_ = saved_;
      continue;
    }
    near = share > worth_a_step ? start + (t - start) * share : t;
    keep_waypoint(t);
    if (!compare_step(before, t, result)) return fmt::format("L is not finite near t = {:.9g}", t);
  }
  length_ = t < limit ? t - start : INFINITY;
  return end_piece(start, t, result) ? "" : fmt::format("L is not finite near t = {:.9g}", t);
}

std::string IntegrationCheck::run(Verification& result) {
  const double duration = trajectory_.duration();
  const IntegrationOptions integration{
      .tolerance = std::clamp(tighter * options_.tolerance * reach_, tightest, loosest),
      .block = static_cast<int>(n_),
      // At rest or at the origin p or q all but vanishes, and is known only to roundoff of what makes it up.
      .least = {scales_.q, scales_.p},
      .controlled = static_cast<int>(2 * n_),
      .deadline = options_.deadline};
  auto end = options_.ends.begin();
  for (double t = 0; t < duration;) {
    const std::string failure =
        run_piece(t, end == options_.ends.end() ? duration : *end++, integration, result);
    if (!failure.empty()) return failure;
  }
  return {};
}

}  // namespace extremal
