#pragma once

#include <map>
#include <string>
#include <vector>

#include "verdict.hpp"

/// \file Verdicts counted, system by system.

namespace bench {

class Tally {
 public:
  void add(const Verdict& verdict);
  /// A table over systems and kinds of ends, then statuses and what went wrong.
  void print() const;
  bool faultless() const { return faults_.empty(); }

 private:
  struct Row {
    int scenes = 0, converged = 0, known = 0, known_converged = 0, refused = 0, wrong = 0;
    int too_far = 0, too_fast = 0;
    std::vector<double> estimates;  ///< over the true error
    double slowest = 0;
    std::uint64_t slowest_seed = 0, slowest_index = 0;
  };
  static void count(Row& row, const Verdict& verdict);
  static void print_rows(const std::map<std::string, Row>& rows);

  std::map<std::string, Row> systems_, kinds_, all_;
  std::map<std::string, int> faults_, statuses_;
};

}  // namespace bench
