#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

/// \file Files that are written whole or not at all.

namespace extremal {

struct FileContent {
  std::string path;  ///< "-" is standard output
  std::string content = {};
  /// Writes what follows the content, piece by piece: it need not be in memory at once.
  std::function<void(std::ostream&)> write = {};
};

/// Writes all files or none. Each regular file is written beside its place, under a name of its own, and
/// renamed when all are complete: an interrupt or a full disk leaves the old ones. Links are followed, the
/// folders of the paths are made, and a file that is replaced passes its permissions on. Devices, pipes and
/// standard output are written just before. Throws std::runtime_error with the path and the system's reason.
void write_files(const std::vector<FileContent>& files);

/// Whether two paths lead to one regular file, also through links, or would if they were written.
bool same_file(const std::string& a, const std::string& b);

/// What `write` writes.
std::string text_of(const std::function<void(std::ostream&)>& write);

/// One file with what `write` writes, piece by piece.
void write_file(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace extremal
