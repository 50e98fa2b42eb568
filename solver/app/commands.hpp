#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// \file The commands. Each returns the exit code and throws where it refuses.

namespace extremal::app {

/// Exit codes, as documented for the command line.
enum Exit : int { done = 0, not_converged = 1, refused = 2 };

/// An option that cannot be used. what() names it, with the numbers.
struct OptionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The same with lines of help below.
struct UsageError : OptionError {
  std::string help;
  UsageError(const std::string& message, std::string help) : OptionError(message), help(std::move(help)) {}
};

struct SolveArguments {
  std::string scene;
  std::vector<std::string> sets;
  std::string output, csv, npz, oem, plot;  ///< paths, "-" for standard output; empty: not wanted
  int samples = 0;                          ///< 0: not wanted
  std::string at;                           ///< "T1,T2,…"
  int repeat = 1;
  bool quiet = false;
};
int solve(const SolveArguments& arguments);

struct SceneArguments {
  std::string scene;
  std::vector<std::string> sets;
  std::string output, plot;
  bool quiet = false;
};
int compare(const SceneArguments& arguments);

struct ContinueArguments {
  std::string scene;
  std::vector<std::string> sets;
  std::string output, csv, plot;
  std::string quantity;  ///< formula of what the plot shows; may be empty
  int samples = 0;       ///< of each orbit in the output; 0: none
  bool quiet = false;
};
int follow(const ContinueArguments& arguments);

int spectrum(const SceneArguments& arguments);

struct CheckArguments {
  std::string scene;
  std::vector<std::string> sets;
};
int check(const CheckArguments& arguments);

struct InitArguments {
  std::string system;
  std::string output;  ///< empty: the system's name with ".toml", in the working folder
};
/// Writes a commented scene of a system; a file that is there already is refused.
int init(const InitArguments& arguments);

struct ViewArguments {
  std::string result;
  std::string output;  ///< empty: the name of the result with ".html", beside it
};
/// Writes the page of a saved result and prints its name.
int view(const ViewArguments& arguments);

/// All systems, schemes and methods, or one system where it is named.
int list(const std::string& system);

}  // namespace extremal::app
