#pragma once

#include <string>
#include <vector>

/// \file The command line as data, taken from its parser. Shell completion and the manual are made from it.

namespace extremal::app {

/// An option "--output" or an argument "SCENE" of a command.
struct OptionRecord {
  std::string name;
  std::string value;  ///< "FILE.json"; empty for a flag and for an argument
  std::string help;
  std::string preset;  ///< the value without the option; may be empty
  bool argument = false;
  bool required = false;
  bool repeatable = false;
};

struct CommandRecord {
  std::string name, help;
  std::string example;  ///< the arguments of one that works
  std::vector<OptionRecord> options;
};

/// A code that the program ends with, or a variable of the environment that it reads.
struct NamedHelp {
  std::string name, help;
};

struct ProgramRecord {
  std::string name, version, help;
  std::vector<OptionRecord> options;
  std::vector<CommandRecord> commands;
  std::vector<NamedHelp> exit_codes, environment;
  std::string reference;  ///< path of the page on scenes and results
};

}  // namespace extremal::app
