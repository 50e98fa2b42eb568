#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// \file Figures of programs that were measured elsewhere, read from the first table of bench/data/README.md.

namespace bench {

/// Errors that a cell of the table gives times for, in its order.
inline constexpr std::array<double, 3> peer_errors{1e-4, 1e-8, 1e-11};

using PeerTimes = std::array<std::optional<double>, peer_errors.size()>;  ///< seconds

struct Peers {
  std::vector<std::string> names;                       ///< one a column of the table
  std::map<std::string, std::vector<PeerTimes>> times;  ///< of a scene: one a column
};

/// Throws std::runtime_error, with file and line, where the table is not as expected.
Peers read_peers(const std::string& path);

/// Seconds of a peer (its column) on a scene at one of peer_errors; nothing where it failed or was not run.
std::optional<double> peer_time(const Peers& peers, const std::string& scene, std::size_t column,
                                double error);

}  // namespace bench
