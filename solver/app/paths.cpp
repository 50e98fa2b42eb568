#include "app/paths.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "app/commands.hpp"

namespace extremal::app {
namespace fs = std::filesystem;

void check_writable(const char* option, const std::string& path) {
  if (path.empty()) return;
  const auto refuse = [&](const std::string& why) {
    throw OptionError(fmt::format("{} {}: {}", option, path, why));
  };
  std::error_code error;
  if (fs::is_directory(path, error)) refuse("is a directory");
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  const bool exists = fs::exists(path, error);
  if (!exists && !fs::is_directory(folder, error)) refuse("there is no such folder");
  if (::access(exists ? path.c_str() : folder.c_str(), W_OK) != 0) refuse(std::strerror(errno));
}

}  // namespace extremal::app
