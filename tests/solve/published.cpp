#include "solve/published.hpp"

#include <fmt/ranges.h>

#include <fstream>

namespace extremal::laws {

namespace {

/// How the system of a case is written in a scene.
struct PublishedSystem {
  std::string text;                ///< of [system]
  std::vector<std::string> names;  ///< coordinates; of bodies in the plane: x and y, lists of `bodies`
  int bodies = 0;

  int coordinates() const { return static_cast<int>(names.size()) * std::max(bodies, 1); }
};

/// "0.25" or "1/3".
double fraction(const std::string& text) {
  const std::size_t slash = text.find('/');
  return std::stod(text) / (slash == std::string::npos ? 1 : std::stod(text.substr(slash + 1)));
}

std::string listed(const nlohmann::json& values, int first, int count, int stride) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format("{}{}", i ? ", " : "", fraction(values[first + i * stride]));
  return "[" + text + "]";
}

PublishedSystem system_of(const nlohmann::json& c) {
  const nlohmann::json& parameters = c["parameters"];
  if (parameters.contains("masses")) {
    const int n = static_cast<int>(parameters["masses"].size());
    return {fmt::format("use = \"nbody\"\nparameters = {{ n = {}, m = {} }}", n,
                        listed(parameters["masses"], 0, n, 1)),
            {"x", "y"},
            n};
  }
  const std::string kind = c.value("verifier_system", "cr3bp");
  if (kind == "cr3bp")
    return {fmt::format("use = \"cr3bp\"\nparameters = {{ mu = {} }}", decimal(parameters["mu"])),
            {"x", "y", "z"}};
  if (kind == "hill3") return {"use = \"hill\"", {"x", "y", "z"}};
  if (kind == "henonheiles") return {"use = \"henon-heiles\"", {"x", "y"}};
  if (kind == "doublepend") return {"use = \"double-pendulum\"\nparameters = { g = 1.0 }", {"a", "b"}};
  if (kind == "springpend") return {"use = \"spring-pendulum\"", {"x", "y"}};
  if (kind == "swingatwood") return {"use = \"swinging-atwood\"", {"r", "theta"}};
  // The meridian plane, which turns with the particle.
  if (kind == "stormer")
    return {
        "coordinates = [\"rho\", \"z\"]\n"
        "lagrangian = \"(rho'^2 + z'^2)/2 - (1/rho - rho/(rho^2 + z^2)^1.5)^2/2\"",
        {"rho", "z"}};
  throw std::runtime_error("no system " + kind);
}

/// The orbit's state at t, turned by an angle and moved.
class Moved {
 public:
  Moved(const Solution& solution, bool plane)
      : path_(solution.trajectory), plane_(plane), n_(solution.trajectory.coordinates) {}

  int parameters() const { return plane_ ? 4 : 1; }  ///< t, angle, shift

  Eigen::VectorXd operator()(const Eigen::VectorXd& by) const {
    const double T = path_.duration();
    double t = std::fmod(by[0], T);
    if (t < 0) t += T;
    Values q(n_), v(n_);
    path_.at(std::min(t, T), q, v);
    Eigen::VectorXd state(2 * n_);
    state << Eigen::Map<const Eigen::VectorXd>(q.data(), n_), Eigen::Map<const Eigen::VectorXd>(v.data(), n_);
    if (!plane_) return state;
    const int bodies = n_ / 2;
    const double c = std::cos(by[1]), s = std::sin(by[1]);
    Eigen::VectorXd turned(2 * n_);
    for (int k = 0; k < 2; ++k)
      for (int i = 0; i < bodies; ++i) {
        const double x = state[k * n_ + i], y = state[k * n_ + bodies + i];
        turned[k * n_ + i] = c * x - s * y + (k == 0 ? by[2] : 0);
        turned[k * n_ + bodies + i] = s * x + c * y + (k == 0 ? by[3] : 0);
      }
    return turned;
  }

 private:
  const Trajectory& path_;
  bool plane_;
  int n_;
};

}  // namespace

nlohmann::json cases_of(const char* name) {
  std::ifstream in(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/reference/" + name);
  return nlohmann::json::parse(in).at("cases");
}

Eigen::VectorXd state_of(const nlohmann::json& c) {
  const Values values = decimals(c["refined"]["state"]);
  Eigen::VectorXd state = Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
  const int bodies = system_of(c).bodies, n = 2 * bodies;
  for (int i = 0; i < bodies; ++i)
    for (int k = 0; k < 4; ++k) state[k * bodies + i] = values[(k / 2) * n + 2 * i + k % 2];
  return state;
}

std::string scene_of(const nlohmann::json& c, double tolerance) {
  const PublishedSystem system = system_of(c);
  const Eigen::VectorXd state = state_of(c);
  const int each = std::max(system.bodies, 1), n = system.coordinates();
  std::string guess;
  for (int k = 0; k < 2; ++k)
    for (std::size_t a = 0; a < system.names.size(); ++a) {
      const double* first = state.data() + k * n + a * each;
      const std::string value = system.bodies > 0 ? fmt::format("[{}]", fmt::join(first, first + each, ", "))
                                                  : fmt::format("{}", *first);
      guess +=
          fmt::format("{}\"{}{}\" = {}", guess.empty() ? "" : ", ", system.names[a], k ? "'" : "", value);
    }
  return fmt::format(
      "[system]\n{}\n[boundary]\nperiodic = true\nduration = {}\n[guess]\nstate = {{ {} }}\n"
      "[solve]\ntolerance = {}\n",
      system.text, decimal(c["refined"]["period"]), guess, tolerance);
}

Solution solved(const nlohmann::json& c, double tolerance) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::string path = testing::TempDir() + test + "-" + c["id"].get<std::string>() + ".toml";
  std::ofstream(path) << scene_of(c, tolerance);
  return run(load(path));
}

/// Gauss-Newton over the time, angle and shift, from the time where it is nearest.
double distance(const nlohmann::json& c, const Solution& solution) {
  const Eigen::VectorXd truth = state_of(c);
  const Moved moved(solution, system_of(c).bodies > 0);
  Eigen::VectorXd by = Eigen::VectorXd::Zero(moved.parameters());
  double least = INFINITY;
  const int samples = 400;
  for (int k = 0; k < samples; ++k) {
    Eigen::VectorXd trial = Eigen::VectorXd::Zero(by.size());
    trial[0] = solution.duration() * k / samples;
    if (const double now = (moved(trial) - truth).norm(); now < least) {
      least = now;
      by = trial;
    }
  }
  for (int step = 0; step < 6; ++step) {
    Eigen::MatrixXd slopes(truth.size(), by.size());
    const double small = 1e-6;
    for (Eigen::Index k = 0; k < by.size(); ++k) {
      const Eigen::VectorXd e = small * Eigen::VectorXd::Unit(by.size(), k);
      slopes.col(k) = (moved(by + e) - moved(by - e)) / (2 * small);
    }
    by += slopes.colPivHouseholderQr().solve(truth - moved(by));
  }
  return (moved(by) - truth).norm();
}

}  // namespace extremal::laws
