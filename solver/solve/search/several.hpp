#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "machine/clock.hpp"
#include "solve/accept/acceptance.hpp"
#include "solve/search/closing_motions.hpp"
#include "solve/search/loop_search.hpp"
#include "solve/search/motion_scan.hpp"
#include "solve/search/search.hpp"
#include "solve/search/start_scan.hpp"

/// \file Several extremals of one problem.

namespace extremal {

class Homotopy;

/// Extremals one by one, cheapest first: the one that a solve finds; deflated Newton from its guess; guesses
/// bent by smooth noise of growing size, and arcs of circles; and from each extremal found along the families
/// that other durations and other ends make of it, which come past more of the problem's. The search
/// ends after as many steps as one solve may take without a new one. With one or two coordinates the motions
/// from the start that meet the end come first. With more, motions from the start, evenly drawn, are led to
/// the end until those that lead to no new extremal tell that none is likely to be missing between those
/// found. For a periodic problem, random loops that close as it asks take the place of arcs and motions.
/// Under a drive, motions that nearly close come first. An orbit that closes after part of the time, so that
/// it is run through several times, is left out.
class Several {
 public:
  Several(const Problem& problem, const SolveOptions& options, Workspace& workspace);

  /// At most so many, those of least action among all found, sorted by it; the first one's message says what
  /// was searched. Where there is none, one that has not converged.
  std::vector<Solution> run(int most);
  /// Whether a path was refused for the error that the tolerance leaves, see Acceptance::too_loose().
  bool too_loose() const { return too_loose_; }

 private:
  /// The number of the extremal that is the `same`; -1 if there is none.
  template <class Same>
  int find(const Same& same) const {
    const auto it = std::find_if(found_.begin(), found_.end(), same);
    return it == found_.end() ? -1 : static_cast<int>(it - found_.begin());
  }
  bool wanted() const;
  bool returns_suffice() const;
  int keep();
  int add(Solution candidate, bool held = false);
  int refine_and_keep(const ElementTables& tables, const char* strategy);
  double size_of_guess();
  void deflate();
  void guess();
  void bend();
  void descend();
  bool repeats(const Solution& candidate) const;
  void wind();
  double natural_duration(Arc arc, const ElementTables& tables);
  bool trace_families();
  void trace_family(std::size_t solution, int family);
  std::unique_ptr<Homotopy> leave(int family, bool onward);
  void load(const Solution& solution);
  std::function<bool(int)> scan_budget(double part = 1);
  bool trace_arrivals();
  StartScan::Shell first_starts();
  bool even_starts();
  bool scan_starts();
  bool scan_openings();
  void scan();
  double wanted_reach(double least, const std::function<double(const Solution&)>& reach_of) const;
  double wanted_reach();
  int within(double reach);
  bool reaches_known();
  std::string searched(std::size_t all) const;

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Search search_;
  Pursuit& pursuit_;  ///< of the search, as the two below
  GuessMesh& guess_;
  Path& path_;
  LoopSearch loops_;
  MotionScan motions_;
  StartScan starts_;
  ClosingMotions closing_;
  std::optional<double> period_;  ///< of L, of which that of orbits is a multiple
  std::vector<Solution> found_;
  std::optional<Solution> repeating_;  ///< the first that runs through an orbit several times
  double scale_ = 1;                   ///< size of the problem
  int most_ = 1;
  int in_vain_ = 0;         ///< guesses since the last find
  unsigned seed_ = 0;       ///< of the next guess
  unsigned enough_at_ = 0;  ///< guess after which there were as many extremals as are wanted
  int returns_ = 0;         ///< loops since the last find that led to known orbits
  long scan_steps_ = 0;     ///< of integrators
  int scanned_ = 0;         ///< motions
  int families_ = 0;
  std::size_t descended_ = 0;              ///< extremals that were left downhill where they are saddles
  int traced_count_ = 0;                   ///< families
  std::vector<std::vector<char>> traced_;  ///< for each extremal, whether each family of it was
  Clock::time_point start_;
  double analysing_ = 0;  ///< seconds
  bool too_loose_ = false;
};

}  // namespace extremal
