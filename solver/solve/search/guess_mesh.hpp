#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "solve/guess/first_path.hpp"
#include "solve/search/pursuit.hpp"

/// \file Elements for a guess.

namespace extremal {

/// Puts the path that `fill` fills on elements that resolve it; false if it comes too near a singularity.
bool open_fitting(Pursuit& pursuit, const std::function<void(const ElementTables& tables, Path& path)>& fill,
                  int degree = Refinement::first_degree);

/// The guess of a problem, and the mesh that resolves it. It is put on the elements of a pursuit.
class GuessMesh {
 public:
  /// `problem` must outlive it.
  explicit GuessMesh(const Problem& problem) : problem_(problem), guess_(&problem) {}

  enum class Kind {
    usable,
    colliding,  ///< comes too near a singularity
    undefined,  ///< L is not finite along it
  };
  /// Puts the guess on a mesh that follows the frequency along it. The default guess is moved aside until L
  /// is finite on it.
  Kind begin(Pursuit& pursuit);
  /// The same, and bounds the effort of the pursuit by it.
  Kind prepare(Pursuit& pursuit);
  /// Elements that resolve a good guess; false if those there were do.
  bool resolve(Pursuit& pursuit);
  /// Pursues the guess. Few elements and doubles are faster, and often good enough. Where all attempts fail,
  /// the result is that of the first one: it tells whether others may lead to an extremal.
  Pursuit::Result pursue(Pursuit& pursuit, const char* strategy);
  /// The guess of `other` takes the place of this one while `attempt` runs; whether that succeeds. Ends and
  /// mesh remain those of the other.
  template <class Attempt>
  bool instead(const Problem& other, const Attempt& attempt) {
    guess_ = &other;
    const bool result = attempt();
    guess_ = &problem_;
    return result;
  }

  /// Puts the guess on the mesh.
  void start(Pursuit& pursuit, int degree = Refinement::first_degree) const;
  /// The same on another mesh, moved aside by `bend`.
  void start(Pursuit& pursuit, const std::vector<double>& mesh, const Bend& bend,
             int degree = Refinement::first_degree) const;
  /// Fills a path, already reset, with the guess moved aside by `bend`.
  void fill(const Bend& bend, const ElementTables& tables, Path& path) const;

  const std::vector<double>& ends() const { return ends_; }
  const std::vector<double>& mesh() const { return mesh_; }
  /// Of the default guess, where L is not finite on it.
  const Bend& bend() const { return bend_; }
  /// ∫ω dt along the guess, by the bound of Frequency; at least 1.
  double phase() const { return phase_; }

 private:
  bool mesh_of_motion(Pursuit& pursuit, const Frequency& frequency);
  void put_on_motion(Pursuit& pursuit, std::size_t elements);
  bool put_on_steps_of_motion(Pursuit& pursuit);
  bool take_more_digits(Pursuit& pursuit);
  void end_at_kinks(Pursuit& pursuit);

  const Problem& problem_;
  const Problem* guess_;  ///< whose guess it is
  std::vector<double> ends_, mesh_;
  Bend bend_;
  double phase_ = 1;
};

}  // namespace extremal
