#include "auto_program.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "rivals/guessed_path.hpp"

namespace bench {
namespace {

namespace fs = std::filesystem;
using Eigen::VectorXd;

constexpr int solves = 3;
constexpr int most_iterations = 20;
/// Weight in AUTO's norm of the parameter that it continues in, on which nothing depends: so large that the
/// predictor leaves the orbit alone.
constexpr double weight = 1e10;

bool succeeds(const std::string& command) { return std::system(command.c_str()) == 0; }

void compile(const AutoInstallation& installation, const std::string& equations, const std::string& folder) {
  if (!fs::exists(installation.folder + "/lib/main.o"))
    throw std::runtime_error(fmt::format("no AUTO-07p in {} (Debian: auto-07p)", installation.folder));
  if (!succeeds(fmt::format("command -v {} >/dev/null", installation.compiler)))
    throw std::runtime_error(fmt::format("no {}, which links it", installation.compiler));
  const std::string sources = EXTREMAL_SOURCE_DIR "/bench/periodic/auto/";
  // as AUTO's own cmds.make does
  if (!succeeds(fmt::format("cd {0} && {1} -O2 -std=legacy -fopenmp '{2}stopwatch.f90' '{2}{3}.f90' "
                            "{4}/lib/*.o -o program >log 2>&1",
                            folder, installation.compiler, sources, equations, installation.folder)))
    throw std::runtime_error(
        fmt::format("{} does not compile AUTO-07p with {}.f90", installation.compiler, equations));
}

/// What is the same for each setting. The first free parameter is the one that nothing depends on.
std::string constants(const extremal::Study& study, const VectorXd& first, int unfolding) {
  const auto& problem = study.problem;
  const bool free = problem.duration.energy.has_value();
  std::vector<int> parameters(1 + unfolding);
  for (int i = 0; i < std::ssize(parameters); ++i) parameters[i] = i + 1;
  if (free) parameters.push_back(11);
  std::string values;
  for (Eigen::Index i = 0; i < first.size(); ++i) values += fmt::format("{}: {}, ", 12 + i, first[i]);
  if (free) values += fmt::format("30: {}, ", *problem.duration.energy);
  if (const auto ratio = study.system.parameters.find("mu"); ratio != study.system.parameters.end())
    values += fmt::format("31: {}, ", ratio->second.value.front());
  return fmt::format(
      "NDIM={}, IPS=4, IRS=0, ILP=0, ISP=0, NBC={}, NINT=0, ICP=[{}], dat='guess'\n"
      "NMX={}, IID=0, IAD=1, IADS=0, ITNW={}, JAC=1, DS=1e-3, DSMIN=1e-3, DSMAX=1e-3\n"
      "THL={{1: {}}}\nPAR={{{}}}\n",
      first.size(), first.size() + unfolding + free, fmt::join(parameters, ","), solves + 1, most_iterations,
      weight, values.substr(0, values.size() - 2));
}

}  // namespace

VectorXd AutoOrbit::state(double t) const {
  const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, t);
  const auto k = after - times.begin() - 1;
  const double x = degree * (t - times[k]) / (times[k + 1] - times[k]);
  VectorXd result = VectorXd::Zero(nodes.front().size());
  for (int i = 0; i <= degree; ++i) {
    double part = 1;
    for (int j = 0; j <= degree; ++j)
      if (j != i) part *= (x - j) / (i - j);
    result += part * nodes[k * degree + i];
  }
  return result;
}

AutoProgram::AutoProgram(const AutoInstallation& installation, const AutoEquations& equations,
                         const extremal::Study& study) {
  compile(installation, equations.name, folder_.path());
  write_guess(study, equations.unfolding);
}

void AutoProgram::write_guess(const extremal::Study& study, int unfolding) {
  const extremal::GuessedPath path(study.problem);
  const double T = study.problem.duration.value;
  std::ofstream file(folder_ / "guess.dat");
  for (const double tau : study.problem.guess.tau) {
    VectorXd state(2 * study.problem.coordinates());
    state << path.at(tau), path.slope(tau) / T;
    file << fmt::format("{} {}\n", tau * T, fmt::join(state.begin(), state.end(), " "));
    if (constants_.empty()) constants_ = constants(study, state, unfolding);
    states_ = static_cast<int>(state.size());
  }
}

std::vector<AutoOrbit> AutoProgram::run(const AutoSetting& setting) const {
  fs::remove(folder_ / "solutions");
  std::ofstream(folder_ / "fort.2") << constants_
                                    << fmt::format("NTST={}, NCOL={}, NWTN={}, EPSL={}, EPSU={}\n",
                                                   setting.intervals, setting.degree, setting.factored,
                                                   setting.tolerance, setting.tolerance);
  std::vector<AutoOrbit> orbits;
  // its exit status tells nothing
  (void)succeeds(fmt::format("cd {} && OMP_NUM_THREADS=1 timeout 60 ./program >log 2>&1", folder_.path()));
  std::ifstream file(folder_ / "solutions");
  double spent = 0;
  int intervals = 0;
  for (AutoOrbit orbit; file >> orbit.seconds >> intervals >> orbit.degree >> orbit.period;) {
    orbit.times.assign(1, 0.0);
    for (double length; std::ssize(orbit.times) <= intervals && file >> length;)
      orbit.times.push_back(orbit.times.back() + length * orbit.period);
    orbit.nodes.assign(intervals * orbit.degree + 1, VectorXd(states_));
    for (VectorXd& node : orbit.nodes)
      for (double& value : node) file >> value;
    if (!file) throw std::runtime_error("AUTO-07p's solutions cannot be read");
    orbits.push_back(orbit);
  }
  for (AutoOrbit& orbit : orbits) orbit.seconds = spent += orbit.seconds;
  return orbits;
}

}  // namespace bench
