#include "solve/accept/sparse_windows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "solve/accept/limits.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/newton/sparse_model.hpp"

namespace extremal {

namespace {

using namespace limits::sparse_windows;

/// The problem of a part of a path between given ends: its second variation depends on no more.
Problem between_ends(const Problem& problem) {
  Problem fixed;
  fixed.lagrangian = problem.lagrangian;
  fixed.boundary.coordinates = problem.coordinates();
  for (const bool at_end : {false, true})
    for (int a = 0; a < problem.coordinates(); ++a) fixed.boundary.fix(a, at_end, 0);
  fixed.ends = solve_relation(fixed.boundary);
  return fixed;
}

/// Parts of a path, from place to place: at t_k the place is k, and between nodes it is linear in t.
class PartsOfPath {
 public:
  PartsOfPath(const Problem& problem, const Trajectory& trajectory, Levels& levels)
      : problem_(between_ends(problem)), trajectory_(trajectory), tables_(levels.at(trajectory.degree)) {}

  double time(double place) const {
    const int k = std::min(static_cast<int>(place), trajectory_.elements() - 1);
    return trajectory_.times[k] + (place - k) * (trajectory_.times[k + 1] - trajectory_.times[k]);
  }

  /// How many times in the part are conjugate to its start; nothing if its end is one of them, to working
  /// precision. The part is cut into so many elements or more, evenly in places.
  std::optional<int> conjugate_times(double from, double to, int elements) {
    elements = at_hand(elements);
    at_ = &of(elements);
    put_path(from, to, elements);
    at_->action.reset(*problem_.lagrangian, tables_, elements, false, Condense::nothing);
    if (!at_->model.evaluate(at_->action, at_->path, nullptr)) return std::nullopt;
    const Inertia inertia = at_->model.inertia(0, VariedBy::path);
    if (inertia.zero > 0) return std::nullopt;
    return inertia.negative;
  }

  /// The eigenvalue nearest zero of the last part's second variation, as a function of the nodes' values
  /// alone. It passes zero where the part ends at a time conjugate to its start, since elements are shorter
  /// than windows. By inverse iteration, which begins with the field of the part before.
  double softest(int steps) {
    const auto n = static_cast<std::size_t>(problem_.coordinates());
    std::vector<double>& x = at_->field;
    if (x.empty()) {
      x.assign(at_->path.nodes().size(), 0.0);
      for (std::size_t i = n; i + n < x.size(); ++i) x[i] = std::cos(1 + 2.4 * i);
    }
    double inverse = 0;
    for (int k = 0; k < steps; ++k) {
      at_->model.respond(at_->action, nullptr, x, at_->response);
      const std::vector<double>& y = at_->response.nodes;
      double xx = 0, xy = 0, largest = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        xx += x[i] * x[i];
        xy += x[i] * y[i];
        largest = std::max(largest, std::abs(y[i]));
      }
      inverse = xy / xx;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = y[i] / largest;
    }
    return 1 / inverse;
  }

  /// What the elements of the last call leave out of the field of softest(), relative.
  double left_out() {
    softest(inverse_steps);
    Path field;
    field.reset(tables_, at_->path.mesh(), 1);
    field.add(at_->response.nodes, at_->response.inner, 1);
    Resolution resolution;
    resolution.measure(field, tables_);
    return resolution.at(field.degree()).q / scales(field, tables_).q;
  }

 private:
  /// What so many elements need; the pattern of their matrix is ordered once.
  struct Elements {
    SparseModel model;
    DiscreteAction action;
    Path path;
    Step response;
    std::vector<double> field = {};  ///< at the nodes, of the eigenvalue nearest zero
  };

  /// To order a pattern takes several times as long as to factor it: up to twice as many elements will do.
  int at_hand(int elements) const {
    const auto made = by_count_.lower_bound(elements);
    return made != by_count_.end() && made->first <= 2 * elements ? made->first : elements;
  }

  Elements& of(int elements) {
    std::unique_ptr<Elements>& made = by_count_[elements];
    if (!made) {
      made = std::make_unique<Elements>();
      made->model.reset(problem_, tables_, elements);
    }
    return *made;
  }

  void put_path(double from, double to, int elements) {
    const int n = problem_.coordinates();
    const std::vector<double>& lobatto = tables_.scheme().lobatto;
    std::vector<double> mesh, values(lobatto.size() * n), v(n);
    for (int k = 0; k <= elements; ++k) mesh.push_back(time(from + (to - from) * k / elements));
    at_->path.reset(tables_, mesh, 1);
    for (int k = 0; k < elements; ++k) {
      for (std::size_t j = 0; j < lobatto.size(); ++j) {
        const double t = std::min(mesh[k] + lobatto[j] * (mesh[k + 1] - mesh[k]), trajectory_.duration());
        trajectory_.at(t, std::span(values).subspan(j * n, n), v);
      }
      at_->path.set_element(k, values.data());
    }
    at_->path.load_ends();
  }

  Problem problem_;
  const Trajectory& trajectory_;
  const ElementTables& tables_;
  std::map<int, std::unique_ptr<Elements>> by_count_;
  Elements* at_ = nullptr;
};

/// None is longer than those of the path; with two there is a node between them.
int elements_for(double places) { return std::max(2, static_cast<int>(std::ceil(places))); }

/// What is known of the first time conjugate to the start of a window: the window may end at `free_of`, and
/// not at `beyond`.
struct Bracket {
  double free_of, beyond;
  double last;  ///< of both, that which was tried last
};

/// From a first trial on, each by a factor farther or nearer than the one before.
std::optional<Bracket> bracket(PartsOfPath& parts, double from, double last, double first, double factor) {
  Bracket found{from, INFINITY, from};
  double trial = std::min(from + first, last);
  for (;;) {
    const std::optional<int> count = parts.conjugate_times(from, trial, elements_for(trial - from));
    if (!count) return std::nullopt;
    (*count == 0 ? found.free_of : found.beyond) = found.last = trial;
    if (found.free_of == last) return found;
    if (found.free_of > from && found.beyond < INFINITY) return found;
    trial = *count == 0 ? std::min(from + factor * (trial - from), last) : from + (trial - from) / factor;
    if (trial - from < shortest) return std::nullopt;
  }
}

/// Until the window is the longest there is, less a small part: on both sides of where the softest eigenvalue
/// leads, which falls with `slope` as the end moves away; by halves where it tells nothing, as beyond the
/// second conjugate time it may be another one. False where the elements do not resolve the field that
/// vanishes at both ends.
bool narrow(PartsOfPath& parts, double from, Bracket& found, double& slope) {
  struct Trial {
    double end, softest;
  };
  std::optional<Trial> known;
  const auto read = [&](double end, int count) {
    const double softest = count > 1 ? NAN : parts.softest(known ? 1 : inverse_steps);
    if (!(count == 0 ? softest > 0 : softest < 0)) return;
    if (known) slope = (softest - known->softest) / (end - known->end);
    known = {end, softest};
  };
  if (found.last == found.free_of) read(found.last, 0);
  const int elements = elements_for(found.beyond - from);
  for (int k = 1; found.beyond - found.free_of > margin * (found.free_of - from); ++k) {
    double trial = (found.free_of + found.beyond) / 2;
    if (known && slope < 0 && k % most_by_slope != 0) {
      const double root = known->end - known->softest / slope, third = margin / 3 * (root - from);
      const double aside = root - third > found.free_of + third ? root - third : root + third;
      if (aside > found.free_of && aside < found.beyond) trial = aside;
    }
    const std::optional<int> count = parts.conjugate_times(from, trial, elements);
    if (!count) return false;
    (*count == 0 ? found.free_of : found.beyond) = trial;
    read(trial, *count);
  }
  return parts.left_out() <= most_left_out;
}

}  // namespace

/// The count for the whole path is on elements that resolve fields as well as those of the windows do.
std::optional<SparseWindows> sparse_windows(const Problem& problem, const Trajectory& trajectory,
                                            std::optional<int> index) {
  Levels levels;
  levels.bind(problem.lagrangian);
  PartsOfPath parts(problem, trajectory, levels);
  const double last = trajectory.elements();
  SparseWindows result;
  double first = std::min(first_trial, last), factor = 2, longest_element = 1, slope = 0;
  for (double from = 0; from < last;) {
    std::optional<Bracket> found = bracket(parts, from, last, first, factor);
    if (!found) return std::nullopt;
    if (found->free_of < last) {
      if (!narrow(parts, from, *found, slope)) return std::nullopt;
      longest_element = std::min(longest_element, (found->free_of - from) / 2);
    } else if (from == 0 && !(parts.left_out() <= most_left_out)) {
      return std::nullopt;
    }
    const bool ends = found->free_of == last;
    result.windows.push_back({parts.time(from), ends ? trajectory.duration() : parts.time(found->free_of)});
    factor = like_the_last;
    first = factor * (found->free_of - from);
    from = found->free_of;
  }
  if (result.windows.size() == 1) return result;
  const std::optional<int> all = index && longest_element == 1
                                     ? index
                                     : parts.conjugate_times(0, last, elements_for(last / longest_element));
  if (!all) return std::nullopt;
  result.conjugate_times = *all;
  return result;
}

}  // namespace extremal
