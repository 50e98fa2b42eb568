#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "report/file.hpp"
#include "report/gnuplot.hpp"
#include "report/temporary_folder.hpp"

namespace extremal {

namespace {

[[noreturn]] void refuse_missing_gnuplot() {
  throw std::runtime_error("gnuplot draws the plots and was not found: apt install gnuplot-nox");
}

std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// What the child does between fork and exec.
class FileActions {
 public:
  FileActions(const std::string& folder, const char* log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log, O_WRONLY | O_CREAT | O_APPEND, 0600);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

/// Runs `gnuplot -d SCRIPT` (-d: default settings, no start-up files) in the folder; whether it ended well.
bool run_gnuplot(const std::string& folder, const char* script, const char* log) {
  std::string arguments[] = {"gnuplot", "-d", script};
  char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), nullptr};
  const FileActions actions(folder, log);
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
  const TemporaryFolder folder;
  write_file(folder / "script", [&](std::ostream& out) { out << gnuplot_script(figure, format, "figure"); });
  const bool ended_well = run_gnuplot(folder.path(), "script", "log");
  std::string image = content(folder / "figure");
  if (!ended_well || image.empty()) {
    throw std::runtime_error("gnuplot failed: " + printable(content(folder / "log"), 400));
  }
  if (format == Format::pdf) reset_date(image);
  return image;
}

}  // namespace extremal
