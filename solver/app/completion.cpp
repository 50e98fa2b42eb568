#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "app/pages.hpp"

namespace extremal::app {
namespace {

bool is_file(const OptionRecord& option) { return option.value.starts_with("FILE"); }

std::vector<std::string> names_of(const std::vector<OptionRecord>& options) {
  std::vector<std::string> names;
  for (const OptionRecord& option : options)
    if (!option.argument) names.push_back(option.name);
  return names;
}

std::string argument_of(const CommandRecord& command) {
  const auto found = std::find_if(command.options.begin(), command.options.end(),
                                  [](const OptionRecord& option) { return option.argument; });
  return found == command.options.end() ? "" : found->name;
}

std::vector<std::string> command_names(const ProgramRecord& program) {
  std::vector<std::string> names;
  for (const CommandRecord& command : program.commands) names.push_back(command.name);
  return names;
}

/// The options of all commands that take a file, or that take another value.
std::set<std::string> with_value(const ProgramRecord& program, bool file) {
  std::set<std::string> names;
  for (const CommandRecord& command : program.commands)
    for (const OptionRecord& option : command.options)
      if (!option.value.empty() && is_file(option) == file) names.insert(option.name);
  return names;
}

constexpr const char* bash_pattern = R"~(# Completion for bash, printed by: {0} completion bash
_{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}
  local commands='{1}' options='' argument=''
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$commands {2}" -- "$word")
    return
  fi
  case $before in
    {3})
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$word")
      return ;;
    {4}) return ;;
  esac
  case ${{COMP_WORDS[1]}} in
{5}  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    return
  fi
  case $argument in
    SCENE)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -X '!*.toml' -- "$word"; compgen -d -- "$word") ;;
    RESULT)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -X '!*.json' -- "$word"; compgen -d -- "$word") ;;
    SYSTEM) mapfile -t COMPREPLY < <(compgen -W "$("$1" completion systems)" -- "$word") ;;
    COMMAND) mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word") ;;
  esac
}}
complete -F _{0} {0}
)~";

constexpr const char* zsh_pattern = R"~(#compdef {0}
# Completion for zsh, printed by: {0} completion zsh
local -a commands=(
{1})
if ((CURRENT == 2)); then
  _describe -t commands command commands
  _arguments {2}
  return
fi
local program=$words[1] command=$words[2]
shift words
((CURRENT--))
case $command in
{3}esac
)~";

/// A text between single quotes of zsh, with a backslash before each character of `special`.
std::string zsh_text(const std::string& text, std::string_view special) {
  std::string escaped;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) escaped += '\\';
    escaped += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return escaped;
}

std::string zsh_values(const OptionRecord& option) {
  if (is_file(option)) return "_files";
  if (option.name == "SCENE") return "_files -g \"*.toml\"";
  if (option.name == "RESULT") return "_files -g \"*.json\"";
  if (option.name == "SYSTEM") return "($($program completion systems))";
  if (option.name == "COMMAND") return "(($commands))";
  return "";
}

std::string zsh_spec(const OptionRecord& option) {
  if (option.argument) return fmt::format("'1:{}:{}'", option.name, zsh_values(option));
  std::string spec =
      fmt::format("{}{}[{}]", option.repeatable ? "*" : "", option.name, zsh_text(option.help, "[]:\\"));
  if (!option.value.empty()) spec += fmt::format(":{}:{}", zsh_text(option.value, ":\\"), zsh_values(option));
  return fmt::format("'{}'", spec);
}

std::vector<std::string> zsh_specs(const std::vector<OptionRecord>& options) {
  std::vector<std::string> specs;
  for (const OptionRecord& option : options) specs.push_back(zsh_spec(option));
  return specs;
}

}  // namespace

std::string bash_completion(const ProgramRecord& program) {
  std::string cases;
  for (const CommandRecord& command : program.commands)
    cases += fmt::format("    {}) options='{}' argument='{}' ;;\n", command.name,
                         fmt::join(names_of(command.options), " "), argument_of(command));
  return fmt::format(bash_pattern, program.name, fmt::join(command_names(program), " "),
                     fmt::join(names_of(program.options), " "), fmt::join(with_value(program, true), " | "),
                     fmt::join(with_value(program, false), " | "), cases);
}

std::string zsh_completion(const ProgramRecord& program) {
  std::string commands, cases;
  for (const CommandRecord& command : program.commands) {
    commands += fmt::format("  '{}:{}'\n", command.name, zsh_text(command.help, ":\\"));
    cases += fmt::format("  {})\n    _arguments {} ;;\n", command.name,
                         fmt::join(zsh_specs(command.options), " \\\n      "));
  }
  return fmt::format(zsh_pattern, program.name, commands, fmt::join(zsh_specs(program.options), " "), cases);
}

}  // namespace extremal::app
