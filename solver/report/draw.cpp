#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "report/gnuplot.hpp"

namespace extremal {

namespace {

[[noreturn]] void refuse_missing_gnuplot() {
  throw std::runtime_error("gnuplot draws the plots and was not found: apt install gnuplot-nox");
}

/// A file in memory, without a name.
class MemoryFile {
 public:
  explicit MemoryFile(const char* label) : descriptor_(::memfd_create(label, MFD_CLOEXEC)) {
    if (descriptor_ < 0) refuse("make a file for gnuplot");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  void write(const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count = ::write(descriptor_, text.data() + done, text.size() - done);
      if (count < 0 && errno != EINTR) refuse("write gnuplot's commands");
      if (count > 0) done += static_cast<std::size_t>(count);
    }
    ::lseek(descriptor_, 0, SEEK_SET);
  }
  std::string content() const {
    std::string text(::lseek(descriptor_, 0, SEEK_END), '\0');
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count =
          ::pread(descriptor_, text.data() + done, text.size() - done, static_cast<off_t>(done));
      if (count == 0 || (count < 0 && errno != EINTR)) refuse("read what gnuplot has drawn");
      if (count > 0) done += static_cast<std::size_t>(count);
    }
    return text;
  }

 private:
  [[noreturn]] static void refuse(const char* what) {
    throw std::runtime_error(fmt::format("cannot {}: {}", what, std::strerror(errno)));
  }
  int descriptor_;
};

/// What the child does between fork and exec.
class FileActions {
 public:
  FileActions(const MemoryFile& in, const MemoryFile& out, const MemoryFile& log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, in.descriptor(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, out.descriptor(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, log.descriptor(), STDERR_FILENO);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

/// Runs `gnuplot -d` (default settings, no start-up files); whether it ended well.
bool run_gnuplot(const FileActions& actions) {
  std::string arguments[] = {"gnuplot", "-d"};
  char* argv[] = {arguments[0].data(), arguments[1].data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, "gnuplot", actions.get(), nullptr, argv, environ);
  if (error == ENOENT) refuse_missing_gnuplot();
  if (error != 0) throw std::runtime_error(fmt::format("cannot start gnuplot: {}", std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) {
      throw std::runtime_error(fmt::format("cannot wait for gnuplot: {}", std::strerror(errno)));
    }
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Replaces the time at which a PDF was made by a fixed one of the same length: output is deterministic.
void reset_date(std::string& pdf) {
  const std::string key = "/CreationDate (D:", date = "20000101000000";
  const std::size_t at = pdf.find(key);
  if (at != std::string::npos) pdf.replace(at + key.size(), date.size(), date);
}

}  // namespace

void require_gnuplot() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/bin:/usr/bin");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + "/gnuplot").c_str(), X_OK) == 0) return;
  refuse_missing_gnuplot();
}

std::string draw(const Figure& figure, Format format) {
  MemoryFile script("script"), drawing("drawing"), log("log");
  script.write(gnuplot_script(figure, format));
  const bool ended_well = run_gnuplot(FileActions(script, drawing, log));
  std::string image = drawing.content();
  if (!ended_well || image.empty())
    throw std::runtime_error("gnuplot failed: " + printable(log.content(), 400));
  if (format == Format::pdf) reset_date(image);
  return image;
}

}  // namespace extremal
