#include <fmt/format.h>

#include <utility>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/sampling.hpp"
#include "app/terminal.hpp"
#include "report/csv.hpp"
#include "report/fitted.hpp"
#include "report/json.hpp"
#include "report/oem.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"
#include "report/sampling.hpp"
#include "report/text.hpp"
#include "study/annotation.hpp"
#include "study/fitting.hpp"
#include "study/phase.hpp"
#include "study/study.hpp"

namespace extremal::app {
namespace {

constexpr int csv_samples = 201;  ///< of a CSV and an ephemeris
constexpr int fit_samples = 241;

std::string progress_text(const Iteration& i) {
  return fmt::format("{} elements of degree {}: residual {:.1e}, step {:.1e}", i.elements, i.degree,
                     i.residual, i.step);
}

/// Samples for --samples or --at; none where neither is given.
std::optional<Samples> wanted_samples(const SolveArguments& a, const std::vector<double>& at,
                                      const Study& study, const Solution& solution) {
  if (a.samples) return sample(study.problem, solution, equal_times(a.samples, solution.duration()));
  if (at.empty()) return std::nullopt;
  check_times(at, solution.duration());
  return sample(study.problem, solution, at);
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
    if (study.spectrum) add_spectrum(study, *study.spectrum, each);
    each.samples = wanted_samples(a, at, study, solution);
    result.solutions->push_back(std::move(each));
  }
  result.samples = result.solutions->front().samples;
  result.spectrum = result.solutions->front().spectrum;
  result.solution.message = result.solutions->front().solution.message;
  return result;
}

std::string fit_progress_text(const FitStep& step) {
  return fmt::format("fit, {} elements of degree {}: iteration {}, chi squared {:.6g}", step.elements,
                     step.degree, step.iteration, step.chi_squared);
}

Samples sampled(const Study& study, const Result& result, int count) {
  return sample(study.problem, result.solution, equal_times(count, result.solution.duration()));
}

/// Those of --samples and --at, else some; `kept` holds them then.
const Samples& file_samples(const Study& study, const Result& result, std::optional<Samples>& kept) {
  if (result.samples) return *result.samples;
  return kept.emplace(sampled(study, result, csv_samples));
}

void write_csv(std::ostream& out, const Study& study, const Result& result) {
  std::optional<Samples> kept;
  if (!result.solutions) return extremal::write_csv(out, file_samples(study, result, kept), result.names);
  std::vector<Samples> all;
  for (const Result& each : *result.solutions) all.push_back(file_samples(study, each, kept));
  extremal::write_csv(out, all, result.names);
}

std::string npz_of(const Study& study, const Result& result) {
  std::optional<Samples> kept;
  return npz_text(file_samples(study, result, kept), result.names);
}

/// Before anything is computed.
void check_ephemeris(const Study& study) {
  if (!study.units)
    throw OptionError(fmt::format(
        "--oem: {} has no [units]; give length in km, time in s, frame, centre and epoch", study.scene));
  try {
    check_oem(coordinate_names(study.problem));
  } catch (const std::invalid_argument& e) {
    throw OptionError(fmt::format("--oem: {}", e.what()));
  }
}

void write_ephemeris(std::ostream& out, const Study& study, const Result& result) {
  std::optional<Samples> kept;
  write_oem(out, *study.units, result.title, result.names, file_samples(study, result, kept));
}

std::string plot_of(const std::string& path, const Study& study, const Result& result,
                    const Annotation& annotation) {
  if (is_page(path)) return page(result, picture_of(study.problem, result, annotation, true));
  if (result.fit) return fit_image(path, result, sampled(study, result, fit_samples), annotation);
  return plot_image(path, picture_of(study.problem, result, annotation));
}

void write_outputs(const SolveArguments& a, const Study& study, const Result& result,
                   const Annotation& annotation) {
  std::vector<FileContent> files;
  if (!a.output.empty())
    files.push_back({.path = a.output, .write = [&](std::ostream& out) { write_json(out, result); }});
  const bool converged = result.solution.converged();
  if (converged && !a.csv.empty())
    files.push_back({.path = a.csv, .write = [&](std::ostream& out) { write_csv(out, study, result); }});
  if (converged && !a.npz.empty()) files.push_back({a.npz, npz_of(study, result)});
  if (converged && !a.oem.empty())
    files.push_back(
        {.path = a.oem, .write = [&](std::ostream& out) { write_ephemeris(out, study, result); }});
  if (converged && !a.plot.empty()) files.push_back({a.plot, plot_of(a.plot, study, result, annotation)});
  Outputs::write(std::move(files));
}

}  // namespace

int solve(const SolveArguments& a) {
  const Outputs outputs(
      {{"--output", a.output}, {"--csv", a.csv}, {"--npz", a.npz}, {"--oem", a.oem}, {"--plot", a.plot}});
  const bool table = !outputs.on_standard_output() && !a.quiet;
  const std::vector<double> at = a.at.empty() ? std::vector<double>{} : parse_times(a.at);
  Study study = load(a.scene, a.sets, Purpose::solution);
  outputs.keep(study.files);
  if (!a.oem.empty()) check_ephemeris(study);
  if (!study.problem.duration.free) check_times(at, study.problem.duration.value);
  const bool annotated = !a.plot.empty() || !a.output.empty();
  const Annotation annotation = annotated ? extremal::annotation(study) : Annotation{};

  Result result{study.title, coordinate_names(study.problem), {}, study.seconds_read, std::nullopt};
  result.natural_conditions = natural_conditions(study.problem);
  {
    const ProgressLine progress(!a.quiet && a.repeat == 1);
    study.options.progress = progress.callback<Iteration>(progress_text);
    if (study.fit) {
      FitResult fit = run_fit(study, a.repeat, progress.callback<FitStep>(fit_progress_text));
      result.solution = std::move(fit.solution);
      if (result.solution.converged()) {
        result.fit = fitted_of(*study.fit, fit);
        use_fitted(fit.values, study);
      }
    } else if (study.solutions == 0)
      result.solution = run(study, a.repeat);
    else
      result = search_result(std::move(result), run_all(study, a.repeat), a, at, study);
  }
  const bool converged = result.solution.converged();
  use_constants(result.solution, study);
  if (converged && study.solutions == 0) {
    result.samples = wanted_samples(a, at, study, result.solution);
    if (study.spectrum) add_spectrum(study, *study.spectrum, result);
  }
  if (!a.output.empty()) add_surroundings(study, result);
  write_outputs(a, study, result, annotation);
  if (table) print(summary(result));
  if (!converged)
    print_error(fmt::format("{}: {}: {}", a.scene, name(result.solution.status), result.solution.message));
  return converged ? Exit::done : Exit::not_converged;
}

}  // namespace extremal::app
