#include "hand_problem.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "rivals/guessed_path.hpp"

namespace bench {
namespace {

using shooting::SystemName;

/// Parameters in the order of the system's constructor, with their values where a scene has none.
struct Known {
  SystemName name;
  int coordinates;  ///< of the scene; 0: any number
  std::vector<std::pair<std::string, double>> parameters;
};
const std::vector<Known> known_systems{
    {SystemName::pendulum, 1, {{"g", 1}, {"l", 1}}},
    {SystemName::kepler, 2, {{"mu", 1}}},
    {SystemName::henon_heiles, 2, {{"coupling", 1}}},
    {SystemName::double_pendulum, 2, {{"m1", 1}, {"m2", 1}, {"l1", 1}, {"l2", 1}, {"g", 9.81}}},
    {SystemName::restricted_three_body, 3, {{"mu", 0}}},
    {SystemName::chain, 0, {{"alpha", 0}, {"beta", 1}}}};

/// Where accelerations are compared, as parts of the duration, and how closely.
constexpr double probes[] = {0.11, 0.52, 0.87};
constexpr double agreement = 1e-11;
/// Points of the guess that its size is read from.
constexpr int samples = 65;

Eigen::VectorXd velocity(const extremal::GuessedPath& path, const extremal::Problem& problem, double tau) {
  return path.slope(tau) / problem.duration.value;
}

/// Whether L_vv q'' + L_vq q' = L_q with the accelerations written by hand.
bool obeys(const extremal::Problem& problem, const shooting::SystemChoice& choice, const Eigen::VectorXd& q,
           const Eigen::VectorXd& v) {
  const int n = problem.coordinates();
  extremal::Scratch scratch;
  const extremal::PointValues l =
      extremal::evaluate_at(*problem.lagrangian, {q.data(), q.data() + n}, {v.data(), v.data() + n}, 0,
                            extremal::Order::hessian, scratch);
  const std::vector<double> a =
      shooting::acceleration(choice, {q.data(), q.data() + n}, {v.data(), v.data() + n});
  for (int i = 0; i < n; ++i) {
    double sum = -l.dq[i], size = std::abs(l.dq[i]);
    for (int j = 0; j < n; ++j)
      for (const double term : {l.vv[i * n + j] * a[j], l.vq[i * n + j] * v[j]})
        sum += term, size += std::abs(term);
    if (!(std::abs(sum) <= agreement * size)) return false;
  }
  return true;
}

shooting::SystemChoice choose_system(const extremal::Study& study, const extremal::GuessedPath& path) {
  const extremal::Problem& problem = study.problem;
  for (const Known& known : known_systems) {
    if (known.coordinates > 0 && known.coordinates != problem.coordinates()) continue;
    shooting::SystemChoice choice{known.name, problem.coordinates(), {}};
    for (const auto& [name, value] : known.parameters) {
      const auto given = study.system.parameters.find(name);
      choice.parameters.push_back(given == study.system.parameters.end() ? value
                                                                         : given->second.value.front());
    }
    if (std::all_of(std::begin(probes), std::end(probes), [&](double tau) {
          return obeys(problem, choice, path.at(tau), velocity(path, problem, tau));
        }))
      return choice;
  }
  throw std::invalid_argument("no equations are written for this system");
}

/// Both ends fixed, the velocity at the start unknown.
void fix_ends(const extremal::Problem& problem, HandProblem& hand) {
  const int n = problem.coordinates();
  for (int a = 0; a < n; ++a) {
    hand.boundary.unknown.push_back(n + a);
    hand.boundary.given.push_back(a);
    hand.boundary.value.push_back(problem.ends.offset[n + a]);
    hand.start[a] = problem.ends.offset[a];
  }
}

/// The coordinate x of a condition x(0) = value that closes a free duration, with that value.
std::optional<std::pair<int, double>> closing_coordinate(const extremal::Problem& problem,
                                                         const std::vector<double>& start) {
  if (!problem.duration.where) return {};
  const std::size_t n = problem.coordinates();
  std::vector<double> gradient(2 * n), end(n);
  const double value = problem.duration.where({start.data(), n}, end, gradient);
  const auto one = std::find(gradient.begin(), gradient.end(), 1.0);
  const auto zeros = std::count(gradient.begin(), gradient.end(), 0.0);
  const int coordinate = static_cast<int>(one - gradient.begin());
  if (zeros != static_cast<std::ptrdiff_t>(2 * n - 1) || coordinate >= static_cast<int>(n)) return {};
  return std::pair(coordinate, start[coordinate] - value);
}

/// From one perpendicular crossing of y = 0 to the next in the restricted problem of three bodies: y alone is
/// fixed at the ends, x' = z' = 0 there, and x(0) or z(0) is given.
void cross_perpendicularly(const extremal::Problem& problem, HandProblem& hand) {
  enum { x, y, z, u, v, w };
  const auto closing = closing_coordinate(problem, hand.start);
  if (!closing || closing->first == y || problem.ends.offset[y] != 0 || problem.ends.offset[3 + y] != 0)
    throw std::invalid_argument("not coded for these ends");
  const auto [given, value] = *closing;
  hand.start[y] = hand.start[u] = hand.start[w] = 0;
  hand.start[given] = value;
  hand.boundary.free_duration = true;
  hand.boundary.unknown = {given == x ? z : x, v};
  hand.boundary.given = {y, u, w};
  hand.boundary.value.assign(3, 0.0);
}

void measure_guess(const extremal::Problem& problem, const extremal::GuessedPath& path, HandProblem& hand) {
  const Eigen::VectorXd first = path.at(0);
  Eigen::VectorXd low = first, high = first;
  double fastest = 0;
  for (int i = 0; i < samples; ++i) {
    const double tau = i / (samples - 1.0);
    const Eigen::VectorXd q = path.at(tau);
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
    fastest = std::max(fastest, velocity(path, problem, tau).cwiseAbs().maxCoeff());
  }
  const double range = (high - low).maxCoeff();
  hand.boundary.q_scale = range > 0 ? range : 1;
  hand.boundary.v_scale = std::max(fastest, hand.boundary.q_scale / problem.duration.value);
}

}  // namespace

HandProblem hand_problem(const extremal::Study& study) {
  const extremal::Problem& problem = study.problem;
  const extremal::GuessedPath path(problem);
  const int n = problem.coordinates();
  HandProblem hand;
  hand.system = choose_system(study, path);
  hand.boundary.duration = problem.duration.value;
  const Eigen::VectorXd q = path.at(0), v = velocity(path, problem, 0);
  hand.start.assign(q.begin(), q.end());
  hand.start.insert(hand.start.end(), v.begin(), v.end());
  const auto fixed = std::count(problem.ends.fixed.begin(), problem.ends.fixed.end(), 1);
  if (!problem.duration.free && fixed == 2 * n)
    fix_ends(problem, hand);
  else if (hand.system.name == SystemName::restricted_three_body && problem.duration.free && fixed == 2 &&
           problem.ends.fixed[1] && problem.ends.fixed[4])
    cross_perpendicularly(problem, hand);
  else
    throw std::invalid_argument("not coded for these ends");
  measure_guess(problem, path, hand);
  return hand;
}

std::vector<double> hand_guess(const HandProblem& hand, const extremal::Problem& problem, int segments) {
  const extremal::GuessedPath path(problem);
  const int n = hand.system.coordinates;
  std::vector<double> states = hand.start;
  for (int k = 1; k < segments; ++k) {
    const double tau = static_cast<double>(k) / segments;
    const Eigen::VectorXd q = path.at(tau), v = velocity(path, problem, tau);
    states.insert(states.end(), q.begin(), q.begin() + n);
    states.insert(states.end(), v.begin(), v.begin() + n);
  }
  return states;
}

}  // namespace bench
