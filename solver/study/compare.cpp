#include "study/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "machine/clock.hpp"
#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "rivals/shooting.hpp"
#include "rivals/verify.hpp"
#include "solution/observe.hpp"
#include "study/deviation.hpp"

namespace extremal {
namespace {

/// Tolerances tried for the reference, from the tightest on, powers of ten.
constexpr int tightest = -14, loosest = -6;
constexpr int most_repeats = 1001;
/// Of the steps of a motion that was shot, relative, where it is compared.
constexpr double precise = 1e-13;

struct ShootingMethod {
  const char* name;
  int segments;
  int most_coordinates;  ///< beyond, its variations take too long
};
constexpr ShootingMethod shooting_methods[] = {{"single shooting", 1, 500},
                                               {"multiple shooting, 8 segments", 8, 40},
                                               {"multiple shooting, 32 segments", 32, 40}};

int repeats(double row_seconds, double seconds) {
  return seconds > 0 ? static_cast<int>(std::clamp(row_seconds / seconds, 1.0, double(most_repeats))) : 1;
}

class Comparer {
 public:
  Comparer(const Study& study, const CompareOptions& options)
      : study_(study),
        options_(options),
        total_(deadline_of(study)),
        invariance_(invariance_of(study.problem)) {
    study_.options.elements = 0;
    study_.options.progress = nullptr;
    result_.title = study.title;
  }

  Comparison run() {
    if (study_.problem.extension)
      throw std::invalid_argument("shooting knows no integrals, unknowns, nonlinear conditions or waypoints");
    if (study_.problem.initial) return run_motions();
    std::vector<ShootingMethod> shooting(std::begin(shooting_methods), std::end(shooting_methods));
    std::erase_if(shooting, [this](const ShootingMethod& method) {
      // In phase space shooting would look for q' and p', which Hamilton's equations give.
      return study_.problem.phase || study_.problem.coordinates() > method.most_coordinates;
    });
    int parties = 2 + static_cast<int>(shooting.size());
    share_among(parties--);
    find_reference();
    share_among(parties--);
    run_method([this](double tolerance) { return solve(tolerance); });
    if (nothing_found()) return result_;
    for (const ShootingMethod& method : shooting) {
      share_among(parties--);
      run_method([&](double tolerance) { return shoot_row(method, tolerance); });
    }
    return result_;
  }

 private:
  /// From initial data: the march beside integration.
  Comparison run_motions() {
    share_among(3);
    find_reference();
    share_among(2);
    run_method([this](double tolerance) { return solve(tolerance); });
    share_among(1);
    run_method([this](double tolerance) { return integrate_row(tolerance); });
    return result_;
  }

  /// Neither a reference nor a time: others have nothing to be compared with.
  bool nothing_found() const {
    return !result_.reference && std::ranges::none_of(result_.rows, [](const ComparisonRow& row) {
      return row.status == Status::converged;
    });
  }

  /// Of what is left of the budget, for the next of so many.
  void share_among(int parties) { study_.options.deadline = total_.share(1.0 / parties); }
  const Deadline& deadline() const { return study_.options.deadline; }

  void find_reference() {
    Study study = study_;
    study.options = study.options.adaptive();
    for (int power = tightest; power <= loosest && !deadline().passed(); ++power) {
      study.options.tolerance = std::pow(10.0, power);
      Solution solution = extremal::run(study);
      result_.message = solution.message;
      if (!solution.converged()) continue;
      const Verification found = verify(study.problem, solution.trajectory,
                                        {.tolerance = study.options.tolerance, .deadline = deadline()});
      result_.message = found.message;
      if (!found.verified) continue;
      reference_ = std::move(solution.trajectory);
      const Survey survey = extremal::survey(*study.problem.lagrangian, reference_);
      result_.reference = {study.options.tolerance, solution.error_estimate,
                           *std::max_element(survey.q.begin(), survey.q.end())};
      result_.message = fmt::format("solved at tolerance {:.0e}, verified by integration in {} pieces",
                                    study.options.tolerance, found.pieces);
      return;
    }
    if (deadline().passed())
      result_.message += fmt::format("; {} (solve.budget) is spent; raise it", deadline().budget_text());
    result_.message = "no reference: " + result_.message;
  }

  template <class Run>
  void run_method(const Run& run) {
    for (const double tolerance : options_.tolerances) {
      if (deadline().passed()) return;
      result_.rows.push_back(run(tolerance));
      if (options_.progress) options_.progress(result_.rows.back());
    }
  }

  ComparisonRow solve(double tolerance) {
    study_.options.tolerance = tolerance;
    Solution solution = extremal::run(study_);
    if (const int more = repeats(options_.row_seconds, solution.seconds_solve + solution.seconds_analyse);
        more > 1)
      solution = extremal::run(study_, more);
    const std::string scheme = study_.options.scheme ? ", " + study_.options.scheme->name : "";
    ComparisonRow row{"extremal" + scheme, tolerance, solution.seconds_solve, std::nullopt, solution.status};
    if (solution.converged() && result_.reference) row.error = error(motion_of(solution.trajectory));
    return row;
  }

  ComparisonRow shoot_row(const ShootingMethod& method, double tolerance) {
    std::vector<double> seconds;
    Shot shot;
    double spent = 0;
    do {
      const auto start = Clock::now();
      shot = shoot(study_.problem,
                   {.tolerance = tolerance, .segments = method.segments, .deadline = deadline()});
      seconds.push_back(seconds_since(start));
      spent += seconds.back();
    } while (spent < options_.row_seconds && seconds.size() < most_repeats);
    ComparisonRow row{method.name, tolerance, median(std::move(seconds)), std::nullopt, shot.status};
    if (shot.converged() && result_.reference)
      row.error = error({shot.duration(), [&](const std::vector<double>& times) {
                           Flight flight = follow(study_.problem.motion(), shot, times, precise, deadline(),
                                                  study_.problem.motion_copies());
                           return MotionSamples{std::move(flight.q), std::move(flight.v)};
                         }});
    if (shot.converged() && result_.reference && !row.error) row.status = Status::not_converged;
    return row;
  }

  /// The motion by the method of Dormand and Prince, each step to the tolerance.
  ComparisonRow integrate_row(double tolerance) {
    const InitialData& initial = *study_.problem.initial;
    const std::size_t n = initial.q.size();
    const double duration = study_.problem.duration.value;
    ComparisonRow row{"dop853", tolerance, 0, std::nullopt, Status::not_converged};
    const int copies = study_.problem.motion_copies();
    if (!Flow::suits(study_.problem.motion(), copies)) return row;
    Flow flow(study_.problem.motion(), copies);
    const IntegrationOptions options{
        .tolerance = tolerance, .block = static_cast<int>(n), .deadline = deadline()};
    std::vector<double> y(2 * n), between(2 * n), v(n);
    // To the end; with the states at ascending times, row by row, where these are asked for.
    const auto integrate = [&](const std::vector<double>& times, MotionSamples& samples) {
      std::copy(initial.q.begin(), initial.q.end(), y.begin());
      std::copy(initial.p.begin(), initial.p.end(), y.begin() + static_cast<std::ptrdiff_t>(n));
      Dop853 integrator([&flow](double at, auto state, auto slope) { return flow.slope(at, state, slope); },
                        static_cast<int>(2 * n));
      auto next = times.begin();
      for (double t = 0, before = 0; t < duration; before = t) {
        if (integrator.accept_step(t, y, duration, options) != Integrated::done) return false;
        if (next == times.end()) continue;
        if (!integrator.prepare_interpolation(y, static_cast<int>(2 * n))) return false;
        for (; next != times.end() && *next <= t; ++next) {
          integrator.interpolate((*next - before) / (t - before), between);
          const std::span<const double> state(between);
          if (!flow.velocity(state.first(n), state.subspan(n), *next, v)) return false;
          samples.q.insert(samples.q.end(), state.begin(), state.begin() + static_cast<std::ptrdiff_t>(n));
          samples.v.insert(samples.v.end(), v.begin(), v.end());
        }
      }
      return true;
    };
    std::vector<double> seconds;
    double spent = 0;
    bool done = true;
    do {
      MotionSamples end;
      const auto start = Clock::now();
      done = integrate({}, end);
      seconds.push_back(seconds_since(start));
      spent += seconds.back();
    } while (done && spent < options_.row_seconds && seconds.size() < most_repeats);
    row.seconds = median(std::move(seconds));
    if (!done) return row;
    row.status = Status::converged;
    if (result_.reference)
      row.error = error({duration, [&](const std::vector<double>& times) {
                           MotionSamples samples;
                           integrate(times, samples);
                           return samples;
                         }});
    return row;
  }

  /// Never below what the reference can tell; nothing where the motion cannot be followed to its end.
  std::optional<double> error(const Motion& motion) const {
    const double apart = deviation(motion, motion_of(reference_), study_.problem.coordinates(), invariance_);
    if (!std::isfinite(apart)) return std::nullopt;
    return std::max(apart, result_.reference->error_estimate);
  }

  Study study_;
  const CompareOptions& options_;
  const Deadline total_;
  const Invariance invariance_;
  Trajectory reference_;
  Comparison result_;
};

}  // namespace

bool Comparison::any() const {
  return std::any_of(rows.begin(), rows.end(),
                     [](const ComparisonRow& row) { return row.error.has_value(); });
}

Comparison compare(const Study& study, const CompareOptions& options) {
  return Comparer(study, options).run();
}

}  // namespace extremal
