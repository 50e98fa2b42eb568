#include <fmt/format.h>

#include <algorithm>

#include "problem/closing.hpp"
#include "rivals/dop853.hpp"
#include "rivals/flow.hpp"
#include "study/guess.hpp"
#include "study/naming.hpp"

namespace extremal {
namespace {

/// q and q' at t = 0; what is not named is zero.
struct InitialState {
  std::vector<double> q, v;
};

InitialState read_state(const std::vector<Assignment>& values, const System& system) {
  InitialState state{std::vector<double>(system.names.size(), 0),
                     std::vector<double>(system.names.size(), 0)};
  for (const Assignment& a : values) {
    const bool velocity = !a.name.empty() && a.name.back() == '\'';
    const std::string name = velocity ? a.name.substr(0, a.name.size() - 1) : a.name;
    for_each_value(a, range_of(name, a.name_at, system), [&](int coordinate, const Quantity& q) {
      (velocity ? state.v : state.q)[coordinate] = evaluate(q, system.parameters);
    });
  }
  return state;
}

/// Steps of the integrator, relative: its error comes back amplified by what errors grow over half a period.
constexpr double tolerance = 1e-14;
/// Cubic interpolation between so many samples of a step keeps about six digits.
constexpr int samples_a_step = 64;

/// The motion from a state, as a flow in (q, p).
class Motion {
 public:
  Motion(const Problem& problem, const Location& at)
      : at_(at),
        n_(problem.coordinates()),
        flow_(*problem.lagrangian),
        method_(
            [this](double t, std::span<const double> y, std::span<double> s) { return flow_.slope(t, y, s); },
            2 * problem.coordinates()),
        between_(2 * n_) {
    options_.tolerance = tolerance;
    options_.block = problem.coordinates();
  }

  /// Times from `from` to `to`, later or earlier, and q there.
  struct Samples {
    std::vector<double> t, q;
  };
  Samples sample(const InitialState& state, double from, double to) {
    std::vector<double> y(state.q);
    y.resize(2 * n_);
    if (!flow_.momentum(state.q, state.v, from, std::span(y).subspan(n_)))
      throw SceneError(at_, "L is not finite at the initial state of the guess");
    Samples samples;
    const auto add = [&](double t, const std::vector<double>& point) {
      samples.t.push_back(t);
      samples.q.insert(samples.q.end(), point.begin(), point.begin() + static_cast<std::ptrdiff_t>(n_));
    };
    add(from, y);
    for (double t = from, before = from; t != to; before = t) {
      if (method_.accept_step(t, y, to, options_) != Integrated::done ||
          !method_.prepare_interpolation(y, static_cast<int>(y.size())))
        throw SceneError(
            at_, fmt::format("the initial state of the guess cannot be integrated beyond t = {:.6g}", t));
      for (int k = 1; k < samples_a_step; ++k) {
        const double theta = static_cast<double>(k) / samples_a_step;
        method_.interpolate(theta, between_);
        add(before + theta * (t - before), between_);
      }
      add(t, y);
    }
    return samples;
  }

 private:
  Location at_;
  std::size_t n_;
  Flow flow_;
  Dop853 method_;
  IntegrationOptions options_;
  std::vector<double> between_;
};

/// Where an orbit that closes arrives.
InitialState closed(const ClosingMap& map, const InitialState& state) {
  const auto n = static_cast<Eigen::Index>(state.q.size());
  const Eigen::VectorXd q = map.r * Eigen::Map<const Eigen::VectorXd>(state.q.data(), n) + map.c;
  const Eigen::VectorXd v = map.r * Eigen::Map<const Eigen::VectorXd>(state.v.data(), n);
  return {{q.begin(), q.end()}, {v.begin(), v.end()}};
}

/// Of an orbit that closes only the first half is integrated onwards; the second is integrated back from
/// where it has to arrive: errors grow for half as long. Halfway each gives way to the other.
void add_halves(const Motion::Samples& first, const Motion::Samples& second, double duration, Guess& guess) {
  const std::size_t n = first.q.size() / first.t.size();
  const auto add = [&](const Motion::Samples& half, std::size_t k, double weight) {
    const double share = half.t.front() == 0 ? half.t[k] : duration - half.t[k];
    guess.tau.push_back(half.t[k] / duration);
    for (std::size_t a = 0; a < n; ++a) {
      const double gap = second.q[second.q.size() - n + a] - first.q[first.q.size() - n + a];
      guess.q.push_back(half.q[k * n + a] + weight * gap * share / duration);
    }
  };
  for (std::size_t k = 0; k < first.t.size(); ++k) add(first, k, 1);
  for (std::size_t k = second.t.size() - 1; k-- > 0;) add(second, k, -1);
}

}  // namespace

void integrate_state(const std::vector<Assignment>& values, const System& system, const Location& at,
                     Problem& problem) {
  const InitialState state = read_state(values, system);
  const double duration = problem.duration.value;
  Motion motion(problem, at);
  if (problem.periodic) {
    const Motion::Samples first = motion.sample(state, 0, duration / 2);
    const Motion::Samples second =
        Motion(problem, at).sample(closed(closing_map(problem), state), duration, duration / 2);
    add_halves(first, second, duration, problem.guess);
  } else {
    const Motion::Samples samples = motion.sample(state, 0, duration);
    for (const double t : samples.t) problem.guess.tau.push_back(t / duration);
    problem.guess.q = samples.q;
  }
  problem.guess.motion = true;
}

}  // namespace extremal
