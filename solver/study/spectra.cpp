#include "study/spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "study/files/json_file.hpp"
#include "study/guess/guess.hpp"
#include "study/study.hpp"

namespace extremal {
namespace {

using Json = nlohmann::json;

/// Lines that leave more than this of the largest do not describe a motion. Where none turns once along the
/// arc they must leave no more than so many tolerances: a constant and a drift are near any short arc.
constexpr double resolved_part = 1e-3, resolved_tolerances = 100;

/// Nodes of a scheme are what it computes; samples are at equal steps.
bool samples_nodes(const SolveOptions& options) { return options.elements > 0 && !options.free_steps; }

std::vector<PointMass> measure_of(const Spectrum& spectrum) {
  std::vector<PointMass> measure;
  for (const SpectralLine& line : spectrum.lines) measure.push_back({line.frequency, line.amplitude});
  return measure;
}

/// Of the largest amplitude, what the lines leave.
double part_left(const Spectrum& spectrum) {
  double largest = 0;
  for (const SpectralLine& line : spectrum.lines) largest = std::max(largest, line.amplitude);
  return largest > 0 ? spectrum.residual / largest : 0;
}

bool resolved(const Spectrum& spectrum, double duration, double tolerance) {
  const bool turns = std::ranges::any_of(spectrum.lines, [&](const SpectralLine& line) {
    return line.amplitude > spectrum.residual &&
           std::abs(line.frequency) * duration >= 0.999 * 2 * std::numbers::pi;
  });
  return part_left(spectrum) <=
         (turns ? resolved_part : std::min(resolved_part, resolved_tolerances * tolerance));
}

double finite(const Json& line, const char* key, const Location& whole) {
  const auto found = line.is_object() ? line.find(key) : line.end();
  if (!line.is_object() || found == line.end() || !found->is_number() || !std::isfinite(found->get<double>()))
    throw SceneError(whole, fmt::format("a line of the spectrum has no number '{}'", key));
  return found->get<double>();
}

std::vector<std::vector<PointMass>> read_measures(const std::string& path,
                                                  const std::vector<std::string>& names) {
  const Location whole{read_source(path), 0, 0};
  const std::string mend = "write one with extremal spectrum SCENE --output FILE";
  const Json root = parse_json(whole.source, mend);
  const auto spectrum = root.is_object() ? root.find("spectrum") : root.end();
  if (!root.is_object() || spectrum == root.end() || !spectrum->is_object())
    throw SceneError(whole, "this result has no spectrum; " + mend);
  std::vector<std::vector<PointMass>> measures;
  for (const std::string& name : names) {
    const auto lines = spectrum->find(name);
    if (lines == spectrum->end() || !lines->is_array())
      throw SceneError(whole, fmt::format("the spectrum has no lines of '{}'", name));
    measures.emplace_back();
    for (const Json& line : *lines)
      measures.back().push_back({finite(line, "frequency", whole), finite(line, "amplitude", whole)});
  }
  return measures;
}

}  // namespace

SpectrumRequest read_spectrum(const SpectrumTable& table, const std::string& scene,
                              const std::vector<std::string>& names) {
  SpectrumRequest request;
  if (table.lines) request.lines = static_cast<int>(table.lines->value);
  if (table.against) {
    const std::string path = beside(scene, table.against->value);
    require_file(path, *table.against);
    request.against = read_measures(path, names);
  }
  return request;
}

void check_samples(const Study& study, const Location& elements) {
  const int count = study.options.elements, least = static_cast<int>(least_spectral_samples) - 1;
  if (samples_nodes(study.options) && !study.problem.periodic && count < least)
    throw SceneError(elements,
                     fmt::format("elements = {}; a spectrum of values at nodes needs {} elements; write "
                                 "that or more, or leave 'scheme' and 'elements' out",
                                 count, least));
}

SolutionSpectrum spectrum_of(const Study& study, const SpectrumRequest& request, const Solution& solution) {
  const Sampling sampling = samples_nodes(study.options) ? Sampling::nodes : Sampling::dense;
  SolutionSpectrum result{
      motion_spectrum(study.problem, solution.trajectory, sampling, request.lines, study.options.tolerance),
      {}};
  if (!request.against) return result;
  for (std::size_t a = 0; a < request.against->size(); ++a) {
    std::vector<PointMass> difference = measure_of(result.motion.coordinates[a]);
    for (const PointMass& mass : (*request.against)[a]) difference.push_back({mass.at, -mass.weight});
    result.flat_norm.push_back(flat_norm(std::move(difference)));
  }
  return result;
}

std::string unresolved_lines(const Study& study, const SolutionSpectrum& spectrum, double duration) {
  std::string text;
  for (std::size_t a = 0; a < spectrum.motion.coordinates.size(); ++a)
    if (const Spectrum& lines = spectrum.motion.coordinates[a];
        !resolved(lines, duration, study.options.tolerance))
      text += fmt::format(
          "; the lines of {} leave {:.2g} of the largest: too short an arc, too few lines, or a motion "
          "without lines",
          study.problem.names[a], part_left(lines));
  return text;
}

}  // namespace extremal
