#include "study/fitting.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "machine/clock.hpp"
#include "study/fit/fit_data.hpp"
#include "study/fit/fitted_scene.hpp"
#include "study/study.hpp"

namespace extremal {
namespace {

/// Times of a guess that data make; where there are more, groups of them are averaged.
constexpr std::size_t most_times = 200;

/// The observations of one coordinate by time, as means of groups.
struct Track {
  std::vector<double> t, q;
  double at(double time) const {
    const auto after = std::ranges::upper_bound(t, time);
    if (after == t.begin()) return q.front();
    if (after == t.end()) return q.back();
    const auto k = after - t.begin();
    return q[k - 1] + (q[k] - q[k - 1]) * (time - t[k - 1]) / (t[k] - t[k - 1]);
  }
};

Track track_of(const ObservedColumn& column, const std::vector<double>& times) {
  std::vector<ObservedValue> values = column.values;
  std::ranges::stable_sort(values, {}, [&](const ObservedValue& v) { return times[v.row]; });
  Track track;
  const std::size_t group = (values.size() + most_times - 1) / most_times;
  for (std::size_t k = 0; k < values.size();) {
    double t = 0, q = 0, count = 0;
    // Values of one time belong together.
    for (; k < values.size() && (count < group || times[values[k].row] == times[values[k - 1].row]);
         ++k, ++count) {
      t += times[values[k].row];
      q += values[k].value;
    }
    track.t.push_back(t / count);
    track.q.push_back(q / count);
  }
  return track;
}

/// The first path where the scene gives none: observed coordinates as they were observed, others on the line
/// between what the boundary fixes, or zero. Empty where no coordinate was observed.
Guess guess_of(const Observations& data, const Problem& problem) {
  const int n = problem.coordinates();
  std::vector<Track> tracks(n);
  std::vector<double> tau{0, 1};
  for (const ObservedColumn& column : data.columns)
    if (column.kind == Observable::coordinate && column.values.size() > 1) {
      tracks[column.index] = track_of(column, data.t);
      for (const double t : tracks[column.index].t) tau.push_back(t / problem.duration.value);
    }
  Guess guess;
  if (tau.size() == 2) return guess;
  std::ranges::sort(tau);
  for (const double each : tau)
    if (each >= 0 && each <= 1 && (guess.tau.empty() || each > guess.tau.back() + 1e-9))
      guess.tau.push_back(each);
  guess.tau.back() = 1;
  const auto end = [&](int a, bool at_end) {
    const int here = at_end ? n + a : a, there = at_end ? a : n + a;
    return problem.ends.fixed[here]    ? problem.ends.offset[here]
           : problem.ends.fixed[there] ? problem.ends.offset[there]
                                       : 0.0;
  };
  for (const double each : guess.tau)
    for (int a = 0; a < n; ++a)
      guess.q.push_back(tracks[a].t.empty() ? (1 - each) * end(a, false) + each * end(a, true)
                                            : tracks[a].at(each * problem.duration.value));
  return guess;
}

/// Where a fit begins with an open end, and the size of the coordinate.
FitUnknown unknown_of(const OpenEnd& open, const Problem& problem, const Guess& guess) {
  const std::size_t n = problem.coordinates(), a = open.e % n;
  FitUnknown unknown{open.name, 0, 0};
  if (guess.given()) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = a; k < guess.q.size(); k += n) {
      low = std::min(low, guess.q[k]);
      high = std::max(high, guess.q[k]);
    }
    unknown.start = open.e < static_cast<int>(n) ? guess.q[a] : guess.q[guess.q.size() - n + a];
    unknown.size = std::max({high - low, std::abs(low), std::abs(high)});
  } else {
    const std::size_t there = open.e < static_cast<int>(n) ? n + a : a;
    if (problem.ends.fixed[there]) unknown.start = problem.ends.offset[there];
    unknown.size = std::abs(unknown.start);
  }
  if (unknown.size == 0) unknown.size = 1;
  if (open.e >= static_cast<int>(n)) unknown.last = open.e - static_cast<int>(n);
  return unknown;
}

/// After which a problem has no motion to be observed.
double latest_time(const Problem& problem) {
  return problem.duration.free ? std::numeric_limits<double>::infinity() : problem.duration.value;
}

std::vector<std::string> names_of(const std::vector<FitUnknown>& unknowns) {
  std::vector<std::string> names;
  for (const FitUnknown& unknown : unknowns) names.push_back(unknown.name);
  return names;
}

/// Another request, where there is one and it can be made.
template <class Make, class... Arguments>
std::shared_ptr<const FitRequest> made(const Make& make, Arguments... arguments) {
  if (!make) return nullptr;
  try {
    return make(arguments...);
  } catch (const SceneError&) {
  } catch (const FormulaError&) {
  } catch (const RelationError&) {
  } catch (const std::invalid_argument&) {
  }
  return nullptr;
}

/// A duration in which a motion goes on for a while after the observations, of few digits.
double longer(double duration) { return std::stod(fmt::format("{:.3g}", 1.1 * duration)); }

}  // namespace

Guess observed_path(const FitTable& table, const std::string& scene, const System& system,
                    const Problem& problem) {
  const Observations data = read_observations(table, scene, system, latest_time(problem));
  std::vector<char> observed(problem.coordinates(), false);
  for (const ObservedColumn& column : data.columns)
    if (column.kind == Observable::coordinate && column.values.size() > 1) observed[column.index] = true;
  return std::ranges::all_of(observed, std::identity{}) ? guess_of(data, problem) : Guess{};
}

std::shared_ptr<FitRequest> read_fit(const Scene& scene, const Study& study, const ProblemOf& load) {
  const FitTable& table = *scene.fit;
  if (!can_fit())
    throw SceneError(table.at, "fits are not part of this build; build with -DEXTREMAL_CERES=ON");
  const auto fitted = std::make_shared<const FittedScene>(scene, study.system, study.problem, load);
  auto request = std::make_shared<FitRequest>();
  FitTask& task = request->task;
  const Problem& problem = study.problem;
  if (table.loss) task.loss = find_loss(table.loss->value).value();
  task.data = read_observations(table, scene.path, study.system, latest_time(problem));
  task.guess = problem.guess.given() ? problem.guess : guess_of(task.data, problem);
  task.duration = problem.duration.value;
  task.coordinates = problem.coordinates();
  task.closed = problem.periodic && !problem.duration.free;
  request->parameters = fitted->parameters();
  const std::vector<double> start = fitted->start();
  for (std::size_t j = 0; j < start.size(); ++j)
    task.unknowns.push_back({request->parameters[j], start[j], start[j] == 0 ? 1 : std::abs(start[j])});
  for (const OpenEnd& open : fitted->open()) {
    request->open_ends.push_back(open.name);
    task.unknowns.push_back(unknown_of(open, problem, task.guess));
  }
  if (task.unknowns.empty())
    throw SceneError(
        table.at,
        "there is nothing to be found; name parameters, or leave end coordinates out of [boundary]");
  const int count = task.data.count();
  if (count < static_cast<int>(task.unknowns.size()))
    throw SceneError(position(table.data, 0),
                     fmt::format("the data have {} values for {} unknowns: {}", count, task.unknowns.size(),
                                 fmt::join(names_of(task.unknowns), ", ")));
  std::vector<double> values;
  for (const FitUnknown& unknown : task.unknowns) values.push_back(unknown.start);
  // Both refuse formulas that cannot be fitted.
  if (fitted->made_anew())
    fitted->formulas(values);
  else
    fitted->at(values);
  const auto tried = [](const auto& make) -> decltype(std::optional(make())) {
    try {
      return make();
    } catch (const SceneError&) {
    } catch (const FormulaError&) {
    } catch (const std::invalid_argument&) {
    } catch (const RelationError&) {
    }
    return std::nullopt;
  };
  if (fitted->made_anew())
    task.formulas = [fitted](std::span<const double> x) { return fitted->formulas(x); };
  else
    task.at = [fitted, tried](std::span<const double> x) { return tried([&] { return fitted->at(x); }); };
  task.problem = [fitted, tried](std::span<const double> x, const Guess& guess, double duration) {
    return tried([&] { return fitted->problem(x, guess, duration); });
  };
  return request;
}

FitResult run_fit(const Study& study, int repeat, const std::function<void(const FitStep&)>& progress) {
  if (repeat < 1) throw std::invalid_argument(fmt::format("repeat = {}; need at least 1", repeat));
  if (!study.fit) throw std::invalid_argument(study.scene + ": the table [fit] is missing");
  Solver solver;
  const auto fit_to = [&](FitTask task, const SolveOptions& options) {
    task.solve = [&solver](const Problem& problem, const SolveOptions& how) {
      return solver.solve(problem, how);
    };
    return fit(task, options, progress);
  };
  FitResult result;
  SolveOptions options = study.options;
  std::vector<double> solving, analysing;
  for (int k = 0; k < repeat && !(k > 0 && options.deadline.passed()); ++k) {
    options.deadline = deadline_of(study);
    const auto begin = Clock::now();
    result = fit_to(study.fit->task, options);
    if (!result.solution.converged() && !options.deadline.passed())
      if (const auto request = made(study.fit->from_data)) {
        FitResult other = fit_to(request->task, options);
        if (other.solution.converged()) {
          other.solution.message += "; from the observations, since the fit from the guess failed";
          result = std::move(other);
        }
      }
    // Where T is conjugate to 0, the ends determine no motion, and another duration is not conjugate.
    if (!result.solution.converged() && !options.deadline.passed())
      if (const auto request = made(study.fit->lasting, longer(study.problem.duration.value)))
        if (fit_to(request->task, options).solution.converged())
          result.solution.message = fmt::format(
              "the fit of a longer motion converges, and that of this one does not: set duration = {} in "
              "[boundary]. Ends that are conjugate to each other, or nearly so, as those of half a period or "
              "a whole one, do not determine the motion between them",
              request->task.duration);
    const double seconds = seconds_since(begin);
    solving.push_back(seconds - result.solution.seconds_analyse);
    analysing.push_back(result.solution.seconds_analyse);
  }
  result.solution.seconds_solve = median(std::move(solving));
  result.solution.seconds_analyse = median(std::move(analysing));
  return result;
}

void use_fitted(std::span<const double> values, Study& study) {
  if (!study.fit || values.empty()) return;
  const FitTask& task = study.fit->task;
  std::optional<Problem> fitted = task.problem(values, task.guess, task.duration);
  if (!fitted) return;
  study.problem.lagrangian = std::move(fitted->lagrangian);
  study.problem.copies = std::move(fitted->copies);
  study.problem.pair = std::move(fitted->pair);
  study.problem.manifold = std::move(fitted->manifold);
}

}  // namespace extremal
