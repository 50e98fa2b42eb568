#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "machine/folder.hpp"

/// \file The built program, run as a user runs it.

namespace extremal::test {

inline std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Outcome {
  int exit = -1;  ///< 128 + the number of a signal
  std::string out, error;
};

class Command : public InFolder {
 protected:
  /// Starts `extremal ARGUMENTS` in the folder, killed after 60 s of processor time.
  pid_t start(const std::vector<std::string>& arguments) {
    const std::string program = std::string(EXTREMAL_BINARY_DIR) + "/extremal";
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    const fs::path out = folder / "stdout", error = folder / "stderr";
    const pid_t child = ::fork();
    if (child == 0) {
      const rlimit processor{60, 60};
      ::setrlimit(RLIMIT_CPU, &processor);
      if (::chdir(folder.c_str()) != 0 || !::freopen(out.c_str(), "w", stdout) ||
          !::freopen(error.c_str(), "w", stderr))
        ::_exit(127);
      ::execv(program.c_str(), argv.data());
      ::_exit(127);
    }
    return child;
  }
  Outcome finish(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(folder / "stdout"),
            read_text(folder / "stderr")};
  }
  Outcome extremal(const std::vector<std::string>& arguments) { return finish(start(arguments)); }
  Outcome solve(const std::string& scene, std::vector<std::string> options = {}) {
    write("scene.toml", scene);
    options.insert(options.begin(), {"solve", "scene.toml"});
    return extremal(options);
  }
};

inline const std::string pendulum =
    "title = \"Pendulum\"\n"
    "[system]\n"
    "coordinates = [\"q\"]\n"
    "lagrangian = \"q'^2/2 + cos(q)\"\n"
    "[boundary]\n"
    "start = { q = 0.0 }\n"
    "end = { q = 1.5 }\n"
    "duration = 2.0\n";

}  // namespace extremal::test
