#include "solve/fit/fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "linear/dense.hpp"
#include "solve/fit/fitted_path.hpp"
#include "solve/fit/limits.hpp"
#include "solve/fit/solved_path.hpp"
#include "solve/fit/whole_path.hpp"

namespace extremal {

using namespace limits::fit;

Guess guess_of_elements(const Trajectory& trajectory) {
  Guess guess;
  std::vector<double> q(trajectory.coordinates), v(q.size());
  const std::vector<double>& places = lobatto_barycentric(trajectory.degree).nodes;
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int j = k == 0 ? 0 : 1; j <= trajectory.degree; ++j) {
      trajectory.in_element(k, places[j], q, v);
      const double t = trajectory.times[k] + places[j] * (trajectory.times[k + 1] - trajectory.times[k]);
      guess.tau.push_back(t / trajectory.duration());
      guess.q.insert(guess.q.end(), q.begin(), q.end());
    }
  guess.tau.back() = 1;
  return guess;
}

namespace {

std::unique_ptr<FittedExtremal> extremal_of(const FitTask& task, const SolveOptions& options) {
  if (task.at) return std::make_unique<FittedPath>(task, options);
  return std::make_unique<SolvedPath>(task, options);
}

/// Works with unknowns by their sizes, x = θ/size.
class Fit {
 public:
  Fit(const FitTask& task, const SolveOptions& options, const std::function<void(const FitStep&)>& progress)
      : task_(task), options_(options), progress_(progress), path_(extremal_of(task, options)) {
    for (const FitUnknown& unknown : task.unknowns) result_.values.push_back(unknown.start);
  }

  FitResult run() {
    if (!begin()) return std::move(result_);
    const int before = result_.solution.iterations;
    for (int round = 0; round < most_rounds; ++round) {
      if (!minimise_on_elements() || !determined()) return std::move(result_);
      const Trajectory fitted = first_copy(trajectory_of(path_->path()), task_.coordinates);
      result_.solution = solve_again(fitted);
      if (!result_.solution.converged()) return std::move(result_);
      if (agrees(fitted)) return covers_data() && knows_family() ? finished(before) : std::move(result_);
    }
    fail(fmt::format("the elements still move the fit by more than the tolerance after {} choices of them",
                     most_rounds));
    return std::move(result_);
  }

 private:
  /// An extremal that is found together with values of the unknowns; else one for their first values.
  bool begin() {
    const std::vector<double> start = result_.values;
    int before = 0;
    if (std::optional<FirstFit> first = fit_whole_path(task_, options_)) {
      result_.values = std::move(first->values);
      result_.solution = solve(first->guess, first->duration);
      before = first->iterations;
    }
    if (!result_.solution.converged()) {
      result_.values = start;
      result_.solution = solve(task_.guess, task_.duration);
    }
    result_.solution.iterations += before;
    if (result_.solution.converged()) return true;
    const std::string spent =
        options_.deadline.passed()
            ? fmt::format("{} (solve.budget) is spent; raise it, or ", options_.deadline.budget_text())
            : "";
    result_.solution.message = fmt::format(
        "no trajectory to begin the fit with was found, neither for {} nor together with values that fit the "
        "data; {}give better values in [system] parameters or [guess]",
        values_text(), spent);
    return false;
  }

  Solution solve(const Guess& guess, double duration) {
    const std::optional<Problem> problem = task_.problem(result_.values, guess, duration);
    if (problem) return task_.solve(*problem, options_);
    Solution none;
    none.message = fmt::format("there is no such problem at {}", values_text());
    return none;
  }

  /// On elements of its own. Coarse ones, with which a solve begins, move a member of a family to others by
  /// as much as they err: then the guess is moved back.
  Solution solve_again(const Trajectory& fitted) {
    const Eigen::Index count = members();
    Eigen::VectorXd back = Eigen::VectorXd::Zero(count);
    Eigen::MatrixXd guesses(count, 0), offs(count, 0);
    for (int k = 0;; ++k) {
      Solution solution = solve(guess_of_elements(moved(back)), fitted.duration());
      if (!solution.converged() || count == 0) return solution;
      const Eigen::VectorXd off = moved_by(solution.trajectory, fitted);
      if (off.lpNorm<Eigen::Infinity>() <= least_shift * options_.tolerance || k == most_shifts + count)
        return solution;
      back = next_guess(back, off, guesses, offs);
    }
  }

  /// By the secants of all guesses before; across these as if a guess moved its solution by as much.
  static Eigen::VectorXd next_guess(const Eigen::VectorXd& guess, const Eigen::VectorXd& off,
                                    Eigen::MatrixXd& guesses, Eigen::MatrixXd& offs) {
    const Eigen::Index before = guesses.cols();
    guesses.conservativeResize(Eigen::NoChange, before + 1);
    offs.conservativeResize(Eigen::NoChange, before + 1);
    guesses.col(before) = guess;
    offs.col(before) = off;
    if (before == 0) return guess - off;
    const Eigen::MatrixXd moved = guesses.leftCols(before).colwise() - guess,
                          answers = offs.leftCols(before).colwise() - off;
    const Eigen::VectorXd parts = least_norm(answers, off);
    return guess - moved * parts - (off - answers * parts);
  }

  /// The fitted path, along its family.
  Trajectory moved(const Eigen::VectorXd& by) const {
    Path path = path_->path();
    double duration = path.duration();
    for (Eigen::Index j = 0; j < by.size(); ++j) {
      const Step& member = path_->members()[j];
      path.add(member.nodes, member.inner, by[j]);
      duration += by[j] * member.duration;
    }
    path.set_duration(duration);
    path.load_ends();
    return first_copy(trajectory_of(path), task_.coordinates);
  }

  /// Along which members a trajectory differs from the fitted one, by least squares.
  Eigen::VectorXd moved_by(const Trajectory& other, const Trajectory& fitted) const {
    const Eigen::Index n = fitted.coordinates, rows = fitted.elements() * n, count = members();
    std::vector<double> q(n), v(n), there(n);
    Eigen::MatrixXd fields(rows, count);
    Eigen::VectorXd away(rows);
    const auto put = [&](const auto& at, auto&& to) {
      for (int k = 0; k < fitted.elements(); ++k) {
        const double length = fitted.times[k + 1] - fitted.times[k];
        fitted.in_element(k, 0.5, q, v);
        at(fitted.times[k] + length / 2);
        for (Eigen::Index a = 0; a < n; ++a) to[k * n + a] = std::sqrt(length) * (there[a] - q[a]);
      }
    };
    put([&](double t) { other.at(std::min(t, other.duration()), there, v); }, away);
    for (Eigen::Index j = 0; j < count; ++j) {
      const Trajectory beside = moved(small_move * Eigen::VectorXd::Unit(count, j));
      put([&](double t) { beside.at(std::min(t, beside.duration()), there, v); }, fields.col(j));
    }
    return least_norm(fields / small_move, away);
  }

  std::string values_text() const {
    std::vector<std::string> texts;
    for (std::size_t j = 0; j < result_.values.size(); ++j)
      texts.push_back(fmt::format("{} = {:.12g}", task_.unknowns[j].name, result_.values[j]));
    return fmt::format("{}", fmt::join(texts, ", "));
  }

  void fail(std::string why) {
    result_.solution.status = Status::not_converged;
    result_.solution.message = std::move(why);
  }

  Eigen::Index members() const { return std::ssize(path_->members()); }

  /// Of an unknown; steps along members are of the size of the path.
  double size(std::size_t j) const { return j < task_.unknowns.size() ? task_.unknowns[j].size : 1; }

  std::vector<double> unscaled(std::span<const double> x) const {
    std::vector<double> values(x.begin(), x.end());
    for (std::size_t j = 0; j < values.size(); ++j) values[j] *= size(j);
    return values;
  }

  bool evaluate(std::span<const double> x, std::span<double> residuals, std::span<double> jacobian) {
    if (!path_->evaluate(unscaled(x), residuals, jacobian)) return false;
    const std::size_t count = x.size();
    for (std::size_t i = 0; i < jacobian.size(); ++i) jacobian[i] *= size(i % count);
    return true;
  }

  /// Nearly by steps of Gauss and Newton; where these leave the values that have extremals, by shorter ones.
  bool minimise_on_elements() {
    const std::vector<double> start = result_.values;
    const Solution first = result_.solution;
    for (const double radius : first_radii) {
      result_.values = start;
      result_.solution = first;
      path_->take(first, start);
      if (minimise_from(radius)) return true;
      if (options_.deadline.passed()) break;
    }
    return false;
  }

  bool minimise_from(double radius) {
    CurveFit fit{
        .residuals = task_.data.count(), .loss = task_.loss, .evaluate = {}, .count = {}, .radius = radius};
    fit.evaluate = [this](auto x, auto r, auto j) { return evaluate(x, r, j); };
    fit.count = [this](int iteration, double cost) {
      if (progress_) progress_({iteration, path_->path().elements(), path_->path().degree(), 2 * cost});
      return !options_.deadline.passed();
    };
    if (!path_->converge_on_elements()) {
      fail("Newton's method does not converge on the elements of the first trajectory");
      return false;
    }
    std::vector<double> x = path_->coordinates();
    for (std::size_t j = 0; j < x.size(); ++j) x[j] /= size(j);
    const CurveFitReport report = minimise(fit, x, options_.deadline);
    if (report.converged) polish(x);
    // The path of a step that was not taken is left for that of the minimum.
    std::vector<double> residuals(fit.residuals);
    const bool there = path_->evaluate(unscaled(x), residuals, {});
    if (there) result_.values = path_->values();
    if (!report.converged || !there)
      fail(fmt::format("the fit stopped at {}: {}; give better values in [system] parameters or [guess]",
                       values_text(), there ? report.failure : "there is no extremal"));
    return report.converged && there;
  }

  /// Roundoff of the sum hides the last digits of its minimum: steps of Gauss and Newton go on while they
  /// shrink.
  void polish(std::vector<double>& x) {
    std::vector<double> residuals(task_.data.count()), entries(residuals.size() * x.size()), best = x;
    double length = INFINITY;
    for (int k = 0; k < most_last_steps && evaluate(x, residuals, entries); ++k) {
      const Weighted at = weighted(residuals, entries);
      if (k == 0) length = first_last_step * at.residuals.norm();
      const Eigen::VectorXd step = least_norm(at.jacobian, at.residuals, undetermined);
      const double next = (at.jacobian * step).norm();
      if (!(next < length / 2)) break;
      length = next;
      best = x;
      for (std::size_t j = 0; j < x.size(); ++j) x[j] -= step[static_cast<Eigen::Index>(j)];
    }
    x = best;
  }

  /// With √ρ' as weights.
  struct Weighted {
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;
  };
  Weighted weighted(std::span<const double> residuals, std::span<const double> entries) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = std::ssize(residuals), count = std::ssize(entries) / rows;
    Weighted result{Eigen::Map<const Eigen::VectorXd>(residuals.data(), rows),
                    Eigen::Map<const RowMajor>(entries.data(), rows, count)};
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double weight = std::sqrt(extremal::evaluate(task_.loss, std::pow(result.residuals[i], 2)).slope);
      result.residuals[i] *= weight;
      result.jacobian.row(i) *= weight;
    }
    return result;
  }

  /// Residuals, χ² and covariance at the minimum. False where some unknown is not determined.
  bool determined() {
    const std::size_t rows = task_.data.count(), count = task_.unknowns.size() + path_->members().size();
    std::vector<double> residuals(rows), entries(rows * count);
    if (!path_->evaluate_by_values(residuals, entries)) {
      fail(fmt::format("at {} the second variation is singular", values_text()));
      return false;
    }
    result_.chi_squared = 0;
    for (const double r : residuals) result_.chi_squared += extremal::evaluate(task_.loss, r * r).value;
    keep_residuals(residuals);
    const Weighted at = weighted(residuals, entries);
    return invert(at.jacobian) && stationary(at);
  }

  /// Whether no step of Gauss and Newton lowers χ². A trust region also shrinks to nothing, where steps lead
  /// to other extremals.
  bool stationary(const Weighted& at) {
    const double lower = (at.jacobian * least_norm(at.jacobian, at.residuals)).norm();
    if (lower <= least_descent * at.residuals.norm() + options_.tolerance * task_.data.size()) return true;
    fail(fmt::format(
        "the fit stopped at {}, which is no minimum: a step of Gauss and Newton lowers chi squared "
        "from {:.6g} by {:.3g}; give better values in [system] parameters or [guess]",
        values_text(), result_.chi_squared, lower * lower));
    return false;
  }

  void keep_residuals(const std::vector<double>& residuals) {
    result_.residuals.clear();
    std::size_t next = 0;
    for (const ObservedColumn& column : task_.data.columns) {
      result_.residuals.emplace_back();
      for (const ObservedValue& value : column.values)
        result_.residuals.back().push_back(residuals[next++] * value.sigma);
    }
  }

  bool invert(const Eigen::MatrixXd& all) {
    const auto count = std::ssize(task_.unknowns);
    Eigen::MatrixXd jacobian = all.leftCols(count);
    Eigen::VectorXd effects(count), lengths(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      lengths[j] = jacobian.col(j).norm();
      effects[j] = lengths[j] * task_.unknowns[j].size;
    }
    // Along a direction that is not determined parameters may have become small, and their effects large.
    const double largest = std::min(effects.maxCoeff(), task_.data.size());
    std::vector<std::string> names;
    for (Eigen::Index j = 0; j < count; ++j)
      if (!(effects[j] > without_effect * largest)) names.push_back(task_.unknowns[j].name);
    if (!names.empty()) return undetermined_names(names);
    for (Eigen::Index j = 0; j < count; ++j) jacobian.col(j) /= lengths[j];
    const double least = members() > 0 ? std::max(undetermined_beside, options_.tolerance) : undetermined;
    const Eigen::Index along = leave_out(all.rightCols(all.cols() - count), jacobian);
    const auto [u, s, v] = singular_value_decomposition(jacobian);
    Eigen::VectorXd parts = Eigen::VectorXd::Zero(count);
    int open = 0;
    for (Eigen::Index k = 0; k < s.size(); ++k)
      if (!(s[k] > least * std::max(s[0], 1.0))) {
        parts = parts.cwiseMax(v.col(k).cwiseAbs());
        ++open;
      }
    for (Eigen::Index j = 0; j < count; ++j)
      if (parts[j] > named * parts.maxCoeff()) names.push_back(task_.unknowns[j].name);
    if (!names.empty()) return undetermined_names(names, open);
    const Eigen::MatrixXd half = lengths.cwiseInverse().asDiagonal() * v * s.cwiseInverse().asDiagonal();
    result_.covariance = half * half.transpose();
    result_.freedom = static_cast<int>(jacobian.rows() - count - along);
    result_.scaled = !task_.data.sigmas && result_.freedom > 0;
    if (result_.scaled) result_.covariance *= result_.chi_squared / result_.freedom;
    return true;
  }

  /// Derivatives of what is not explained by another member of the family. Returns how many of these the data
  /// tell apart.
  static Eigen::Index leave_out(const Eigen::MatrixXd& members, Eigen::MatrixXd& jacobian) {
    if (members.cols() == 0) return 0;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(members.rows(), members.cols());
    qr.setThreshold(undetermined);
    qr.compute(members);
    const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(members.rows(), qr.rank());
    for (int pass = 0; pass < 2; ++pass) jacobian -= basis * (basis.transpose() * jacobian).eval();
    return qr.rank();
  }

  /// So many directions of all of them are open.
  bool undetermined_names(const std::vector<std::string>& names, int open = 1) {
    if (names.size() == 1)
      fail(fmt::format(
          "the data do not determine '{0}': it changes nothing that was observed; leave '{0}' out of "
          "the fit, or observe what depends on it",
          names.front()));
    else
      fail(fmt::format(
          "the data do not determine '{}': along some change of all of them nothing that was "
          "observed changes; give {} of them, or observe what depends on {} alone",
          fmt::join(names, "', '"), open == 1 ? "one" : std::to_string(open), open == 1 ? "it" : "each"));
    return false;
  }

  /// Whether the trajectory of the fit is the solution to the tolerance, at its nodes and between. A scheme
  /// that was asked for with its elements has no other.
  bool agrees(const Trajectory& fitted) const {
    if (options_.elements > 0 && members() == 0) return true;
    const Trajectory& other = result_.solution.trajectory;
    std::vector<double> low(task_.coordinates, INFINITY), high(task_.coordinates, -INFINITY),
        q(task_.coordinates), v(q), p(q);
    double apart = 0, range = 0, most = 0;
    const int points = 2 * fitted.degree;
    for (int k = 0; k < fitted.elements(); ++k)
      for (int i = 0; i <= points; ++i) {
        const double tau = static_cast<double>(i) / points;
        fitted.in_element(k, tau, q, v);
        const double t = fitted.times[k] + tau * (fitted.times[k + 1] - fitted.times[k]);
        other.at(std::min(t, other.duration()), p, v);
        for (int a = 0; a < task_.coordinates; ++a) {
          apart = std::max(apart, std::abs(q[a] - p[a]));
          low[a] = std::min(low[a], p[a]);
          high[a] = std::max(high[a], p[a]);
          range = std::max(range, high[a] - low[a]);
          most = std::max(most, std::abs(p[a]));
        }
      }
    return apart <= options_.tolerance * (range > 0 ? range : most) + result_.solution.error_estimate;
  }

  /// A free duration may have become shorter than the data.
  bool covers_data() {
    const double latest = *std::ranges::max_element(task_.data.t), end = result_.solution.duration();
    if (latest <= (1 + roundoff_of_times) * end) return true;
    fail(
        fmt::format("the trajectory that fits ends at t = {:.9g}, before the last observation at t = {:.9g}; "
                    "leave later observations out, or give a longer duration in [guess]",
                    end, latest));
    return false;
  }

  /// Of closed orbits beside the fitted one the data choose, and not the guess. Their directions are among
  /// those in which the action does not change.
  bool knows_family() {
    const Solution& solution = result_.solution;
    if (!task_.closed || !solution.nullity || *solution.nullity <= members()) return true;
    fail(fmt::format(
        "at {} orbits beside this one close as well, in {} directions, of which the fit varies {}: "
        "the data may be those of another one; leave 'periodic' out, so that the ends are found",
        values_text(), *solution.nullity, members()));
    return false;
  }

  FitResult finished(int before) {
    Solution& solution = result_.solution;
    solution.iterations += before + path_->iterations();
    solution.message = fmt::format("{}, fitted to {} values: chi squared {:.6g}", solution.message,
                                   task_.data.count(), result_.chi_squared);
    explain_misfit();
    solution.strategy = "least squares around " + solution.strategy;
    return std::move(result_);
  }

  /// χ² of ν degrees of freedom has the mean ν and the variance 2ν where the data scatter by their standard
  /// deviations.
  void explain_misfit() {
    const double freedom = result_.freedom;
    if (!task_.data.sigmas || !(freedom > 0)) return;
    if (!(result_.chi_squared > freedom + most_deviations * std::sqrt(2 * freedom))) return;
    result_.solution.message += fmt::format(
        "; chi squared per degree of freedom is {:.3g}: residuals are {:.3g} times the standard "
        "deviations that the data give, so that the model does not explain them: start from other values if "
        "this is a minimum far from the best one",
        result_.chi_squared / freedom, std::sqrt(result_.chi_squared / freedom));
  }

  const FitTask& task_;
  const SolveOptions& options_;
  const std::function<void(const FitStep&)>& progress_;
  std::unique_ptr<FittedExtremal> path_;
  FitResult result_;
};

}  // namespace

FitResult fit(const FitTask& task, const SolveOptions& options,
              const std::function<void(const FitStep&)>& progress) {
  return Fit(task, options, progress).run();
}

}  // namespace extremal
