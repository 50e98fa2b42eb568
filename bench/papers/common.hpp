#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "report/figure.hpp"
#include "solve/solve.hpp"

/// \file What the figures share: problems with fixed ends and panels with powers of ten.

namespace extremal::papers {

using State = std::function<std::vector<double>(double t)>;

/// Fixed ends on a known motion, which is also the guess.
Problem on_motion(std::shared_ptr<const Lagrangian> lagrangian, const State& motion, double duration);

/// Solves with equal elements of a scheme. Throws std::runtime_error where that does not converge.
Solution solved(const Problem& problem, const std::string& scheme, int elements);

/// log10 y against log10 x: measured values as discs, formulas as lines.
struct Series {
  std::string name;
  std::vector<double> x, measured, formula;  ///< formula may be empty: discs are joined then
};

/// Two panels side by side.
inline constexpr Box left_box{70, 96, 390, 330}, right_box{560, 96, 390, 330};
Figure side_by_side(const std::string& title, const std::vector<std::string>& names);

/// Both axes in powers of ten.
Panel decades(const std::string& x, const std::string& y, const std::vector<Series>& series, Box box);

/// Of log measured against log x, by least squares.
double slope(const Series& series);

/// (1.10) to (1.12): ω_h and A_h of every scheme, measured on 60 periods, beside their formulas.
Figure frequencies_and_amplitudes();
/// Corollary 4.8: distance of spectra in the flat norm.
Figure convergence_of_spectra();
/// Theorem 4.7: sup |u_h − u| and sup |u_h' − u'|.
Figure convergence_of_velocities();
/// Lemmas 2.1, 4.2 and 5.3, and what happens where T reaches a conjugate point of the scheme.
Figure windows();
/// Chen, Guo and Wu, 3.2 to 3.6: energies of elements with equal steps and with times as unknowns.
Figure free_times();
/// Discrete frequencies of marched wave trains, and the growth of their errors.
Figure wave_trains();

}  // namespace extremal::papers
