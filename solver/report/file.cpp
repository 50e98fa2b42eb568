#include "report/file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace extremal {

namespace {

[[noreturn]] void refuse(const std::string& path) {
  const int reason = errno;
  throw std::runtime_error(reason == 0 ? fmt::format("cannot write {}", path)
                                       : fmt::format("cannot write {}: {}", path, std::strerror(reason)));
}

/// Devices and pipes are left alone.
void remove_partial(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
}

}  // namespace

void write_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
  std::error_code ignored;  // where no folder can be made, opening fails and says why
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  if (!out) refuse(path);
  try {
    write(out);
    out.close();
    if (!out) refuse(path);
  } catch (...) {
    remove_partial(path);
    throw;
  }
}

}  // namespace extremal
