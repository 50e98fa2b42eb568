#include <fmt/format.h>

#include <utility>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/terminal.hpp"
#include "report/json.hpp"
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

std::string spectrum_plot(const std::string& path, const Study& study, const Result& result,
                          const Annotation& annotation) {
  return is_page(path) ? page(result, picture_of(study.problem, result, annotation))
                       : spectrum_image(path, result);
}

}  // namespace

int spectrum(const SceneArguments& a) {
  const Outputs outputs({{"--output", a.output}, {"--plot", a.plot}});
  Study study = load(a.scene, a.sets, Purpose::solution);
  outputs.keep(study.files);
  const Annotation annotation = is_page(a.plot) ? extremal::annotation(study) : Annotation{};
  Result result{study.title, coordinate_names(study.problem), {}, study.seconds_read, std::nullopt};
  result.natural_conditions = natural_conditions(study.problem);
  if (study.fit) {
    FitResult fit = run_fit(study);
    result.solution = std::move(fit.solution);
    if (result.solution.converged()) use_fitted(fit.values, study);
  } else {
    result.solution = run(study);
  }
  const bool converged = result.solution.converged();
  use_constants(result.solution, study);
  if (converged) add_spectrum(study, study.spectrum.value_or(SpectrumRequest{}), result);
  std::vector<FileContent> files;
  if (!a.output.empty())
    files.push_back({.path = a.output, .write = [&](std::ostream& out) { write_json(out, result); }});
  if (converged && !a.plot.empty())
    files.push_back({a.plot, spectrum_plot(a.plot, study, result, annotation)});
  Outputs::write(std::move(files));
  if (!outputs.on_standard_output() && !a.quiet) print(summary(result));
  if (!converged)
    print_error(fmt::format("{}: {}: {}", a.scene, name(result.solution.status), result.solution.message));
  return converged ? Exit::done : Exit::not_converged;
}

}  // namespace extremal::app
