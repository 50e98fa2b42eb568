#include "judge.hpp"

#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>
#include <sstream>

#include "judge_several.hpp"
#include "recurrence.hpp"
#include "reference.hpp"
#include "refute.hpp"
#include "report/json.hpp"
#include "scene/source.hpp"
#include "study/phase.hpp"
#include "study/study.hpp"

namespace bench {
namespace {

constexpr int samples = 33;
/// Parts of the range below which nothing is known of an error.
constexpr double floor_of_errors = 1e-13;
/// An estimate below this part of the error is wrong.
constexpr double least_estimate = 0.01;
/// A pinned discretisation further off than this part of the range may belong to another extremal.
constexpr double recognisable = 0.1;

double processor_seconds() {
  timespec now;
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

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
  }

  void check_error() {
    const std::optional<TrueError> error = error_by_reference(study_, solution_);
    verdict_.referred = error.has_value();
    if (adapted_) {
      for (const Fault& fault : refute(study_, solution_, error)) verdict_.faults.push_back(fault);
      for (const Fault& fault : deny_recurrence(study_, solution_)) verdict_.faults.push_back(fault);
    }
    if (!error) return;
    const double least = 10 * error->q_unknown + floor_of_errors * size_;
    if (adapted_) compare_with_contract(*error, least);
    if (error->q > least && (adapted_ || error->q < recognisable * size_)) check_estimate(*error);
  }

  void check_estimate(const TrueError& error) {
    verdict_.estimate_over = solution_.error_estimate / error.q;
    if (*verdict_.estimate_over >= least_estimate) return;
    const std::optional<double> shot = error_by_shooting(study_, solution_);
    // Where shooting tells no more than the estimate does, the reference is another extremal.
    if (shot && solution_.error_estimate >= least_estimate * (*shot - floor_of_errors * size_))
      verdict_.estimate_over.reset();
    else
      blame(adapted_ ? "estimate" : "pinned estimate",
            fmt::format("estimate {:.3g}, error {:.3g} by a reference of {:.3g}, {:.3g} by shooting",
                        solution_.error_estimate, error.q, error.q_unknown, shot.value_or(-1)));
  }

  void compare_with_contract(const TrueError& error, double least) {
    const double tolerance = study_.options.tolerance;
    const double roundoff = velocity_roundoff(solution_.trajectory) / error.v_range;
    verdict_.error = error.q > least ? error.q / (tolerance * size_) : 0;
    const auto part = [&](double difference, double range) {
      const double allowed =
          (10 * (tolerance + floor_of_errors + 10 * error.q_unknown / size_) + roundoff) * range;
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
  const double start = processor_seconds();
  try {
    const extremal::Study study = extremal::load(scratch);
    verdict.tolerance = study.options.elements > 0 ? 0 : study.options.tolerance;
    const auto note = [&](const char* status, const std::string& message) {
      verdict.seconds = processor_seconds() - start;
      verdict.status = status;
      verdict.message = message;
      solved();
    };
    if (study.continuation) {
      const extremal::FollowedBranch branch = follow(study);
      note(branch.points.empty() ? "not-converged" : "converged", branch.branches.front().message);
      verdict.faults = deny_family(study, branch);
      return;
    }
    if (study.solutions > 0) {
      const std::vector<extremal::Solution> found = run_all(study);
      note(name(found.front().status), found.front().message);
      verdict.faults = deny_search(study, found);
      return;
    }
    const extremal::Solution solution = run(study);
    verdict.residual = solution.residual;
    note(name(solution.status), solution.message);
    Judge(verdict, study, solution).run();
  } catch (const extremal::SceneError& e) {
    verdict.status = "refused";
    verdict.message = e.what();
    verdict.seconds = processor_seconds() - start;
  } catch (const std::exception& e) {
    verdict.faults.push_back({"exception", e.what()});
    if (verdict.status.empty()) verdict.status = "exception";
  }
}

}  // namespace bench
