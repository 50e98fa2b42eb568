#include "solve/contact/aside.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <utility>

#include "linear/dense.hpp"
#include "machine/bisect.hpp"
#include "problem/inequalities.hpp"
#include "problem/manifold.hpp"
#include "problem/point_range.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::VectorXd;

/// A part of the path on which one inequality does not hold: from where the path enters to where it leaves.
struct Passage {
  double from, to;          ///< numbers of nodes, with fractions
  VectorXd entry, leaving;  ///< slopes of g of unit size, in the metric of the inequalities
  VectorXd sum;             ///< of such slopes in between
};

class Passages {
 public:
  Passages(const Problem& problem, const CoarseAction& action, const std::vector<double>& z)
      : inequalities_(*problem.inequalities), action_(action), z_(z), n_(action.coordinates()), q_(n_) {}

  std::vector<Passage> all() {
    std::vector<Passage> found;
    std::vector<std::optional<Passage>> open(inequalities_.count());
    const int samples = action_.elements() * points_between;
    for (int i = 0; i <= samples; ++i) {
      const double place = static_cast<double>(i) / points_between;
      const ConstraintValues values = at(place);
      for (int c = 0; c < inequalities_.count(); ++c) {
        std::optional<Passage>& passage = open[c];
        if (values.g[c] < 0) {
          const VectorXd slope = unit(values.slopes.row(c));
          if (!passage) passage = Passage{place, place, slope, slope, VectorXd::Zero(n_)};
          passage->to = place;
          passage->leaving = slope;
          passage->sum += slope;
        }
        if (passage && (!(values.g[c] < 0) || i == samples)) {
          found.push_back(*std::move(passage));
          passage.reset();
        }
      }
    }
    return found;
  }

 private:
  ConstraintValues at(double place) {
    const int k = std::min(static_cast<int>(place), action_.elements() - 1);
    const double part = place - k;
    for (int a = 0; a < n_; ++a)
      q_[a] = (1 - part) * z_[static_cast<std::size_t>(k) * n_ + a] +
              part * z_[(static_cast<std::size_t>(k) + 1) * n_ + a];
    return inequalities_.all->at(q_, (1 - part) * action_.time(k) + part * action_.time(k + 1));
  }
  VectorXd unit(const VectorXd& slope) const {
    const double size = std::sqrt(slope.dot(inequalities_.all->metric() * slope));
    return size > 0 ? VectorXd(slope / size) : slope;
  }

  const Inequalities& inequalities_;
  const CoarseAction& action_;
  const std::vector<double>& z_;
  int n_;
  std::vector<double> q_;
};

/// Where the boundary turns between entry and exit, the path passes through in the direction of that turn:
/// the way out is across it. Of a wall, which does not turn, it is straight back.
VectorXd way_out(const Problem& problem, const Passage& passage, const std::vector<double>& z, int n) {
  const Eigen::MatrixXd& metric = problem.inequalities->all->metric();
  const auto across = [&](VectorXd slope) {
    const VectorXd along = passage.leaving - passage.entry;
    const double square = along.dot(metric * along);
    if (square > turned * turned && n > 1) slope -= slope.dot(metric * along) / square * along;
    return slope;
  };
  const VectorXd sum = across(passage.sum);
  const double size = std::sqrt(sum.dot(metric * sum)),
               all = std::sqrt(passage.sum.dot(metric * passage.sum));
  // Through the middle of an obstacle either side will do.
  VectorXd way =
      metric * (size > turned * std::max(all, 1.0) ? sum : across(solved(metric, across_line(z, n, 0))));
  const double largest = way.lpNorm<Eigen::Infinity>();
  if (largest > 0) way /= largest;
  return way;
}

/// The least distance along a way, about, at which all inequalities hold.
bool leave(const Problem& problem, std::span<double> q, double t, const VectorXd& way, double size) {
  const auto n = static_cast<std::size_t>(way.size());
  const std::vector<double> from(q.begin(), q.end());
  const auto kept = [&](double distance) {
    for (std::size_t a = 0; a < n; ++a) q[a] = from[a] + distance * way[static_cast<Eigen::Index>(a)];
    if (problem.manifold && !problem.manifold->project(q, t)) return false;
    return problem.inequalities->all->at(q, t).g.minCoeff() >= 0;
  };
  double within = 0, beyond = least_aside * size;
  while (!kept(beyond)) {
    within = beyond;
    beyond *= 2;
    if (beyond > most_aside * size) {
      std::ranges::copy(from, q.begin());
      return false;
    }
  }
  const auto broken = [&](double distance) { return !kept(distance); };
  return kept(bisect(within, beyond, aside_halvings, broken).high);
}

}  // namespace

bool move_aside(const Problem& problem, const CoarseAction& action, std::vector<double>& z) {
  const auto n = static_cast<std::size_t>(action.coordinates());
  const double size = largest_range(z, n);
  if (!(size > 0)) return false;
  std::vector<char> compared(static_cast<std::size_t>(action.elements()) + 1);
  for (const NodeInequality& place : action.places()) compared[place.node] = 1;
  bool out = true;
  for (const Passage& passage : Passages(problem, action, z).all()) {
    const VectorXd way = way_out(problem, passage, z, action.coordinates());
    const auto all_leave = [&](double sign) {
      bool all = true;
      for (int k = static_cast<int>(std::ceil(passage.from)); k <= passage.to && all; ++k)
        if (compared[k]) all = leave(problem, {z.data() + k * n, n}, action.time(k), sign * way, size);
      return all;
    };
    const std::vector<double> before = z;
    if (all_leave(1)) continue;
    z = before;
    if (all_leave(-1)) continue;
    z = before;
    out = false;
  }
  return out;
}

bool cuts_through(const Problem& problem, const CoarseAction& action, const std::vector<double>& z) {
  const auto n = static_cast<std::size_t>(action.coordinates());
  const double size = largest_range(z, n);
  std::vector<double> q(n);
  for (int k = 0; k < action.elements(); ++k) {
    double step = 0;
    for (std::size_t a = 0; a < n; ++a) {
      q[a] = (z[k * n + a] + z[(k + 1) * n + a]) / 2;
      step = std::max(step, std::abs(z[(k + 1) * n + a] - z[k * n + a]));
    }
    const ConstraintValues values =
        problem.inequalities->all->at(q, (action.time(k) + action.time(k + 1)) / 2);
    for (Eigen::Index c = 0; c < values.g.size(); ++c)
      if (values.g[c] < -(deepest_chord * step + on_it * size) * values.slopes.row(c).norm()) return true;
  }
  return false;
}

VectorXd across_line(const std::vector<double>& z, int n, unsigned number) {
  std::minstd_rand random{7 + 13 * number};
  VectorXd direction(n), chord(n);
  for (int a = 0; a < n; ++a) {
    direction[a] = 2.0 * random() / std::minstd_rand::max() - 1;
    chord[a] = z[z.size() - n + a] - z[a];
  }
  const double length = chord.norm();
  if (n > 1 && length > 0) direction -= direction.dot(chord) / (length * length) * chord;
  return direction.normalized();
}

}  // namespace extremal
