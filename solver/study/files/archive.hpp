#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// \file Files in one archive of the kind ZIP, in memory.

namespace extremal {

/// Names and contents, in this order, stored as they are: of each its head, then what is only looked at.
struct ArchiveMember {
  std::string name, head;
  std::string_view content;
};

/// The bytes of the archive. Throws std::runtime_error where they do not fit into memory.
std::string archive(const std::vector<ArchiveMember>& members);

/// Names and contents. Throws std::runtime_error with the reason where these bytes are no archive, or hold
/// more than `most` bytes.
std::map<std::string, std::string> extract(std::string_view bytes, std::size_t most);

}  // namespace extremal
