#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>

#include "app/commands.hpp"

namespace {

using namespace extremal::app;

void add_quiet(CLI::App& command, bool& quiet) {
  command.add_flag("--quiet", quiet, "write nothing but errors");
}

/// Every --set takes one value, so that the scene may follow it.
void add_scene(CLI::App& command, std::string& scene, std::vector<std::string>& sets) {
  command.add_option("scene", scene, "the scene, a TOML file")->required()->type_name("SCENE");
  command.add_option("--set", sets, "change a key of the scene; may be repeated")
      ->type_name("key=value")
      ->allow_extra_args(false);
}

void add_solve(CLI::App& app, SolveArguments& a, std::function<int()>& chosen) {
  CLI::App& command = *app.add_subcommand("solve", "solve a scene");
  add_scene(command, a.scene, a.sets);
  command.add_option("--output", a.output, "write the result as JSON")->type_name("R.json");
  command.add_option("--csv", a.csv, "write samples as CSV (201 unless --samples or --at)")
      ->type_name("R.csv");
  command.add_option("--plot", a.plot, "draw the trajectory")->type_name("P.svg|P.png");
  command.add_option("--samples", a.samples, "so many equally spaced samples, both ends included")
      ->type_name("N");
  command.add_option("--at", a.at, "samples at these times")->type_name("T1,T2,…");
  command.add_option("--repeat", a.repeat, "solve so many times and report the median time")->type_name("N");
  add_quiet(command, a.quiet);
  command.callback([&a, &chosen, &command] {
    if (command.count("--samples") && a.samples < 2)
      throw OptionError(fmt::format("--samples {}: need at least 2", a.samples));
    chosen = [&a] { return solve(a); };
  });
}

void add_compare(CLI::App& app, CompareArguments& a, std::function<int()>& chosen) {
  CLI::App& command = *app.add_subcommand("compare", "speed against error on a scene, beside shooting");
  add_scene(command, a.scene, a.sets);
  command.add_option("--output", a.output, "write the comparison as JSON")->type_name("C.json");
  command.add_option("--plot", a.plot, "draw time against error")->type_name("P.svg|P.png");
  add_quiet(command, a.quiet);
  command.callback([&a, &chosen] { chosen = [&a] { return compare(a); }; });
}

void add_continue(CLI::App& app, ContinueArguments& a, std::function<int()>& chosen) {
  CLI::App& command = *app.add_subcommand("continue", "follow the family of extremals that a scene asks for");
  add_scene(command, a.scene, a.sets);
  command.add_option("--output", a.output, "write the branch as JSON")->type_name("B.json");
  command.add_option("--csv", a.csv, "write its points as CSV")->type_name("B.csv");
  command.add_option("--plot", a.plot, "draw the branch")->type_name("P.svg|P.png");
  add_quiet(command, a.quiet);
  command.callback([&a, &chosen] { chosen = [&a] { return follow(a); }; });
}

int run(int argc, char** argv) {
  CLI::App app("Trajectories of Lagrangian systems as stationary points of the discrete action", "extremal");
  app.require_subcommand(1);
  std::function<int()> chosen;
  SolveArguments solve_arguments;
  add_solve(app, solve_arguments, chosen);
  ContinueArguments continue_arguments;
  add_continue(app, continue_arguments, chosen);
  CompareArguments compare_arguments;
  add_compare(app, compare_arguments, chosen);

  CheckArguments check_arguments;
  CLI::App& checking =
      *app.add_subcommand("check", "read a scene, check its derivatives, say what was found");
  add_scene(checking, check_arguments.scene, check_arguments.sets);
  checking.callback([&] { chosen = [&] { return check(check_arguments); }; });

  app.add_subcommand("list", "systems, schemes and methods")->callback([&] { chosen = list; });
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help
    return app.exit(asked);
  } catch (const CLI::ParseError& e) {
    throw OptionError(fmt::format("{} (see extremal --help)", e.what()));
  }
  return chosen();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw OptionError("standard output cannot be written");
    return code;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: there is not enough memory\n");
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
  }
  return Exit::refused;
}
