#include <fmt/format.h>

#include <algorithm>

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

/// The motion from a state, as a flow in (q, p) that is carried from time to time.
class Motion {
 public:
  Motion(const Problem& problem, const InitialState& state, const Location& at)
      : at_(at),
        flow_(*problem.lagrangian),
        method_(
            [this](double t, std::span<const double> y, std::span<double> s) { return flow_.slope(t, y, s); },
            2 * problem.coordinates()),
        y_(state.q) {
    const std::size_t n = state.q.size();
    options_.tolerance = 1e-10;
    options_.block = static_cast<int>(n);
    y_.resize(2 * n);
    if (!flow_.momentum(state.q, state.v, 0, std::span(y_).subspan(n)))
      throw SceneError(at, "L is not finite at the initial state of the guess");
  }

  /// q at time t, which does not fall.
  std::span<const double> at(double t) {
    if (t > t_ && method_.advance(t_, y_, t, options_) != Integrated::done)
      throw SceneError(
          at_, fmt::format("the initial state of the guess cannot be integrated beyond t = {:.6g}", t_));
    return std::span(y_).first(y_.size() / 2);
  }
  int steps() const { return method_.steps(); }

 private:
  Location at_;
  Flow flow_;
  Dop853 method_;
  IntegrationOptions options_;
  double t_ = 0;
  std::vector<double> y_;
};

}  // namespace

void integrate_state(const std::vector<Assignment>& values, const System& system, const Location& at,
                     Problem& problem) {
  constexpr int samples_a_step = 16;  // cubic interpolation then keeps about six digits
  const InitialState state = read_state(values, system);
  const double duration = problem.duration.value;
  Motion trial(problem, state, at);
  trial.at(duration);
  const int intervals = std::max(64, samples_a_step * trial.steps());
  Motion motion(problem, state, at);
  for (int k = 0; k <= intervals; ++k) {
    problem.guess.tau.push_back(double(k) / intervals);
    const std::span<const double> q = motion.at(k == intervals ? duration : duration * k / intervals);
    problem.guess.q.insert(problem.guess.q.end(), q.begin(), q.end());
  }
}

}  // namespace extremal
