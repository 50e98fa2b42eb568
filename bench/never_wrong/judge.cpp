#include "judge.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "reference.hpp"
#include "report/json.hpp"
#include "rivals/verify.hpp"
#include "scene/source.hpp"
#include "study/phase.hpp"
#include "study/study.hpp"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int samples = 33;
/// What the contract allows, and ten times that: as far as a verification by integration judges.
constexpr double margin = 10;
/// Parts of the range below which nothing is known of an error.
constexpr double floor_of_errors = 1e-13;

extremal::Samples sample(const extremal::Problem& problem, const extremal::Trajectory& trajectory) {
  const std::size_t n = problem.coordinates();
  const std::vector<extremal::Column> columns(n, extremal::Column(samples));
  extremal::Samples result{extremal::Column(samples), columns, columns, columns};
  std::vector<double> q(n), v(n), p(n);
  extremal::Scratch scratch;
  for (int k = 0; k < samples; ++k) {
    result.t[k] = k + 1 == samples ? trajectory.duration() : trajectory.duration() * k / (samples - 1);
    phase_point(problem, trajectory, result.t[k], q, v, p, scratch);
    for (std::size_t a = 0; a < n; ++a) {
      result.q[a][k] = q[a];
      result.v[a][k] = v[a];
      result.p[a][k] = p[a];
    }
  }
  return result;
}

class Judge {
 public:
  Judge(Verdict& verdict, const extremal::Study& study, const extremal::Solution& solution)
      : verdict_(verdict),
        study_(study),
        solution_(solution),
        adapted_(study.options.elements == 0),
        size_(solution.converged() ? size_of(study, solution.trajectory) : 1) {}

  void run() {
    check_written();
    if (!solution_.converged()) return;
    check_windows();
    if (adapted_) check_motion();
    check_error();
  }

 private:
  void blame(const std::string& kind, const std::string& detail) {
    verdict_.faults.push_back({kind, detail});
  }

  /// The result must be JSON without infinities.
  void check_written() {
    std::ostringstream out;
    extremal::Result result{study_.title, study_.problem.names, solution_, study_.seconds_read, std::nullopt};
    try {
      if (solution_.converged()) result.samples = sample(study_.problem, solution_.trajectory);
      write_json(out, result);
      const nlohmann::json read = nlohmann::json::parse(out.str());
      if (solution_.converged() != (read.at("status") == "converged")) blame("invalid", "status");
      if (read.at("message").get<std::string>().empty() && !solution_.converged())
        blame("invalid", "a failure without a message");
    } catch (const std::exception& e) {
      blame("invalid", e.what());
    }
  }

  void check_windows() {
    const double duration = solution_.duration();
    double before = 0;
    for (const auto& [from, to] : solution_.windows) {
      if (from != before || !(to > from)) blame("invalid", fmt::format("a window from {} to {}", from, to));
      before = to;
    }
    if (!solution_.windows.empty() && before != duration)
      blame("invalid", fmt::format("windows end at {} of {}", before, duration));
    before = 0;
    for (const double time : solution_.conjugate_times) {
      if (!(time >= before && time > 0 && time < duration))
        blame("invalid", fmt::format("conjugate time {} after {}, duration {}", time, before, duration));
      before = time;
    }
    if (verdict_.scene.kind != "fixed" || solution_.windows.empty() || !solution_.morse_index) return;
    const auto conjugate = static_cast<int>(solution_.conjugate_times.size());
    if (conjugate != *solution_.morse_index && solution_.nullity == 0)
      blame("index", fmt::format("index {} with {} conjugate times", *solution_.morse_index, conjugate));
  }

  /// What is refuted must be so with the integrator a hundred times more precise as well.
  void check_motion() {
    const double tolerance = study_.options.tolerance;
    const extremal::VerifyOptions plain{.tolerance = tolerance, .margin = margin},
        precise{.tolerance = tolerance / 100, .margin = 100 * margin};
    const extremal::Verification found = verify(study_.problem, solution_.trajectory, plain);
    if (found.verified) return;
    const extremal::Verification again = verify(study_.problem, solution_.trajectory, precise);
    if (!again.verified) blame(again.distance ? "error" : "false", again.message);
  }

  void check_error() {
    const std::optional<TrueError> error = error_by_reference(study_, solution_);
    verdict_.referred = error.has_value();
    if (!error) return;
    const double least = 10 * error->q_unknown + floor_of_errors * size_;
    if (adapted_) compare_with_contract(*error, least);
    if (error->q <= least) return;
    verdict_.estimate_over = solution_.error_estimate / error->q;
    if (*verdict_.estimate_over >= 0.01) return;
    const std::optional<double> shot = error_by_shooting(study_, solution_);
    const std::string detail =
        fmt::format("estimate {:.3g}, error {:.3g} by a reference of {:.3g}, {:.3g} by shooting",
                    solution_.error_estimate, error->q, error->q_unknown, shot.value_or(-1));
    if (shot && solution_.error_estimate >= 0.01 * *shot)
      verdict_.estimate_over.reset();  // the reference is another extremal
    else
      blame(adapted_ ? "estimate" : "pinned estimate", detail);
  }

  void compare_with_contract(const TrueError& error, double least) {
    const double tolerance = study_.options.tolerance;
    verdict_.error = error.q > least ? error.q / (tolerance * size_) : 0;
    const auto part = [&](double difference, double range) {
      const double allowed = 10 * (tolerance + floor_of_errors + error.q_unknown / size_) * range;
      return difference > 0 ? difference / allowed : 0;
    };
    verdict_.velocity = part(error.v, error.v_range);
    verdict_.momentum = part(error.p, error.p_range);
  }

  Verdict& verdict_;
  const extremal::Study& study_;
  const extremal::Solution& solution_;
  const bool adapted_;
  const double size_;
};

}  // namespace

void judge(Verdict& verdict, const std::string& scratch, const std::function<void()>& solved) {
  write_text(scratch, verdict.scene.text);
  const auto start = Clock::now();
  const auto clock = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  try {
    const extremal::Study study = extremal::load(scratch);
    const extremal::Solution solution = run(study);
    verdict.seconds = clock();
    verdict.status = name(solution.status);
    verdict.message = solution.message;
    verdict.tolerance = study.options.elements > 0 ? 0 : study.options.tolerance;
    solved();
    Judge(verdict, study, solution).run();
  } catch (const extremal::SceneError& e) {
    verdict.status = "refused";
    verdict.message = e.what();
    verdict.seconds = clock();
  } catch (const std::exception& e) {
    verdict.faults.push_back({"exception", e.what()});
    if (verdict.status.empty()) verdict.status = "exception";
  }
}

}  // namespace bench
