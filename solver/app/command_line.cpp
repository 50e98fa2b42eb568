#include "app/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/pages.hpp"
#include "app/terminal.hpp"
#include "report/text.hpp"
#include "study/inspection.hpp"
#include "study/suggestion.hpp"

namespace extremal::app {
namespace {

constexpr const char* example_before = "Example: extremal ";
constexpr int most_samples = 10'000'000, most_repeats = 1'000'000;

/// The commands and options, and what the command line sets.
class CommandLine {
 public:
  CommandLine();
  int run(int argc, char** argv);

 private:
  using Action = std::function<int()>;

  CLI::App& add(const char* name, const char* help, const std::string& example, Action action);
  void add_solve();
  void add_continue();
  void add_compare();
  void add_spectrum();
  void add_check();
  void add_list();
  void add_init();
  void add_view();
  void add_help();
  void add_pages();

  [[noreturn]] void refuse_first_word(int argc, char** argv) const;
  std::string complaint(const CLI::ParseError& error) const;
  std::string owner(const std::string& option, const std::string& suggested) const;
  const CLI::App* find(const std::string& name) const;  ///< null where there is no such command
  std::vector<std::string> names() const;
  ProgramRecord record() const;

  CLI::App app_{"Trajectories of Lagrangian systems as stationary points of the discrete action", "extremal"};
  Action chosen_;
  SolveArguments solve_;
  ContinueArguments continue_;
  SceneArguments compare_;
  SceneArguments spectrum_;
  CheckArguments check_;
  InitArguments init_;
  ViewArguments view_;
  std::string system_, command_, shell_;
};

/// Every --set takes one value, so that the scene may follow it.
void add_scene(CLI::App& command, std::string& scene, std::vector<std::string>& sets) {
  command.add_option("SCENE", scene, "the scene, a TOML file")->required()->type_name("");
  command.add_option("--set", sets, "change a key of the scene, as in solve.tolerance=1e-6; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void add_output(CLI::App& command, std::string& path, const char* help) {
  command.add_option("--output", path, help)->type_name("FILE.json")->check(output_refusal);
}

void add_csv(CLI::App& command, std::string& path, const char* help) {
  command.add_option("--csv", path, help)->type_name("FILE.csv")->check(output_refusal);
}

void add_plot(CLI::App& command, std::string& path, const char* help) {
  command.add_option("--plot", path, help)->type_name("FILE.svg|.png|.pdf|.html")->check(plot_refusal);
}

void add_quiet(CLI::App& command, bool& quiet) {
  command.add_flag("--quiet", quiet, "print nothing but errors");
}

/// Its message names the range; the help does not.
CLI::Validator whole_number(int low, int high) { return CLI::Range(low, high).description(""); }

/// A word as a shell reads it.
std::string shell_word(const std::string& word) {
  if (word.find_first_of(" \t\n'\"\\$`&|;<>()*?[]#~!{}") == std::string::npos && !word.empty()) return word;
  std::string inner;
  for (const char c : word) inner += c == '\'' ? "'\\''" : std::string(1, c);
  return fmt::format("'{}'", inner);
}

CommandLine::CommandLine() {
  app_.require_subcommand(1);
  app_.set_help_flag("-h,--help", "print this help");
  app_.set_version_flag("--version", "extremal " EXTREMAL_VERSION, "print the version");
  app_.get_formatter()->label("Positionals", "Arguments");
  app_.get_formatter()->label("OPTIONS", "options");
  app_.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app_.get_formatter()->label("REQUIRED", "(required)");
  app_.get_formatter()->column_width(36);
  add_solve();
  add_continue();
  add_compare();
  add_spectrum();
  add_check();
  add_list();
  add_init();
  add_view();
  add_help();
  add_pages();
  app_.footer(fmt::format("{}solve {}\nHelp of a command: extremal help solve", example_before,
                          shell_word(example_scene())));
}

CLI::App& CommandLine::add(const char* name, const char* help, const std::string& example, Action action) {
  CLI::App& command = *app_.add_subcommand(name, help)->group("Commands");
  command.callback([this, action = std::move(action)] { chosen_ = action; });
  command.footer(example_before + example);
  return command;
}

void CommandLine::add_solve() {
  SolveArguments& a = solve_;
  CLI::App& command =
      add("solve", "find the extremal of a scene, or several with [search]",
          "solve kepler.toml --output kepler.json --plot kepler.svg", [&a] { return app::solve(a); });
  add_scene(command, a.scene, a.sets);
  add_output(command, a.output, "write the result; - is standard output");
  add_csv(command, a.csv, "write samples (201 without --samples and --at); - is standard output");
  command.add_option("--npz", a.npz, "write samples as arrays of NumPy; - is standard output")
      ->type_name("FILE.npz")
      ->check(output_refusal);
  command.add_option("--oem", a.oem, "write an ephemeris of CCSDS, in [units]; - is standard output")
      ->type_name("FILE.oem")
      ->check(output_refusal);
  add_plot(command, a.plot, "draw the trajectory");
  CLI::Option* samples =
      command.add_option("--samples", a.samples, "N equally spaced samples, both ends included")
          ->type_name("N")
          ->option_text("N")
          ->check(whole_number(2, most_samples));
  command.add_option("--at", a.at, "samples at these times, not together with --samples")
      ->type_name("T1,T2,...")
      ->option_text("T1,T2,...")
      ->excludes(samples);
  command.add_option("--repeat", a.repeat, "solve N times and report the median time")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(1, most_repeats));
  add_quiet(command, a.quiet);
}

void CommandLine::add_continue() {
  ContinueArguments& a = continue_;
  CLI::App& command =
      add("continue", "continue a family of extremals, as [continuation] asks",
          "continue halo-family.toml --output halo.json --plot halo.svg", [&a] { return follow(a); });
  add_scene(command, a.scene, a.sets);
  add_output(command, a.output, "write the branches; - is standard output");
  add_csv(command, a.csv, "write the points of the branches; - is standard output");
  add_plot(command, a.plot, "draw the branches");
  command
      .add_option(
          "--quantity", a.quantity,
          "what the plot shows: a formula of x(0), x'(T), parameters, duration, energy, action, amplitude")
      ->type_name("FORMULA")
      ->option_text("FORMULA");
  command
      .add_option("--samples", a.samples,
                  "N equally spaced samples of each orbit in --output, which `view` draws")
      ->type_name("N")
      ->option_text("N")
      ->check(whole_number(2, most_samples));
  add_quiet(command, a.quiet);
}

void CommandLine::add_compare() {
  SceneArguments& a = compare_;
  CLI::App& command =
      add("compare", "measure time against error on a scene, beside shooting",
          "compare double-pendulum.toml --plot compare.svg", [&a] { return app::compare(a); });
  add_scene(command, a.scene, a.sets);
  add_output(command, a.output, "write the comparison; - is standard output");
  add_plot(command, a.plot, "draw time against error");
  add_quiet(command, a.quiet);
}

void CommandLine::add_spectrum() {
  SceneArguments& a = spectrum_;
  CLI::App& command =
      add("spectrum", "solve a scene, then find frequencies and amplitudes of each coordinate",
          "spectrum henon-heiles.toml --plot spectrum.svg", [&a] { return app::spectrum(a); });
  add_scene(command, a.scene, a.sets);
  add_output(command, a.output, "write the result with its spectrum; - is standard output");
  add_plot(command, a.plot, "draw the lines");
  add_quiet(command, a.quiet);
}

void CommandLine::add_check() {
  CheckArguments& a = check_;
  CLI::App& command = add("check", "read a scene, check its derivatives and print its structure",
                          "check kepler.toml", [&a] { return app::check(a); });
  add_scene(command, a.scene, a.sets);
}

void CommandLine::add_list() {
  CLI::App& command = add("list", "list systems, schemes and methods, or describe one system", "list kepler",
                          [this] { return list(system_); });
  command.add_option("SYSTEM", system_, "a name of the list: its coordinates, parameters, units and scenes")
      ->type_name("");
}

void CommandLine::add_init() {
  InitArguments& a = init_;
  CLI::App& command = add("init", "write a commented scene of a system, to begin with", "init kepler",
                          [&a] { return init(a); });
  command.add_option("SYSTEM", a.system, "a name of `extremal list`")->required()->type_name("");
  command.add_option("--output", a.output, "the file, SYSTEM.toml without it; - is standard output")
      ->type_name("FILE.toml")
      ->check(output_refusal);
}

void CommandLine::add_view() {
  ViewArguments& a = view_;
  CLI::App& command = add("view", "write an interactive page of a saved result, and print its name",
                          "view kepler.json", [&a] { return view(a); });
  command.add_option("RESULT", a.result, "a file that --output has written, with --samples for its motion")
      ->required()
      ->type_name("");
  command.add_option("--output", a.output, "the page, RESULT.html without it; - is standard output")
      ->type_name("FILE.html")
      ->check(output_refusal);
}

void CommandLine::add_help() {
  CLI::App& command = add("help", "print the help of a command", "help solve", [this] {
    const CLI::App* page = command_.empty() ? &app_ : find(command_);
    if (!page)
      throw OptionError(fmt::format("there is no command '{}'{}", command_, suggestion(command_, names())));
    const std::string usage = page == &app_ ? app_.get_name() : app_.get_name() + " " + command_;
    print(app_.get_formatter()->make_help(page, usage, CLI::AppFormatMode::Normal));
    return Exit::done;
  });
  command.add_option("COMMAND", command_, "one of the commands")->type_name("");
}

/// What an installation holds beside the program; left out of the help.
void CommandLine::add_pages() {
  CLI::App& man = add("man", "print the manual page", "man > extremal.1", [this] {
    print(manual_page(record()));
    return Exit::done;
  });
  man.group("");
  CLI::App& completion = add("completion", "print the completion of a shell", "completion bash", [this] {
    if (shell_ == "systems")
      for (const CatalogueEntry& system : catalogue().systems) print(visible(system.name, false) + "\n");
    else
      print(shell_ == "zsh" ? zsh_completion(record()) : bash_completion(record()));
    return Exit::done;
  });
  completion.group("");
  completion.add_option("SHELL", shell_, "bash or zsh, or systems for their names")
      ->required()
      ->type_name("")
      ->check(CLI::IsMember({"bash", "zsh", "systems"}));
}

OptionRecord record_of(const CLI::Option& option) {
  const bool argument = option.get_positional();
  return {argument ? option.get_name(true) : fmt::format("--{}", option.get_lnames().front()),
          option.get_type_size() == 0 ? "" : option.get_type_name(),
          option.get_description(),
          option.get_default_str(),
          argument,
          option.get_required(),
          option.get_items_expected_max() > 1};
}

std::vector<OptionRecord> options_of(const CLI::App& app) {
  std::vector<OptionRecord> records;
  for (const CLI::Option* option : app.get_options()) records.push_back(record_of(*option));
  return records;
}

ProgramRecord CommandLine::record() const {
  ProgramRecord program;
  program.name = app_.get_name();
  program.version = EXTREMAL_VERSION;
  program.help = app_.get_description();
  program.options = options_of(app_);
  for (const std::string& name : names()) {
    const CLI::App& command = *find(name);
    program.commands.push_back({name, command.get_description(),
                                command.get_footer().substr(std::string(example_before).size()),
                                options_of(command)});
  }
  program.exit_codes = {
      {"0", "converged: the result meets the tolerance"},
      {"1", "not converged: the message says where, why and what to try"},
      {"2", "the scene or the command line was refused, or an output cannot be written; there is no result"}};
  program.environment = {
      {"EXTREMAL_PROBLEMS", "folders with system files and scenes, separated by colons"},
      {"EXTREMAL_THREADS", "number of threads, 1 to 1024; one without it"},
      {"EXTREMAL_SIMD",
       "instruction set of the kernels, below the best of the processor; base is the lowest"}};
  program.reference = EXTREMAL_REFERENCE;
  return program;
}

const CLI::App* CommandLine::find(const std::string& name) const {
  const std::vector<const CLI::App*> commands = app_.get_subcommands({});
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const CLI::App* command) { return command->get_name() == name; });
  return found == commands.end() ? nullptr : *found;
}

std::vector<std::string> CommandLine::names() const {
  std::vector<std::string> names;
  for (const CLI::App* command : app_.get_subcommands({}))
    if (!command->get_group().empty()) names.push_back(command->get_name());
  return names;
}

/// The first word is no command: it is misspelt, or a scene whose command is missing.
void CommandLine::refuse_first_word(int argc, char** argv) const {
  const std::string word = argv[1];
  std::error_code error;
  if (!word.ends_with(".toml") && !std::filesystem::is_regular_file(word, error))
    throw OptionError(
        fmt::format("there is no command '{}'{} (see extremal help)", word, suggestion(word, names())));
  std::string meant = "extremal solve";
  for (int k = 1; k < argc; ++k) meant += fmt::format(" {}", shell_word(argv[k]));
  throw OptionError(fmt::format("'{}' is not a command; write: {}", word, meant));
}

/// The command that has an option, else what is suggested.
std::string CommandLine::owner(const std::string& option, const std::string& suggested) const {
  for (const CLI::App* command : app_.get_subcommands(nullptr))
    if (command->get_option_no_throw(option)) return fmt::format("; '{}' has it", command->get_name());
  return suggested;
}

/// What is wrong with the arguments: a word that nothing takes is named before what is missing.
std::string CommandLine::complaint(const CLI::ParseError& error) const {
  const std::vector<CLI::App*> given = app_.get_subcommands();
  const CLI::App& command = given.empty() ? app_ : *given.front();
  const std::vector<std::string> extras = app_.remaining(true);
  for (const std::string& word : extras) {
    if (word.size() < 2 || word.front() != '-') continue;
    std::vector<std::string> known;
    for (const OptionRecord& option : options_of(command)) known.push_back(option.name);
    const std::string name = word.substr(0, word.find('='));
    return fmt::format("there is no option '{}'{}", name, owner(name, suggestion(name, known)));
  }
  const std::string text = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error))
    return fmt::format("'{}' is one argument too many", extras.front());
  if (!dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return text;
  const std::string name = text.substr(0, text.find(':'));
  const CLI::Option* option = command.get_option_no_throw(name);
  return option ? fmt::format("{} needs a value: {} {}", name, name, option->get_type_name()) : text;
}

int CommandLine::run(int argc, char** argv) {
  if (argc < 2)
    throw UsageError("no command", fmt::format("Usage: extremal COMMAND [options], COMMAND is one of {}\n{}",
                                               fmt::join(names(), ", "), app_.get_footer()));
  if (argv[1][0] != '-' && !find(argv[1])) refuse_first_word(argc, argv);
  try {
    app_.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    return app_.exit(asked);
  } catch (const CLI::ParseError& e) {
    const std::vector<CLI::App*> given = app_.get_subcommands();
    const std::string page = given.empty() ? "help" : fmt::format("help {}", given.front()->get_name());
    throw OptionError(fmt::format("{} (see extremal {})", complaint(e), page));
  }
  return chosen_();
}

}  // namespace

int run(int argc, char** argv) { return CommandLine().run(argc, argv); }

}  // namespace extremal::app
