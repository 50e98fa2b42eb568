#pragma once

#include <Eigen/Dense>
#include <functional>
#include <utility>
#include <vector>

#include "motion/flow.hpp"

/// \file Motions from a point that come by another one.

namespace extremal {

/// Motions leave q0 at t = 0 with momenta p0 + root w, p0 that of rest: momenta have no bound where
/// velocities may have one. One that comes by q1 at a time T meets
///   root (q(T; w) − q1) = 0,
/// as many equations as coordinates for one unknown more. So arrivals form curves, and the motions that
/// arrive at a given time are where curves cross it. On a manifold w and the equations have as many
/// components as it has dimensions. Curves are met on motions of given |w|: in one dimension q passes q1; in
/// two, neighbours pass it on different sides. Only for these.
class Arrivals {
 public:
  using Vector = Eigen::VectorXd;
  struct Arrival {
    Vector w;
    double time;
  };
  /// Gives w another size; false if none suits.
  using Scale = std::function<bool(Vector& w)>;
  /// Orthonormal columns, n × dimensions: w there may be at q0, and root δq at q1.
  struct Tangents {
    Eigen::MatrixXd start, end;
  };

  /// `root` is symmetric and positive, that of masses; `speed` and `time` are the units of w and of times.
  Arrivals(const Lagrangian& lagrangian, Vector start, Vector rest, Vector end, Eigen::MatrixXd root,
           const Tangents& tangents, double speed, double time);
  /// To be called with the steps of each integration; false if there may be no more.
  void count_by(std::function<bool(int steps)> counted) { counted_ = std::move(counted); }

  /// Of motions whose w have this length, or have been changed by `scale`, those that arrive until then.
  std::vector<Arrival> sweep(double speed, double until, const Scale& scale = {});
  /// Whether all motions of the sweeps lasted, but for single ones: between neighbours that did not there may
  /// be arrivals that were not met.
  bool all_last() const { return all_last_; }
  /// Along the curve of an arrival, both ways, to where motions are too fast or too long, or where it closes:
  /// its arrivals at the time that is the unit.
  std::vector<Arrival> along(const Arrival& seed, double fastest, double longest);
  /// Whether it is on a curve that was followed.
  bool followed(const Arrival& arrival) const;

 private:
  struct Curve;
  struct Passage {
    double time, side;  ///< where it is nearest to q1; its distance, positive to the left of q1
  };
  struct Point {
    Vector u, tangent;  ///< unknowns
  };
  struct Flight {
    Vector w;  ///< empty if there is none
    std::vector<Passage> passages;
    bool lasts = false;
  };

  Vector state(const Vector& w) const;
  Vector unknowns(const Arrival& arrival) const;
  Arrival arrival(const Vector& u) const;
  bool trace(const Vector& seed, double sense, double fastest, double longest, std::vector<Arrival>& found);
  void cross(const Point& a, const Point& b, std::vector<Arrival>& found);
  Flight flight(Vector w, double until, const Scale& scale);
  void pass(Flight& flight, double until);
  void land(const Vector& w, double time, std::vector<Arrival>& found);
  void compare(const Flight& one, const Flight& other, double until, const Scale& scale, int halvings,
               std::vector<Arrival>& found);

  Flow flow_;
  int n_, dimensions_, cost_;
  Vector start_, rest_, end_;
  Eigen::MatrixXd root_;
  Eigen::MatrixXd along_, onto_;  ///< of w at q0, n × dimensions; of q − q1, dimensions × n
  double speed_, time_, extent_;
  std::function<bool(int)> counted_;
  std::vector<std::vector<Point>> curves_;
  bool all_last_ = true;
};

}  // namespace extremal
