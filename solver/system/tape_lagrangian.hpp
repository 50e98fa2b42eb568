#pragma once

#include <memory>
#include <span>
#include <vector>

#include "system/extended_hessian.hpp"
#include "system/kinks.hpp"
#include "system/lagrangian.hpp"
#include "system/structure.hpp"
#include "system/tape_program.hpp"

namespace extremal {

/// The size of what one evaluation plays.
struct TapeSummary {
  int kernels = 0;
  int rows = 0;          ///< of all kernels
  int instructions = 0;  ///< one row of each kernel
  long long played = 0;  ///< all rows
  int slots = 0;         ///< of the kernel that needs most
};

/// Kernels ready to be played into numbered rows of output.
class Tape {
 public:
  /// What a kernel adds to the output.
  struct Contribution {
    std::shared_ptr<const Kernel> kernel;
    std::vector<Scaled> roots;
    std::vector<int> rows;  ///< the kernel's rows × roots: the row of output
  };
  Tape() = default;
  Tape(std::span<const Contribution> contributions, int outputs, std::span<const double> uniforms);

  /// The same with other values of the uniforms.
  Tape with(std::span<const double> uniforms) const;
  /// Writes every row of output at every point.
  void play(const Points& points, double* out, Scratch& scratch) const;
  /// The same at one point, in extended precision.
  template <class Number>
  void play_extended(const Number* q, const Number* v, const Number& t, Number* out,
                     PointScratch<Number>& scratch) const;
  /// Asks for as much scratch memory as the other, so that none is allocated in going from one to the other.
  void fit(const Tape& other);
  TapeSummary summary() const;
  /// Of scratch memory, that playing so many points takes from its beginning; whole rows of 64 bytes.
  std::size_t doubles(int points) const;

 private:
  struct Target {
    int row;
    bool clear;  ///< before it is added to
  };
  /// A kernel's program and where its rows write.
  struct Track {
    std::shared_ptr<const Kernel> kernel;
    Program program;
    std::vector<Target> targets;  ///< rows × outputs
  };
  struct Chunk;
  static Track track(const Contribution& contribution, std::vector<bool>& touched);
  static void play(const Track& track, const RowNumbers& scalars, const Chunk& chunk);
  void put(std::span<const double> uniforms);
  int width(int batches) const;

  std::shared_ptr<const std::vector<Track>> tracks_ = std::make_shared<const std::vector<Track>>();
  std::vector<RowNumbers> scalars_;  ///< of the programs
  std::vector<int> untouched_;       ///< rows of output that no track writes
  int slots_ = 0, operands_ = 0;     ///< of the track that needs most
  int widest_ = 1;                   ///< batches played together
};

/// A Lagrangian from an expression graph.
class TapeLagrangian final : public Lagrangian, public ExtendedHessian {
 public:
  /// Throws std::invalid_argument for a malformed graph.
  explicit TapeLagrangian(const LagrangianGraph& lagrangian, std::shared_ptr<const Kinks> kinks = nullptr);

  const Kinks* kinks() const override { return kinks_.get(); }

  std::shared_ptr<const Lagrangian> with(std::span<const double> parameters) const override;
  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override;
  bool evaluate_extended(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                         PointScratch<Extended>& scratch) const override;
  bool evaluate_extended(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                         DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const override;
  void evaluate_hessian(const DoubleDouble* q, const DoubleDouble* v, const DoubleDouble& t,
                        DoubleDouble* out, PointScratch<DoubleDouble>& scratch) const override;
  void evaluate_hessian(const Extended* q, const Extended* v, const Extended& t, Extended* out,
                        PointScratch<Extended>& scratch) const override;

  TapeSummary summary(Order order) const { return orders_[static_cast<int>(order)].summary(); }
  /// Of scratch memory, that an evaluation at so many points takes from its beginning.
  std::size_t doubles(int points) const;

 private:
  Tape orders_[3];
  std::vector<Tape> sensitivities_;  ///< by parameter
  std::shared_ptr<const Kinks> kinks_;
  std::vector<double> uniforms_;
  std::shared_ptr<const StructureNumbers> numbers_;  ///< null where values cannot be put in
};

}  // namespace extremal
