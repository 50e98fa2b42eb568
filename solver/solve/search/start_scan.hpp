#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "motion/batch_dop853.hpp"
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
  /// Whether all motions from a box last, and none is much harder to follow than the others: then no
  /// singularity folds the function.
  bool even(const Shell& shell, const std::function<bool(int steps)>& more);
  /// The w of motions that meet the conditions at the end; of families of such none. False if there were not
  /// enough integrator steps: `more` is told how many were taken.
  bool zeros(const Shell& shell, const std::function<bool(int steps)>& more, std::vector<Vector>& found);

 private:
  using Place = std::array<std::int64_t, 2>;  ///< on the finest lattice of a shell
  struct Cell {
    Place corner;
    std::int64_t width;
  };
  /// A place from which Newton's method looks for a zero about as near as the width of a cell.
  struct Candidate {
    enum class Fate { open, found, of_family, lost };
    std::size_t cell;
    Vector w, first;
    double width;  ///< by units
    double last_step = std::numeric_limits<double>::infinity();
    Fate fate = Fate::open;
  };
  struct Side {
    Vector w;
    double miss;
  };

  double step_error() const;
  double momentum_unit(std::span<const double> q, int coordinate, double speed);
  double part_of_box(std::int64_t length) const;
  Vector at(Place place) const;
  bool sample_all(std::span<const Cell> cells);
  double miss(const Vector& w);
  std::vector<int> move(Eigen::MatrixXd& states, double tolerance);
  double bend(const std::vector<const double*>& samples, int value) const;
  std::vector<const double*> samples(const std::vector<Place>& places) const;
  std::vector<Place> lattice(const Cell& cell) const;
  enum class Verdict { empty, divide, search };
  Verdict judge(const Cell& cell) const;
  std::int64_t fine() const;
  std::int64_t finest_searched() const;
  void search_between(const Cell& cell, std::vector<Vector>& found);
  void add_candidates(std::size_t number, const Cell& cell, std::vector<Candidate>& candidates) const;
  void enclose(Side a, Side b, std::vector<Vector>& found);
  void approach(Candidate& c, const Vector& end) const;
  void approach(std::vector<Candidate>& candidates, std::vector<Vector>& found);
  double distance(const Vector& d) const;

  const Problem& problem_;
  int n_, cost_;
  std::optional<MotionConditions> conditions_;
  int unknowns_ = 0;
  std::optional<Flow> flow_;
  std::optional<LaneFlow> lane_flow_;
  std::optional<BatchDop853> integrator_;
  Shell shell_;
  int cells_ = 0;  ///< of the box, along each coordinate
  std::map<Place, Vector> samples_;
  std::function<bool(int)> more_;
};

}  // namespace extremal
