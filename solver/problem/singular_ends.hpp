#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "problem/beside_level.hpp"
#include "problem/problem.hpp"
#include "problem/singular_times.hpp"
#include "system/open_ends.hpp"

/// \file Ends at which L is infinite but its integral is not, as of a fall from rest itself.
///
/// At such an end one coordinate is at a level beside which L is finite. On motions of energy E its distance
/// d from the level has d' ~ d^−γ, so d ~ t^(1/(1+γ)), and ∫ L dt is finite if γ < 1. Then
///   d = w^m,  t = T φ(s/T),  φ ~ (s/T)^k,  k = m (1 + γ)
/// make w(s) a smooth function, which rises like s, and L̃(w, w', s) = φ' (L − dF/dt) a smooth Lagrangian
/// along it. F = C(t) d^(1−γ)/(1−γ) has the part of the momentum that is infinite, and is 0 at both ends: d
/// is, or C. The extremals, the action and the momenta at ends stay as they are.
///
/// Where it is the time of the end that makes L infinite (singular_times.hpp), only t is replaced.

namespace extremal {

/// The variables (w, s) of one coordinate and of the time, or of the time alone.
struct EndVariables {
  int coordinate = -1;         ///< none is at a level
  double level = 0, side = 1;  ///< q = level + side w^m
  double power = 1;            ///< m
  double start = 1, end = 1;   ///< exponents of φ at both ends; 1: that end is regular
  double duration = 0;         ///< T
  double speed = 0;            ///< γ
  /// Of the time alone: see SingularTime.
  bool no_momentum_at_start = false, no_momentum_at_end = false, unknown_index = false;
  DoubleDouble of_start = 0.0, of_end = 0.0;  ///< C at both ends

  bool has_level() const { return coordinate >= 0; }
  bool singular(bool at_end) const { return (at_end ? end : start) > 1; }
  /// Whether L̃ vanishes at the start or at the end, and the second variation beside it.
  bool fades() const {
    const auto by = [this](double exponent) { return std::abs(2 * power - exponent - 1) > 1e-3; };
    if (!has_level()) return unknown_index;
    return ((singular(false) && by(start)) || (singular(true) && by(end)));
  }
  bool infinite_momentum(bool at_end) const {
    return has_level() ? singular(at_end) : at_end ? no_momentum_at_end : no_momentum_at_start;
  }
  LevelGauge gauge() const { return {speed, of_start, of_end, duration}; }
  double time(double s) const;
  DoubleDouble precise_time(double s) const;  ///< with the last digits of T − t
  double rate(double s) const;                ///< dt/ds
  double remaining(double s) const;           ///< T − t, to its last digits
  double time_inverse(double t) const;
  double remaining_inverse(double rest) const;  ///< T − s by T − t
  double coordinate_at(double w) const;
  double variable_at(double q) const;  ///< w
};

/// L̃.
class SmoothedLagrangian : public Lagrangian, public OpenEnds {
 public:
  SmoothedLagrangian(std::shared_ptr<const Lagrangian> base, const EndVariables& variables);
  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override;

 private:
  std::shared_ptr<const Lagrangian> base_;
  EndVariables variables_;
};

/// An end at which L is not finite, whatever the velocity.
struct InfiniteLagrangian {
  bool at_end = false;
  std::vector<double> q;
  bool by_time = false;  ///< wherever the path is
  int coordinate = -1;   ///< that is at a level; −1: not known
  double beside = 0;     ///< where that is on the way, near the level
};

/// The first such end of a problem with ends that are fixed or free.
std::optional<InfiniteLagrangian> infinite_lagrangian(const Problem& problem);

/// Nothing if L is finite at the ends, if its integral is not, or if more than one coordinate makes it
/// infinite. Only between ends of which each coordinate is fixed or free. Of a free duration T is the guess.
std::optional<EndVariables> singular_ends(const Problem& problem);
/// The same, of a problem whose singular_times() are known.
std::optional<EndVariables> singular_ends(const Problem& problem, const std::vector<SingularTime>& times);

/// The problem in w and s, with its guess.
Problem smoothed(const Problem& problem, const EndVariables& variables);

}  // namespace extremal
