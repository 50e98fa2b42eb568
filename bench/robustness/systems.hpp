#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "problem/problem.hpp"

namespace bench {

struct State {
  std::vector<double> q, v;
};

/// A system of problems/systems, some of its parameters changed.
std::shared_ptr<const extremal::Lagrangian> system(const std::string& name,
                                                   const std::map<std::string, double>& parameters = {});

/// q(0) = start, q(T) = end; without a guess.
extremal::Problem fixed_ends(const std::shared_ptr<const extremal::Lagrangian>& lagrangian,
                             const std::vector<double>& start, const std::vector<double>& end,
                             double duration);

}  // namespace bench
