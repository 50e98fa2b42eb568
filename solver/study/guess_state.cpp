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

/// The motion from a state, as a flow in (q, p).
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
    options_.tolerance = 1e-12;
    options_.block = static_cast<int>(n);
    y_.resize(2 * n);
    between_.resize(2 * n);
    if (!flow_.momentum(state.q, state.v, 0, std::span(y_).subspan(n)))
      throw SceneError(at, "L is not finite at the initial state of the guess");
  }

  /// q from step to step until `duration`, as samples of a guess.
  void sample(double duration, Guess& guess) {
    constexpr int samples_a_step = 64;  // cubic interpolation then keeps about six digits
    const std::size_t n = y_.size() / 2;
    std::vector<double> q(y_.begin(), y_.begin() + n);
    const auto add = [&](double t) {
      guess.tau.push_back(t / duration);
      guess.q.insert(guess.q.end(), q.begin(), q.end());
    };
    add(0);
    for (double t = 0, before = 0; t < duration; before = t) {
      if (method_.accept_step(t, y_, duration, options_) != Integrated::done ||
          !method_.prepare_interpolation(y_, static_cast<int>(y_.size())))
        throw SceneError(
            at_, fmt::format("the initial state of the guess cannot be integrated beyond t = {:.6g}", t));
      for (int k = 1; k < samples_a_step; ++k) {
        const double theta = static_cast<double>(k) / samples_a_step;
        method_.interpolate(theta, between_);
        std::copy_n(between_.begin(), n, q.begin());
        add(before + theta * (t - before));
      }
      std::copy_n(y_.begin(), n, q.begin());
      add(t);
    }
  }

 private:
  Location at_;
  Flow flow_;
  Dop853 method_;
  IntegrationOptions options_;
  std::vector<double> y_, between_;
};

}  // namespace

void integrate_state(const std::vector<Assignment>& values, const System& system, const Location& at,
                     Problem& problem) {
  Motion(problem, read_state(values, system), at).sample(problem.duration.value, problem.guess);
  problem.guess.motion = true;
}

}  // namespace extremal
