#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "action/corners.hpp"
#include "action/discrete_action.hpp"
#include "solution/solution.hpp"

/// \file The second variation of the action along a trajectory, piece by piece.

namespace extremal {

/// Quadratic form of Jacobi fields η on a piece, by their values x_a, x_b at its ends:
///   δ²S = ∫ η'ᵀL_vv η' + 2 η'ᵀL_vq η + ηᵀL_qq η dt = x_aᵀA x_a + 2 x_bᵀB x_a + x_bᵀD x_b,
/// and so their momenta L_vv η' + L_vq η are −(A x_a + Bᵀx_b) at the start and B x_a + D x_b at the end.
struct Piece {
  double start = 0, length = 0;
  Eigen::Map<const Eigen::MatrixXd> a;  ///< n × n
  Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> b;
  Eigen::Map<const Eigen::MatrixXd> d;
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
  /// The trajectory must outlive it. False where no piece is short enough: L_vv is not positive definite
  /// somewhere (Legendre's condition), or the second derivatives of L are not finite; or where it takes too
  /// many, since elements do not resolve the fields by far, or the elements too much memory. There are no
  /// pieces then. Elements that another condensed are the pieces if they resolve the fields well enough for
  /// it. Beyond T a path that is `closed` goes on; null: it ends there. Pieces have the squares that
  /// `definite` says.
  bool assemble(std::shared_ptr<const Lagrangian> lagrangian, const Trajectory& trajectory,
                const Condensed& condensed = {}, const ClosingMap* closed = nullptr,
                Definite definite = Definite::positive);
  /// The pieces are the elements of a path, with the forms and the Jacobi fields that the scheme of `tables`
  /// gives them: polynomials of its degree, which forms of parts of pieces follow from. The product of their
  /// flows is that of the scheme, and a shift in time is no symmetry of it. The trajectory is that of the
  /// path; both, and the tables, must outlive it. False where forms are not finite.
  bool assemble_elements(std::shared_ptr<const Lagrangian> lagrangian, const Trajectory& trajectory,
                         const Path& path, const ElementTables& tables, const ClosingMap* closed);
  /// There are no pieces from now on.
  void clear();
  bool of_scheme() const { return of_scheme_; }
  /// Whether the form of each piece with fixed ends is positive definite.
  bool definite() const { return action_.nodes.negative == 0; }
  /// Whether assemble() failed because there would be too many pieces, or because they are too large.
  bool too_many() const { return too_many_; }
  bool too_large() const { return too_large_; }

  int coordinates() const { return trajectory_->coordinates; }
  const Lagrangian& lagrangian() const { return *lagrangian_; }
  bool has_kinks() const { return lagrangian_->kinks() != nullptr; }
  int count() const { return static_cast<int>(pieces_.size()); }
  /// If there are too many pieces to keep all, only after hold(k).
  Piece piece(int k) const;
  /// Evaluates the forms of piece k if they are not kept.
  void hold(int k);
  double end(int k) const { return pieces_[k].start + pieces_[k].length; }
  /// The first piece that ends after t, or the last.
  int piece_at(double t) const;
  /// (q', p') at the start of piece k, or, for k = count(), at T: where L does not depend on t, the field of
  /// the shift in time.
  Eigen::VectorXd shift(int k) const;

  /// Where the path crosses surfaces that depend on velocities at the end of piece k, none of which its form
  /// D has.
  std::vector<Switch> switches_after(int k) const;

  /// The Jacobi fields of piece k at start + tau·length, n × n: those with x_a = I, x_b = 0 and with x_a = 0,
  /// x_b = I.
  void fields(int k, double tau, Eigen::MatrixXd& from_start, Eigen::MatrixXd& from_end);

  /// Whether start_forms() and end_form() may be asked for.
  bool has_part_forms() const { return !of_scheme_ && !has_kinks(); }
  /// The form A of the part of piece k from its start to start + tau·length, for each tau in (0, 1].
  std::vector<Eigen::MatrixXd> start_forms(int k, std::span<const double> tau);
  /// The form D of the part from start + tau·length, tau in [0, 1), to its end.
  Eigen::MatrixXd end_form(int k, double tau);

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
  void begin(std::shared_ptr<const Lagrangian> lagrangian, const Trajectory& trajectory);
  void keep_elements(const DiscreteAction& action);
  bool cut();
  void evaluate(std::span<const Part> parts);
  bool resolved(const DiscreteAction& action, int count, double allowed);
  void keep(const DiscreteAction& action, std::span<const Part> parts);
  void keep_forms(const DiscreteAction& action, int count);
  void evaluate_group(int k);
  bool take(const Condensed& condensed);
  const Eigen::MatrixXd& inner_by_ends(int k);
  void forget();
  void find_crossings(const ClosingMap* closed);

  std::shared_ptr<const Lagrangian> lagrangian_;
  const Trajectory* trajectory_ = nullptr;
  const SchemeTables* scheme_ = nullptr;
  ElementTables tables_;

  bool too_many_ = false, too_large_ = false, of_scheme_ = false;
  Definite definite_ = Definite::positive;
  std::vector<Kept> pieces_;
  std::vector<double> forms_;  ///< A, B, D of each piece, or of those evaluated last
  int forms_from_ = 0;         ///< the first of these pieces
  std::vector<Switch> switches_;

  // What was evaluated last.
  DiscreteAction action_;
  Path path_;
  std::vector<Part> waiting_, batch_;
  std::vector<double> mesh_, lengths_, values_, weights_, steps_;
  AlignedDoubles inner_, rest_;
  int evaluated_ = -1;  ///< first piece of those
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> fields_;
  std::size_t kept_ = 0;
  std::vector<Eigen::MatrixXd>
      inner_by_ends_;  ///< of each piece, or empty: inner unknowns, (s − 1) n × 2n, by x_a, x_b
};

}  // namespace extremal
