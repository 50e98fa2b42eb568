#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "motion/flow.hpp"
#include "problem/problem.hpp"
#include "solve/search/motion_conditions.hpp"

/// \file Motions from all starts that the conditions there allow.

namespace extremal {

inline constexpr const char* from_start = "newton from a motion that meets the end";

/// The conditions at the start leave some entries w of (q, p) free: p_a(0) where q_a(0) is fixed, both where
/// one coordinate returns. As many conditions hold at T, so the motions sought are the zeros of a function of
/// w with as many values, of one or two here. A box of w is cut into cells until the function is nearly
/// linear in those that may hold a zero. Momenta have no bound where velocities may have one.
class StartScan {
 public:
  using Vector = Eigen::VectorXd;
  struct State {
    std::vector<double> q, v;
  };
  /// The w whose largest |w_a − centre_a| / unit_a is between the reaches.
  struct Shell {
    Vector centre, unit;
    Vector state_unit;  ///< of (q, p)
    double nearest, farthest;

    double reach(const Vector& w) const;
  };

  explicit StartScan(const Problem& problem);
  bool usable() const { return conditions_.has_value(); }

  /// About the starts of paths between `ends` that go as far as `extent`, and as fast as `speed`.
  Shell around(std::span<const double> ends, double extent, double speed);
  /// w of a motion with this state at the start.
  Vector unknown(std::span<const double> q, std::span<const double> v);
  /// The state of a motion at the start; nothing if no velocity belongs to w.
  std::optional<State> state(const Vector& w);
  /// The w of motions that meet the conditions at the end; of families of such none. False if there were not
  /// enough integrator steps: `more` is told how many were taken.
  bool zeros(const Shell& shell, const std::function<bool(int steps)>& more, std::vector<Vector>& found);

 private:
  using Place = std::array<std::int64_t, 2>;  ///< on the finest lattice of a shell
  struct Cell {
    Place corner;
    std::int64_t width;
  };
  struct Side {
    Vector w;
    double miss;
  };

  double momentum_unit(std::span<const double> q, int coordinate, double speed);
  double part_of_box(std::int64_t length) const;
  Vector at(Place place) const;
  const Vector& sample(Place place);
  Vector fly(const Vector& w);
  bool fly(const Vector& w, Vector& miss, Eigen::MatrixXd& derivatives);
  template <class Slope>
  bool integrate(const Slope& slope, Vector& y, double tolerance, int cost);
  double bend(const std::vector<Place>& places, int value);
  std::vector<Place> lattice(const Cell& cell) const;
  void divide(const Cell& cell, std::deque<Cell>& cells, std::vector<Vector>& found);
  bool search(const Cell& cell, const std::vector<Place>& lattice, std::vector<Vector>& found);
  void enclose(Side a, Side b, std::vector<Vector>& found);
  bool approach(Vector w, double width, std::vector<Vector>& found);

  const Problem& problem_;
  int n_, cost_;
  std::optional<MotionConditions> conditions_;
  int unknowns_ = 0;
  std::optional<Flow> flow_;
  Shell shell_;
  int cells_ = 0;  ///< of the box, along each coordinate
  std::map<Place, Vector> samples_;
  std::function<bool(int)> more_;
};

}  // namespace extremal
