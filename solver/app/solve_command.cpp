#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/sampling.hpp"
#include "app/terminal.hpp"
#include "report/csv.hpp"
#include "report/json.hpp"
#include "report/plot.hpp"
#include "report/text.hpp"
#include "study/annotation.hpp"
#include "study/study.hpp"

namespace extremal::app {
namespace {

constexpr int csv_samples = 201;
/// A picture has so many equal steps, and so many in each element, which is short where the motion is fast;
/// of elements that are many, fewer.
constexpr int plot_steps = 800, element_steps = 8, most_element_steps = 20'000;

std::string progress_text(const Iteration& i) {
  return fmt::format("{} elements of degree {}: residual {:.1e}, step {:.1e}", i.elements, i.degree,
                     i.residual, i.step);
}

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

std::string csv_of(const Study& study, const Result& result) {
  const auto samples = [&](const Result& each) {
    return each.samples ? *each.samples : sampled(study, each, csv_samples);
  };
  return text_of([&](std::ostream& out) {
    if (!result.solutions) return write_csv(out, samples(result), result.names);
    std::vector<Samples> all;
    for (const Result& each : *result.solutions) all.push_back(samples(each));
    write_csv(out, all, result.names);
  });
}

Samples drawn(const Study& study, const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  std::vector<double> times = equal_times(plot_steps + 1, solution.duration());
  const int steps = std::min(element_steps, most_element_steps / trajectory.elements());
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int i = 0; i < steps; ++i)
      times.push_back(trajectory.times[k] + (trajectory.times[k + 1] - trajectory.times[k]) * i / steps);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return sample(study.problem, trajectory, times);
}

Picture picture_of(const Study& study, const Result& result, const Annotation& annotation) {
  Picture picture{.title = result.title,
                  .names = result.names,
                  .samples = drawn(study, result.solution),
                  .annotation = annotation};
  if (!result.solutions || result.solutions->size() < 2) return picture;
  for (const Result& each : *result.solutions) {
    picture.actions.push_back(each.solution.action);
    if (picture.actions.size() > 1) picture.others.push_back(drawn(study, each.solution));
  }
  return picture;
}

void write_outputs(const SolveArguments& a, const Study& study, const Result& result,
                   const Annotation& annotation) {
  std::vector<FileContent> files;
  if (!a.output.empty())
    files.push_back({a.output, text_of([&](std::ostream& out) { write_json(out, result); })});
  const bool converged = result.solution.converged();
  if (converged && !a.csv.empty()) files.push_back({a.csv, csv_of(study, result)});
  if (converged && !a.plot.empty())
    files.push_back({a.plot, plot_image(a.plot, picture_of(study, result, annotation))});
  Outputs::write(std::move(files));
}

}  // namespace

int solve(const SolveArguments& a) {
  const Outputs outputs({{"--output", a.output}, {"--csv", a.csv}, {"--plot", a.plot}});
  const bool table = !outputs.on_standard_output() && !a.quiet;
  const std::vector<double> at = a.at.empty() ? std::vector<double>{} : parse_times(a.at);
  Study study = load(a.scene, a.sets, Purpose::solution);
  outputs.keep(study.files);
  if (!study.problem.duration.free) check_times(at, study.problem.duration.value);
  const Annotation annotation = a.plot.empty() ? Annotation{} : extremal::annotation(study);

  Result result{study.title, study.problem.names, {}, study.seconds_read, std::nullopt};
  result.natural_conditions = natural_conditions(study.problem);
  {
    const ProgressLine progress(!a.quiet && a.repeat == 1);
    study.options.progress = progress.callback<Iteration>(progress_text);
    if (study.solutions == 0)
      result.solution = run(study, a.repeat);
    else
      result = search_result(std::move(result), run_all(study, a.repeat), a, at, study);
  }
  const bool converged = result.solution.converged();
  use_constants(result.solution, study);
  if (converged && study.solutions == 0) {
    result.samples = wanted_samples(a, at, study, result.solution);
    if (study.spectrum) result.spectrum = spectrum_of(study, *study.spectrum, result.solution);
  }
  write_outputs(a, study, result, annotation);
  if (table) print(summary(result));
  if (!converged)
    print_error(fmt::format("{}: {}: {}", a.scene, name(result.solution.status), result.solution.message));
  return converged ? Exit::done : Exit::not_converged;
}

}  // namespace extremal::app
