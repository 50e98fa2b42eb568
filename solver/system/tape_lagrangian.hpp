#pragma once

#include <memory>
#include <span>
#include <vector>

#include "system/extended_hessian.hpp"
#include "system/kinks.hpp"
#include "system/lagrangian.hpp"
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
    const Kernel* kernel;
    std::vector<Scaled> roots;
    std::vector<int> rows;  ///< the kernel's rows × roots: the row of output
  };
  Tape() = default;
  Tape(std::span<const Contribution> contributions, int outputs, std::span<const double> uniforms);

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
  /// A kernel's program and where its rows read and write.
  struct Track {
    Program program;
    int rows;
    std::vector<Variable> kinds;
    std::vector<std::uint32_t> sources;  ///< rows × inputs: index among its kind
    std::vector<Target> targets;         ///< rows × outputs
    RowNumbers scalars;
  };
  struct Chunk;
  static Track track(const Contribution& contribution, std::vector<bool>& touched,
                     std::span<const double> uniforms);
  static void play(const Track& track, const Chunk& chunk);
  int width(int batches) const;

  std::vector<Track> tracks_;
  std::vector<int> untouched_;    ///< rows of output that no track writes
  int slots_ = 0, operands_ = 0;  ///< of the track that needs most
  int widest_ = 1;                ///< batches played together
};

/// A Lagrangian from an expression graph.
class TapeLagrangian final : public Lagrangian, public ExtendedHessian {
 public:
  /// Throws std::invalid_argument for a malformed graph.
  explicit TapeLagrangian(const LagrangianGraph& lagrangian, std::shared_ptr<const Kinks> kinks = nullptr);

  const Kinks* kinks() const override { return kinks_.get(); }

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
};

}  // namespace extremal
