#include <fmt/format.h>

#include <cstdio>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "report/json.hpp"
#include "report/plot.hpp"
#include "report/text.hpp"
#include "study/study.hpp"

namespace extremal::app {

int spectrum(const SpectrumArguments& a) {
  const bool table = !on_standard_output(a.output, "") && !a.quiet;
  const Study study = load(a.scene, a.sets);
  Result result{study.title, study.problem.names, {}, study.seconds_read, std::nullopt};
  result.solution = run(study);
  const bool converged = result.solution.converged();
  if (converged)
    result.spectrum = spectrum_of(study, study.spectrum.value_or(SpectrumRequest{}), result.solution);
  if (!a.output.empty()) write_output(a.output, [&](std::ostream& out) { write_json(out, result); });
  if (!a.plot.empty() && converged) write_spectrum_plot(a.plot, result);
  if (table) fmt::print("{}", summary(result));
  if (!converged)
    fmt::print(stderr, "error: {}: {}: {}\n", a.scene, name(result.solution.status), result.solution.message);
  return converged ? Exit::done : Exit::not_converged;
}

}  // namespace extremal::app
