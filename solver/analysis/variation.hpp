#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "action/discrete_action.hpp"
#include "solution/solution.hpp"

/// \file The second variation of the action along a trajectory, piece by piece.

namespace extremal {

/// Quadratic form of Jacobi fields η on a piece, by their values x_a, x_b at its ends:
///   δ²S = ∫ η'ᵀL_vv η' + 2 η'ᵀL_vq η + ηᵀL_qq η dt = x_aᵀA x_a + 2 x_bᵀB x_a + x_bᵀD x_b,
/// and so their momenta L_vv η' + L_vq η are −(A x_a + Bᵀx_b) at the start and B x_a + D x_b at the end.
struct Piece {
  double start = 0, length = 0;
  Eigen::Map<const Eigen::MatrixXd> a, b, d;  ///< n × n
};

/// What evaluated the elements of a trajectory last, if anything did, and how large the two highest Legendre
/// coefficients of a Jacobi field may be there, relative to its largest: forms are exact to some four orders
/// below their square.
struct Condensed {
  const DiscreteAction* action = nullptr;
  double tail = 0;
};

/// What the form of a short piece with fixed ends must be: positive definite, so that it minimises; of as
/// many negative squares as positive ones, as for two copies of the coordinates; or anything, where the flow
/// of its Jacobi fields alone is wanted.
enum class Definite { positive, paired, none };

/// Pieces so short that the fixed-end form of each is positive definite and that polynomials resolve its
/// Jacobi fields: the elements of the trajectory, halved as often as that takes. Keeps memory.
class SecondVariation {
 public:
  /// Beyond this many coordinates the forms are not made.
  static constexpr int most_coordinates = 256;
  /// Beyond this many there are too many conjugate times, each too much work, to find them all.
  static constexpr int most_to_find_all = 128;

  /// The trajectory must outlive it. False where no piece is short enough: L_vv is not positive definite
  /// somewhere (Legendre's condition), or the second derivatives of L are not finite; or where it takes too
  /// many, since elements do not resolve the fields by far. There are no pieces then. Throws
  /// std::invalid_argument for more than most_coordinates.
  /// Elements that another condensed are the pieces if they resolve the fields well enough for it.
  /// Beyond T a path that is `closed` goes on; null: it ends there. Pieces have the squares that `definite`
  /// says.
  bool assemble(std::shared_ptr<const Lagrangian> lagrangian, const Trajectory& trajectory,
                const Condensed& condensed = {}, const ClosingMap* closed = nullptr,
                Definite definite = Definite::positive);
  /// Whether assemble() failed because there would be too many pieces.
  bool too_many() const { return too_many_; }

  int coordinates() const { return trajectory_->coordinates; }
  int count() const { return static_cast<int>(pieces_.size()); }
  Piece piece(int k) const;
  double end(int k) const { return pieces_[k].start + pieces_[k].length; }
  /// The first piece that ends after t, or the last.
  int piece_at(double t) const;
  /// (q', p') at the start of piece k, or, for k = count(), at T: where L does not depend on t, the field of
  /// the shift in time.
  Eigen::VectorXd shift(int k) const;

  /// The Jacobi fields of piece k at start + tau·length, n × n: those with x_a = I, x_b = 0 and with x_a = 0,
  /// x_b = I.
  void fields(int k, double tau, Eigen::MatrixXd& from_start, Eigen::MatrixXd& from_end);

 private:
  /// A part of an element, from tau0 to tau1.
  struct Part {
    int element;
    double tau0, tau1;
  };
  struct Kept {
    Part part;
    double start, length;
    int first;  ///< the first piece of those that were evaluated with it
  };
  double start(const Part& part) const {
    return trajectory_->times[part.element] + part.tau0 * trajectory_->length(part.element);
  }
  double length(const Part& part) const {
    return (part.tau1 - part.tau0) * trajectory_->length(part.element);
  }
  bool cut();
  void evaluate(std::span<const Part> parts);
  bool resolved(const DiscreteAction& action, int count, double allowed);
  void keep(const DiscreteAction& action, std::span<const Part> parts);
  bool take(const Condensed& condensed);
  const Eigen::MatrixXd& inner_by_ends(int k);
  void forget();
  void add_corners(const ClosingMap* closed);

  std::shared_ptr<const Lagrangian> lagrangian_;
  const Trajectory* trajectory_ = nullptr;
  const SchemeTables* scheme_ = nullptr;
  ElementTables tables_;

  bool too_many_ = false;
  Definite definite_ = Definite::positive;
  std::vector<Kept> pieces_;
  std::vector<double> forms_;  ///< A, B, D of each piece

  // What was evaluated last.
  DiscreteAction action_;
  Path path_;
  std::vector<Part> waiting_, batch_;
  std::vector<double> mesh_, lengths_, values_, steps_;
  AlignedDoubles inner_, rest_;
  int evaluated_ = -1;  ///< first piece of those
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> fields_;
  std::size_t kept_ = 0;
  std::vector<Eigen::MatrixXd>
      inner_by_ends_;  ///< of each piece, or empty: inner unknowns, (s − 1) n × 2n, by x_a, x_b
};

}  // namespace extremal
