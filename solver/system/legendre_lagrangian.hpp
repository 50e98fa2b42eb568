#pragma once

#include <memory>
#include <vector>

#include "system/momentum_search.hpp"
#include "system/tape_lagrangian.hpp"

namespace extremal {

/// L(q, v, t) = p·v − H(q, p, t), where H_p(q, p, t) = v is solved for p at each point. L depends on q, v, t
/// alone: nothing is kept between calls. Where no solution is found L is not a number, as outside the domain
/// of any Lagrangian: v may be out of the range of H_p, as |v| >= 1 for H = sqrt(1 + p²).
class LegendreLagrangian final : public Lagrangian {
 public:
  /// The kinks are those of L. Throws as MomentumSearch does.
  LegendreLagrangian(const LagrangianGraph& hamiltonian, std::shared_ptr<const Kinks> kinks);

  const Kinks* kinks() const override { return kinks_.get(); }

  /// H, with momenta for velocities.
  const Lagrangian& hamiltonian() const { return hamiltonian_; }

  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override;
  bool evaluate_extended(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                         PointScratch<Extended>& scratch) const override;
  bool evaluate_extended(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                         DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const override;

 private:
  /// Momenta that H_pp couples, and the coordinates with an entry of H_pq. Rows are those of evaluate() from
  /// Order::hessian; -1: zero.
  struct Block {
    std::vector<int> momenta, coordinates;
    std::vector<int> pp, pq;      ///< of H: size × size, size × coordinates
    std::vector<int> vv, vq, qq;  ///< of L: likewise, and coordinates × coordinates; above the diagonal -1
    int size() const { return static_cast<int>(momenta.size()); }
    int width() const { return static_cast<int>(coordinates.size()); }
  };
  struct Evaluation;

  void make_blocks();
  void make_structure();
  Evaluation evaluate_hamiltonian(const Points& points, Order order, std::size_t further,
                                  Scratch& scratch) const;
  void invert(const Block& block, const Evaluation& at) const;
  void add_block(const Block& block, const Evaluation& at, double* out) const;
  template <class Number>
  bool extended(const Number* q, const Number* v, const Number& t, Number* out,
                PointScratch<Number>& scratch) const;

  TapeLagrangian hamiltonian_;
  MomentumSearch search_;
  std::vector<Block> blocks_;
  int largest_ = 0, widest_ = 0;  ///< size and width of blocks
  std::vector<int> qq_;           ///< for each entry of L's Hessian the row of H with the same, or -1
  std::shared_ptr<const Kinks> kinks_;
};

}  // namespace extremal
