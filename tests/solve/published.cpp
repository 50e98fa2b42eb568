#include "solve/published.hpp"

#include <fmt/ranges.h>

#include <Eigen/Geometry>

#include <fstream>

namespace extremal::laws {

namespace {

/// How the system of a case is written in a scene.
struct PublishedSystem {
  std::string text;                ///< of [system]
  std::vector<std::string> names;  ///< coordinates; of bodies: x, y and perhaps z, lists of `bodies`
  int bodies = 0;

  int dimension() const { return static_cast<int>(names.size()); }
  int coordinates() const { return dimension() * std::max(bodies, 1); }
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
    const bool space = c.value("dimension", 2) == 3;
    return {fmt::format("use = \"{}\"\nparameters = {{ n = {}, m = {} }}", space ? "nbody-space" : "nbody", n,
                        listed(parameters["masses"], 0, n, 1)),
            space ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"x", "y"}, n};
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

/// The orbit's state at t; that of bodies turned and moved.
class Moved {
 public:
  Moved(const Solution& solution, const PublishedSystem& system)
      : path_(solution.trajectory),
        n_(system.coordinates()),
        bodies_(system.bodies),
        dimension_(bodies_ > 0 ? system.dimension() : 0) {}

  int angles() const { return dimension_ == 3 ? 3 : dimension_ == 2 ? 1 : 0; }
  int parameters() const { return 1 + angles() + dimension_; }  ///< t, angles about z, y and x, shift

  Eigen::VectorXd operator()(const Eigen::VectorXd& by) const {
    const double T = path_.duration();
    double t = std::fmod(by[0], T);
    if (t < 0) t += T;
    Values q(n_), v(n_);
    path_.at(std::min(t, T), q, v);
    Eigen::VectorXd state(2 * n_);
    state << Eigen::Map<const Eigen::VectorXd>(q.data(), n_), Eigen::Map<const Eigen::VectorXd>(v.data(), n_);
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    for (int k = 0; k < angles(); ++k)
      turn = Eigen::AngleAxisd(by[1 + k], Eigen::Vector3d::Unit(2 - k)) * turn;
    for (int i = 0; i < 2 * bodies_; ++i) {
      const bool velocity = i >= bodies_;
      const int first = velocity * n_ + i % bodies_;
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      for (int a = 0; a < dimension_; ++a) x[a] = state[first + a * bodies_];
      x = turn * x;
      for (int a = 0; a < dimension_; ++a)
        state[first + a * bodies_] = x[a] + (velocity ? 0 : by[1 + angles() + a]);
    }
    return state;
  }

 private:
  const Trajectory& path_;
  int n_, bodies_, dimension_;
};

}  // namespace

nlohmann::json cases_of(const char* name) {
  std::ifstream in(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/reference/" + name);
  return nlohmann::json::parse(in).at("cases");
}

Eigen::VectorXd state_of(const nlohmann::json& c) {
  const Values values = decimals(c["refined"]["state"]);
  Eigen::VectorXd state = Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
  const PublishedSystem system = system_of(c);
  const int bodies = system.bodies, d = system.dimension();
  for (int i = 0; i < bodies; ++i)
    for (int k = 0; k < 2 * d; ++k) state[k * bodies + i] = values[(k / d) * d * bodies + d * i + k % d];
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

Study study_of(const nlohmann::json& c, double tolerance) { return study_of(scene_of(c, tolerance)); }

Solution solved(const nlohmann::json& c, double tolerance) { return run(study_of(c, tolerance)); }

/// Gauss-Newton over the time, angles and shift, from the time where it is nearest.
double distance(const nlohmann::json& c, const Solution& solution) {
  const Eigen::VectorXd truth = state_of(c);
  const Moved moved(solution, system_of(c));
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
