#include <Eigen/Dense>
#include <fstream>

#include "solve/scenes.hpp"

/// \file Published periodic orbits, solved for from their initial states: distance of the refined state from
/// the orbit that was found, in phase space and but for what symmetries leave open.

namespace extremal::laws {
namespace {

using Eigen::VectorXd;

std::string reference_file(const char* name) {
  return std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/reference/" + name;
}

nlohmann::json cases_of(const char* name) {
  std::ifstream in(reference_file(name));
  return nlohmann::json::parse(in).at("cases");
}

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

/// The scene of an orbit of the restricted problem, or of so many bodies in the plane.
std::string scene_of(const nlohmann::json& c, double tolerance) {
  const nlohmann::json& state = c["refined"]["state"];
  std::string system, guess;
  if (c["parameters"].contains("mu")) {
    system = fmt::format("use = \"cr3bp\"\nparameters = {{ mu = {} }}", decimal(c["parameters"]["mu"]));
    const char* names[] = {"x", "y", "z"};
    for (int a = 0; a < 3; ++a)
      guess += fmt::format("{}{} = {}, \"{}'\" = {}", a ? ", " : "", names[a], decimal(state[a]), names[a],
                           decimal(state[3 + a]));
  } else {
    const nlohmann::json& masses = c["parameters"]["masses"];
    const int n = static_cast<int>(masses.size());
    system = fmt::format("use = \"nbody\"\nparameters = {{ n = {}, m = {} }}", n, listed(masses, 0, n, 1));
    guess = fmt::format("x = {}, y = {}, \"x'\" = {}, \"y'\" = {}", listed(state, 0, n, 2),
                        listed(state, 1, n, 2), listed(state, 2 * n, n, 2), listed(state, 2 * n + 1, n, 2));
  }
  return fmt::format(
      "[system]\n{}\n[boundary]\nperiodic = true\nduration = {}\n[guess]\nstate = {{ {} }}\n"
      "[solve]\ntolerance = {}\n",
      system, decimal(c["refined"]["period"]), guess, tolerance);
}

Solution solved(const nlohmann::json& c, double tolerance) {
  const std::string path = testing::TempDir() + c["id"].get<std::string>() + ".toml";
  std::ofstream(path) << scene_of(c, tolerance);
  return run(load(path));
}

/// The published state, coordinates in the order of the scene: all x, then all y.
VectorXd state_of(const nlohmann::json& c) {
  const Values values = decimals(c["refined"]["state"]);
  VectorXd state(std::ssize(values));
  if (c["parameters"].contains("mu")) return Eigen::Map<const VectorXd>(values.data(), state.size());
  const Eigen::Index n = state.size() / 4;
  for (Eigen::Index i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) state[k * n + i] = values[(k / 2) * 2 * n + 2 * i + k % 2];
  return state;
}

/// The orbit's state at t, turned by an angle and moved.
class Moved {
 public:
  Moved(const Solution& solution, bool plane)
      : path_(solution.trajectory), plane_(plane), n_(solution.trajectory.coordinates) {}

  int parameters() const { return plane_ ? 4 : 1; }  ///< t, angle, shift

  VectorXd operator()(const VectorXd& by) const {
    const double T = path_.duration();
    double t = std::fmod(by[0], T);
    if (t < 0) t += T;
    Values q(n_), v(n_);
    path_.at(std::min(t, T), q, v);
    VectorXd state(2 * n_);
    state << Eigen::Map<const VectorXd>(q.data(), n_), Eigen::Map<const VectorXd>(v.data(), n_);
    if (!plane_) return state;
    const int bodies = n_ / 2;
    const double c = std::cos(by[1]), s = std::sin(by[1]);
    VectorXd turned(2 * n_);
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

/// Gauss-Newton over the symmetries.
double distance(const nlohmann::json& c, const Solution& solution) {
  const VectorXd truth = state_of(c);
  const Moved moved(solution, !c["parameters"].contains("mu"));
  VectorXd by = VectorXd::Zero(moved.parameters());
  for (int step = 0; step < 6; ++step) {
    Eigen::MatrixXd slopes(truth.size(), by.size());
    const double small = 1e-6;
    for (Eigen::Index k = 0; k < by.size(); ++k) {
      const VectorXd e = small * VectorXd::Unit(by.size(), k);
      slopes.col(k) = (moved(by + e) - moved(by - e)) / (2 * small);
    }
    by += slopes.colPivHouseholderQr().solve(truth - moved(by));
  }
  return (moved(by) - truth).norm();
}

/// What an error of one unit in the state or the period, rounded to double, becomes: by the condition of the
/// equations that refined it, and over one period.
double sensitivity(const nlohmann::json& c, const Solution& solution) {
  const nlohmann::json condition = c["refined"].value("newton_condition", nlohmann::json());
  const double refined = condition.is_string() ? decimal(condition) : 1;
  return std::max(refined, std::abs(solution.floquet->multipliers.front()));
}

std::string wrong(const nlohmann::json& c, double tolerance = 1e-12) {
  const Solution s = solved(c, tolerance);
  if (!s.converged()) return s.message;
  const double error = distance(c, s);
  // Digits of the state are rounded to double as well.
  const double allowed = 10 * tolerance * std::max(1.0, 1e-3 * sensitivity(c, s));
  if (error > allowed) return fmt::format("distance {:.1e}, allowed {:.1e}", error, allowed);
  if (!s.nullity || *s.nullity < 1) return "time is not shifted";
  return s.strategy == "newton from the guess" ? "" : "by " + s.strategy;
}

TEST(PublishedOrbits, OfTheRestrictedProblem) {
  for (const nlohmann::json& c : cases_of("cr3bp_periodic_orbits.json")) EXPECT_EQ(wrong(c), "") << c["id"];
}

TEST(PublishedOrbits, OfThreeBodiesInThePlane) {
  for (const char* id :
       {"choreo-3-D32-Thefigure-8", "3b-broucke-a-A-1_1", "3b-broucke-a-A-1_4", "3b-broucke-a-A-2_5",
        "3b-broucke-broucke-R-R1_4", "3b-broucke-broucke-R-R3_5", "3b-broucke-broucke-boggs-BB-4",
        "3b-broucke-broucke-boggs-BB-1", "3b-broucke-broucke-boggs-BB-30", "3b-broucke-broucke-boggs-BB-6",
        "3b-ll-IA1", "3b-simo-001", "3b-simo-004", "3b-simo-003", "3b-simo-014", "3b-sd8-M8", "3b-sd8-NC1",
        "3b-sd8-NC2"})
    EXPECT_EQ(wrong(published("nbody_periodic_orbits.json", id)), "") << id;
}

/// Errors grow by up to 7e16 over a period, and by the root of that over each half.
TEST(PublishedOrbits, ThatAreVeryUnstable) {
  for (const char* id : {"3b-simo-009", "3b-simo-061", "3b-simo-101", "3b-simo-161", "3b-simo-311",
                         "3b-sheen-6", "3b-hristov-600-2"})
    EXPECT_EQ(wrong(published("nbody_periodic_orbits.json", id)), "") << id;
}

/// Encounters within a hundredth of the size of the orbit amplify roundoff.
TEST(PublishedOrbits, WithCloseEncounters) {
  for (const char* id :
       {"3b-sd-IIC2b-yinyangI", "3b-sd-IIC2a-yinyangI", "3b-ll-IB13", "3b-ll-IIC22", "3b-ll-IA6",
        "3b-ll-IIC71", "3b-sheen-7", "3b-sheen-10", "3b-sd-IB4-mothIII", "3b-sd-IA3-bumblebee"})
    EXPECT_EQ(wrong(published("nbody_periodic_orbits.json", id), 1e-10), "") << id;
}

/// Closer, to 3e-4 of it; free fall begins and ends at rest.
TEST(PublishedOrbits, WithVeryCloseEncounters) {
  for (const char* id : {"3b-ll-IB2", "3b-ll-IA12", "3b-sd-IA2-butterflyII", "3b-sd-IB3-butterflyIII",
                         "3b-llu-IA10-m0.5", "3b-ff-F1_1_1_1_", "3b-ff-F2_1_1_1_"})
    EXPECT_EQ(wrong(published("nbody_periodic_orbits.json", id), 1e-8), "") << id;
}

/// What roundoff hides is said, and by how much.
TEST(PublishedOrbits, BeyondRoundoff) {
  for (const char* id : {"3b-ll-IB2", "3b-ll-IA6", "3b-sd-IA2-butterflyII"}) {
    const std::string said = wrong(published("nbody_periodic_orbits.json", id), 1e-13);
    EXPECT_NE(said.find("roundoff, amplified to"), std::string::npos) << id << ": " << said;
  }
}

TEST(PublishedOrbits, OfSixBodies) {
  EXPECT_EQ(wrong(published("nbody_periodic_orbits.json", "choreo-6-D672-Sixonaheptagram")), "");
}

}  // namespace
}  // namespace extremal::laws
