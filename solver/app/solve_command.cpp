#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/sampling.hpp"
#include "report/csv.hpp"
#include "report/json.hpp"
#include "report/plot.hpp"
#include "report/text.hpp"
#include "study/study.hpp"

namespace extremal::app {
namespace {

constexpr int csv_samples = 201, plot_samples = 801;

/// One line that is written over, on a terminal.
class Progress {
 public:
  explicit Progress(bool wanted) : shown_(wanted && ::isatty(STDERR_FILENO)) {}
  ~Progress() {
    if (shown_) fmt::print(stderr, "\r\x1b[K");
  }
  std::function<void(const Iteration&)> callback() const {
    if (!shown_) return {};
    return [](const Iteration& i) {
      fmt::print(stderr, "\r\x1b[K{} elements of degree {}: residual {:.1e}, step {:.1e}", i.elements,
                 i.degree, i.residual, i.step);
      std::fflush(stderr);
    };
  }

 private:
  bool shown_;
};

/// Samples for --samples or --at; none where neither is given.
std::optional<Samples> wanted_samples(const SolveArguments& a, const std::vector<double>& at,
                                      const Study& study, const Solution& solution) {
  if (a.samples)
    return sample(study.problem, solution.trajectory, equal_times(a.samples, solution.duration()));
  if (at.empty()) return std::nullopt;
  check_times(at, solution.duration());
  return sample(study.problem, solution.trajectory, at);
}

/// One result for each solution of a search; the outer one has the fields of the first.
Result search_result(Result result, const std::vector<Solution>& solutions, const SolveArguments& a,
                     const std::vector<double>& at, const Study& study) {
  const Result empty = result;
  result.solutions.emplace();
  result.solution = solutions.front();
  if (!result.solution.converged()) return result;
  for (const Solution& solution : solutions) {
    Result each = empty;
    each.solution = solution;
    if (study.spectrum) each.spectrum = spectrum_of(study, *study.spectrum, solution);
    each.samples = wanted_samples(a, at, study, solution);
    result.solutions->push_back(std::move(each));
  }
  result.samples = result.solutions->front().samples;
  result.spectrum = result.solutions->front().spectrum;
  return result;
}

Samples sampled(const Study& study, const Result& result, int count) {
  return sample(study.problem, result.solution.trajectory, equal_times(count, result.solution.duration()));
}

void write_csv_of(const std::string& path, const Study& study, const Result& result) {
  const auto samples = [&](const Result& each) {
    return each.samples ? *each.samples : sampled(study, each, csv_samples);
  };
  write_output(path, [&](std::ostream& out) {
    if (!result.solutions) return write_csv(out, samples(result), result.names);
    std::vector<Samples> all;
    for (const Result& each : *result.solutions) all.push_back(samples(each));
    write_csv(out, all, result.names);
  });
}

Picture picture_of(const Study& study, const Result& result) {
  Picture picture{result.title, result.names, sampled(study, result, plot_samples)};
  if (!result.solutions || result.solutions->size() < 2) return picture;
  for (const Result& each : *result.solutions) {
    picture.labels.push_back(fmt::format("{}", picture.labels.size() + 1));
    if (picture.labels.size() > 1) picture.others.push_back(sampled(study, each, plot_samples));
  }
  return picture;
}

void write_outputs(const SolveArguments& a, const Study& study, const Result& result) {
  if (!a.output.empty()) write_output(a.output, [&](std::ostream& out) { write_json(out, result); });
  if (!result.solution.converged()) return;
  if (!a.csv.empty()) write_csv_of(a.csv, study, result);
  if (!a.plot.empty()) write_plot(a.plot, picture_of(study, result));
}

}  // namespace

int solve(const SolveArguments& a) {
  const bool table = !on_standard_output(a.output, a.csv) && !a.quiet;
  const std::vector<double> at = a.at.empty() ? std::vector<double>{} : parse_times(a.at);
  Study study = load(a.scene, a.sets);
  if (!study.problem.duration.free) check_times(at, study.problem.duration.value);

  Result result{study.title, study.problem.names, {}, study.seconds_read, std::nullopt};
  if (!study.problem.periodic) result.natural_conditions = study.problem.ends.free;
  {
    const Progress progress(!a.quiet && a.repeat == 1);
    study.options.progress = progress.callback();
    if (study.solutions == 0)
      result.solution = run(study, a.repeat);
    else
      result = search_result(std::move(result), run_all(study, a.repeat), a, at, study);
  }
  const bool converged = result.solution.converged();
  if (converged && study.solutions == 0) {
    result.samples = wanted_samples(a, at, study, result.solution);
    if (study.spectrum) result.spectrum = spectrum_of(study, *study.spectrum, result.solution);
  }
  write_outputs(a, study, result);
  if (table) fmt::print("{}", summary(result));
  if (!converged)
    fmt::print(stderr, "error: {}: {}: {}\n", a.scene, name(result.solution.status), result.solution.message);
  return converged ? Exit::done : Exit::not_converged;
}

}  // namespace extremal::app
