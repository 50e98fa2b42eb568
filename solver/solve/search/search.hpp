#pragma once

#include <functional>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "solve/accept/acceptance.hpp"
#include "solve/adapt/refinement.hpp"
#include "solve/guess/first_path.hpp"

/// \file Where Newton's method starts from: the guess, and other paths where the guess fails.

namespace extremal {

/// Starting paths in turn, cheapest first, each pursued to the tolerance, within a bounded number of steps.
class Search {
 public:
  Search(const Problem& problem, const SolveOptions& options, Workspace& workspace);
  ~Search();
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  /// To a path that meets the tolerance and that `acceptance`, if given, accepts. The outcome stays the
  /// search's own until it is taken.
  const Outcome& run(Acceptance* acceptance = nullptr);
  /// The same from the guess only and without acceptance; a path far from the guess is a failure.
  const Outcome& run_near_guess();
  Outcome take() { return std::move(outcome_); }

  /// Makes path() an empty path, to be filled by the caller and refined.
  const ElementTables& open(const std::vector<double>& mesh, int degree);
  Path& path() { return path_; }
  /// Pursues path(), on elements of `tables`; whether an extremal was found.
  bool refine(const ElementTables& tables, const char* strategy);
  /// Puts the path that `fill` fills on elements that resolve it; false if it comes too near a singularity.
  bool open_fitting(const std::function<void(const ElementTables& tables, Path& path)>& fill,
                    int degree = Refinement::first_degree);
  /// Leads a motion from the start, which misses the end, through extremals with other ends to those of the
  /// problem: path() is nearly one of it then. False if it does not come there. Only for ends that are fixed.
  bool connect(const Guess& motion, double duration);
  /// Pursues a motion from the start that nearly meets the end; whether an extremal was found.
  bool refine_motion(const Guess& motion, double duration, const char* strategy);
  /// The same of a periodic problem, from a motion that does not close.
  bool close(const Guess& motion, const char* strategy);
  /// Leaves a saddle along its direction of most negative curvature, to either `side` (−1, 1), for a
  /// minimiser.
  bool descend_from(const Trajectory& saddle, double side);
  /// The same from the guess, saddles that the flow meets left to that side.
  bool descend_from_guess(double side);
  const ElementTables& tables() const { return refinement_.tables(); }
  /// Elements of a random path whose frequency is measured.
  static constexpr int sketch_elements = 16;
  /// Sizes of paths and effort are those of another search.
  void be_like(const Search& other);
  /// Effort that further paths may take together, in shares of that of one solve.
  void renew(double share = 1);
  /// Counts a step that the caller takes; false if there may be no more.
  bool count_step() { return refinement_.count_step(); }
  bool exhausted() const { return refinement_.exhausted(); }
  const Outcome& outcome() const { return outcome_; }
  const std::vector<double>& ends() const { return ends_; }
  const std::vector<double>& mesh() const { return mesh_; }
  /// ∫ω dt along the guess, by the bound of Frequency; at least 1.
  double phase() const { return phase_; }

 private:
  enum class GuessKind {
    usable,
    colliding,  ///< comes too near a singularity
    undefined,  ///< L is not finite along it
  };
  struct Pursuit {
    Refinement::Result result;
    bool doubtful;  ///< the equations were nearly singular
  };
  /// Routes tried and ends met, for the message.
  enum class Met { other_durations, weaker_forces, other_ends, noise, motions, equilibrium };
  static constexpr int most_first_elements = 1 << 12;
  /// Coarse elements may not resolve a family of extremals as it grows.
  static constexpr int homotopy_degree = 8;
  static int first_elements(const Frequency& frequency);
  void start(const std::vector<double>& mesh, const Bend& bend, int degree = Refinement::first_degree);
  GuessKind prepare();
  GuessKind begin();
  const Outcome& unless_spent();
  bool mesh_of_motion();
  void put_on_motion(std::size_t elements);
  bool search_on_steps_of_motion();
  bool search_with_double_digits();
  void end_at_kinks_of_guess();
  bool resolve_guess();
  Pursuit pursue(const char* strategy);
  Pursuit pursue_guess(const char* strategy);
  bool collapsed() const;
  Refinement::Result accepted();
  bool found(const char* strategy);
  bool from_other_guesses(GuessKind guess);
  bool through_other_durations();
  int kept_for_forces() const;
  bool through_weaker_forces();
  bool through_other_ends();
  bool refine_from(const Path& other, const char* strategy);
  bool by_gradient_flow(double side = 1);
  bool flow_from_guess(const Bend& bend, double side, bool staged = false);
  bool stages() const;
  bool flow_aside(double action, bool staged = false);
  bool flow_from(double away, double side, bool staged = false);
  void leave_saddles();
  double displaced_by_finer_elements();
  struct Placed {
    Path path;
    double change;  ///< of q, absolute
  };
  std::optional<Placed> moved_with_more_digits();
  bool held_in_time(const char* strategy, const std::function<void()>& renew);
  bool descend(int most, double close);
  bool by_descent(const std::vector<double>& mesh);
  bool from_finer_elements();
  bool from_line();
  bool from_motions();
  bool from_bracketed_motions(double mean, double fastest);
  bool from_settled_motion();
  bool from_noise(unsigned tries);
  bool may_be_family() const;
  bool on_family(bool resolved, int& steps_left);
  bool leaves_open();
  void nearest_to_guess();

  const Problem& problem_;
  const Problem* guess_;  ///< whose guess is started from
  const SolveOptions& options_;
  Workspace& w_;
  Outcome outcome_;
  Path& path_ = outcome_.path;
  Acceptance* acceptance_ = nullptr;
  Refinement refinement_;
  std::vector<double> ends_, mesh_;
  double magnitude_ = 0;        ///< of the guess
  double phase_ = 1;            ///< see phase()
  int allowance_ = 0;           ///< of Newton steps
  Bend bend_;                   ///< of the default guess, where L is not finite on it
  std::optional<Path> unheld_;  ///< found on some elements, but not on others
  int family_steps_of_flows_;   ///< left to families that flows end at
  bool no_family_ = false;      ///< the ends are conjugate near the guess, without a family
  unsigned seed_ = 0;
  std::set<Met> met_;
};

}  // namespace extremal
