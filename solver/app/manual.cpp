#include <fmt/format.h>

#include "app/pages.hpp"

namespace extremal::app {
namespace {

/// A text in which roff finds no command of its own.
std::string roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
  }
  const bool control = !escaped.empty() && (escaped.front() == '.' || escaped.front() == '\'');
  return (control ? "\\&" : "") + escaped;
}

std::string sentence(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') text.front() += 'A' - 'a';
  return roff(text + ".");
}

std::string bold(const std::string& text) { return fmt::format("\\fB{}\\fR", roff(text)); }
std::string italic(const std::string& text) {
  return text.empty() ? "" : fmt::format("\\fI{}\\fR", roff(text));
}

std::string entry(const std::string& term, const std::string& help) {
  return fmt::format(".TP\n{}\n{}\n", term, sentence(help));
}

std::string options_text(const std::vector<OptionRecord>& options) {
  std::string text;
  for (const OptionRecord& option : options) {
    const std::string preset = option.preset.empty() ? "" : fmt::format(" (default {})", option.preset);
    const std::string term =
        option.argument ? italic(option.name) : bold(option.name) + " " + italic(option.value);
    text += entry(term, option.help + preset);
  }
  return text;
}

std::string command_text(const ProgramRecord& program, CommandRecord command) {
  std::erase_if(command.options, [](const OptionRecord& option) { return option.name == "--help"; });
  std::string usage = program.name + " " + command.name;
  for (const OptionRecord& option : command.options)
    if (option.argument) usage += option.required ? " " + option.name : " [" + option.name + "]";
  return fmt::format(".SS {} [options]\n{}\n{}.PP\nExample:\n.PP\n.EX\n    {} {}\n.EE\n", roff(usage),
                     sentence(command.help), options_text(command.options), program.name,
                     roff(command.example));
}

}  // namespace

std::string manual_page(const ProgramRecord& program) {
  std::string text =
      fmt::format(".TH EXTREMAL 1 \"\" \"{} {}\" \"User Commands\"\n", program.name, program.version);
  text += fmt::format(".SH NAME\n{} \\- {}\n", program.name, roff(program.help));
  text += fmt::format(".SH SYNOPSIS\n.B {}\n.I COMMAND\n[options]\n", program.name);
  text += fmt::format(
      ".SH DESCRIPTION\n{}\nA scene is a TOML file with a Lagrangian and the conditions at the ends.\n"
      "Results go to standard output and to the files that options name.\n"
      "Progress goes to standard error, only to a terminal.\n",
      sentence(program.help));
  text += options_text(program.options) + ".SH COMMANDS\n";
  for (const CommandRecord& command : program.commands) text += command_text(program, command);
  text += ".SH EXIT STATUS\n";
  for (const NamedHelp& code : program.exit_codes) text += entry(bold(code.name), code.help);
  text += ".SH ENVIRONMENT\n";
  for (const NamedHelp& variable : program.environment) text += entry(bold(variable.name), variable.help);
  text += fmt::format(".SH SEE ALSO\nThe keys of a scene and the fields of a result: {}\n",
                      roff(program.reference));
  return text;
}

}  // namespace extremal::app
