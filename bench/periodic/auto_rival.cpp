#include "auto_rival.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace bench {
namespace {

const AutoEquations restricted{"cr3bp", 1}, bodies{"three_bodies", 4};
const std::map<std::string, AutoEquations> equations{
    {"halo", restricted}, {"lyapunov", restricted}, {"nrho", restricted}, {"figure-eight-near", bodies}};

constexpr int most_intervals = 400;
constexpr double growth = 1.4;
constexpr int least_intervals = 5;
/// Of the fastest, for a median; odd.
constexpr int repeats = 11;
/// A larger mesh is not tried after one that took so many times the fastest that is precise enough.
constexpr double too_slow = 3;

class Search {
 public:
  Search(const AutoProgram& program, const extremal::Study& study, const std::string& csv)
      : program_(program), study_(study), csv_(csv) {}

  std::vector<AutoResult> run(const AutoSetting& setting) const {
    std::vector<AutoResult> results;
    for (const AutoOrbit& orbit : program_.run(setting))
      results.push_back({.setting = setting,
                         .solves = static_cast<int>(results.size()) + 1,
                         .seconds = orbit.seconds,
                         .distance = distance_from_orbit(
                             csv_, study_, {orbit.period, [&orbit](double t) { return orbit.state(t); }})});
    return results;
  }

  /// Every setting, with growing meshes until they are precise enough for `error`.
  void try_all(double error) {
    for (const int degree : {4, 5, 6})
      for (const int factored : {3, 5})
        for (const double tolerance : {1e-2, 1e-4, 1e-6})
          for (double size = least_intervals; size <= most_intervals; size *= growth)
            if (!add({static_cast<int>(size), degree, tolerance, factored}, error)) break;
  }

  /// The fastest once measured often; another may be faster then.
  std::optional<AutoResult> best(double error) {
    while (true) {
      AutoResult* fastest = nullptr;
      for (AutoResult& result : tried_)
        if (result.distance <= error && !(fastest && fastest->seconds <= result.seconds)) fastest = &result;
      if (!fastest) return std::nullopt;
      if (fastest->repeats == repeats) return *fastest;
      fastest->seconds = median_seconds(*fastest);
      fastest->repeats = repeats;
    }
  }

 private:
  /// Whether a larger mesh is worth trying.
  bool add(const AutoSetting& setting, double error) {
    const std::vector<AutoResult> results = run(setting);
    bool enough = !results.empty() && results.front().seconds > too_slow * fastest_;
    for (const AutoResult& result : results) {
      tried_.push_back(result);
      if (!(result.distance <= error)) continue;
      fastest_ = std::min(fastest_, result.seconds);
      enough = true;
    }
    return !enough;
  }

  double median_seconds(const AutoResult& result) const {
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) seconds.push_back(run(result.setting)[result.solves - 1].seconds);
    std::nth_element(seconds.begin(), seconds.begin() + repeats / 2, seconds.end());
    return seconds[repeats / 2];
  }

  const AutoProgram& program_;
  const extremal::Study& study_;
  const std::string& csv_;
  std::vector<AutoResult> tried_;
  double fastest_ = INFINITY;
};

}  // namespace

AutoRival measure_auto(const AutoInstallation& installation, const std::string& scene,
                       const extremal::Study& study, const std::string& csv,
                       const std::vector<double>& errors) {
  const auto system = equations.find(scene);
  if (system == equations.end()) return {.absence = "no equations written for it", .results = {}};
  try {
    const AutoProgram program(installation, system->second, study);
    Search search(program, study, csv);
    search.try_all(*std::min_element(errors.begin(), errors.end()));
    AutoRival rival;
    for (const double error : errors) rival.results.push_back(search.best(error));
    return rival;
  } catch (const std::runtime_error& missing) {
    return {.absence = missing.what(), .results = {}};
  }
}

}  // namespace bench
