#include <nlohmann/json.hpp>

#include "command.hpp"

using namespace extremal::test;
using Json = nlohmann::json;

namespace {

/// Arguments and what standard error begins with.
struct Refusal {
  std::vector<std::string> arguments;
  std::string error;
};

class CommandLine : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("scene.toml", pendulum);
  }
  void expect(const Refusal& refusal) {
    const Outcome o = extremal(refusal.arguments);
    EXPECT_EQ(o.exit, 2) << refusal.error;
    EXPECT_EQ(o.out, "");
    EXPECT_EQ(o.error, "error: " + refusal.error + "\n");
  }
};

}  // namespace

TEST_F(CommandLine, WithoutACommandAnExampleThatWorks) {
  const Outcome o = extremal({});
  EXPECT_EQ(o.exit, 2);
  EXPECT_EQ(o.out, "");
  const std::string before = "Example: extremal solve ";
  const std::size_t begin = o.error.find(before) + before.size();
  ASSERT_NE(o.error.find(before), std::string::npos) << o.error;
  const std::string scene = o.error.substr(begin, o.error.find('\n', begin) - begin);
  EXPECT_EQ(extremal({"solve", scene, "--quiet"}).exit, 0) << scene;
}

TEST_F(CommandLine, ASceneWithoutACommand) {
  expect({{"scene.toml"}, "'scene.toml' is not a command; write: extremal solve scene.toml"});
  expect({{"scene.toml", "--plot", "a b.svg"},
          "'scene.toml' is not a command; write: extremal solve scene.toml --plot 'a b.svg'"});
  write("it's", pendulum);
  expect({{"it's"}, "'it's' is not a command; write: extremal solve 'it'\\''s'"});
}

TEST_F(CommandLine, MisspeltCommandsAndOptions) {
  expect({{"slove", "scene.toml"}, "there is no command 'slove'; did you mean 'solve'? (see extremal help)"});
  expect({{"xyzzy"}, "there is no command 'xyzzy' (see extremal help)"});
  expect({{"help", "chekc"}, "there is no command 'chekc'; did you mean 'check'?"});
  expect({{"solve", "scene.toml", "--outptu", "r.json"},
          "there is no option '--outptu'; did you mean '--output'? (see extremal help solve)"});
  expect({{"solve", "scene.toml", "--outptu=r.json"},
          "there is no option '--outptu'; did you mean '--output'? (see extremal help solve)"});
  expect({{"solve", "--quite"},
          "there is no option '--quite'; did you mean '--quiet'? (see extremal help solve)"});
  expect({{"solve", "scene.toml", "--quantity", "x(0)"},
          "there is no option '--quantity'; 'continue' has it (see extremal help solve)"});
  expect({{"--versoin"}, "there is no option '--versoin'; did you mean '--version'? (see extremal help)"});
}

TEST_F(CommandLine, ArgumentsThatAreMissingOrTooMany) {
  expect({{"solve"}, "SCENE is required (see extremal help solve)"});
  expect({{"solve", "scene.toml", "b.toml"}, "'b.toml' is one argument too many (see extremal help solve)"});
  expect(
      {{"solve", "scene.toml", "--set"}, "--set needs a value: --set KEY=VALUE (see extremal help solve)"});
  expect({{"solve", "scene.toml", "--samples"},
          "--samples needs a value: --samples N (see extremal help solve)"});
}

TEST_F(CommandLine, ValuesOutOfRange) {
  const auto range = [](const std::string& option, const std::string& value, const std::string& limits) {
    return fmt::format("--{}: Value {} not in range {} (see extremal help solve)", option, value, limits);
  };
  for (const char* value : {"1", "-3", "many", "2.5", "100000000"})
    expect({{"solve", "scene.toml", "--samples", value}, range("samples", value, "2 to 10000000")});
  for (const char* value : {"0", "1000001"})
    expect({{"solve", "scene.toml", "--repeat", value}, range("repeat", value, "1 to 1000000")});
  expect({{"solve", "scene.toml", "--samples", "3", "--at", "1"},
          "--samples excludes --at (see extremal help solve)"});
}

TEST_F(CommandLine, MissingFilesNameTheNearest) {
  expect({{"solve", "scnee.toml"}, "scnee.toml: no such file; did you mean 'scene.toml'?"});
  expect({{"solve", "scene"}, "scene: no such file; did you mean 'scene.toml'?"});
  fs::create_directory(folder / "sub");
  write("sub/other.toml", pendulum);
  expect({{"check", "sub/othre.toml"}, "sub/othre.toml: no such file; did you mean 'sub/other.toml'?"});
  expect({{"solve", "nowhere/mine.toml"}, "nowhere/mine.toml: no such file; there is no folder 'nowhere'"});
  expect({{"solve", "scene.toml", "--set", "guess.file=scnee.toml"},
          "--set guess.file: no such file: 'scnee.toml'; did you mean 'scene.toml'?"});
}

TEST_F(CommandLine, AMissingSceneOfTheLibraryIsNamed) {
  const Outcome o = extremal({"solve", "kepler.toml"});
  EXPECT_EQ(o.exit, 2);
  const std::string before = "error: kepler.toml: no such file; did you mean '";
  ASSERT_EQ(o.error.rfind(before, 0), 0u) << o.error;
  const std::string meant = o.error.substr(before.size(), o.error.find('\'', before.size()) - before.size());
  EXPECT_EQ(extremal({"solve", meant, "--quiet"}).exit, 0) << meant;
}

TEST_F(CommandLine, MisspeltKeysOfSet) {
  expect({{"solve", "scene.toml", "--set", "solve.tolerence=1e-6"},
          "--set solve.tolerence: unknown key 'tolerence' in [solve]; did you mean 'tolerance'?"});
  expect({{"solve", "scene.toml", "--set", "tolerance=1e-6"},
          "--set tolerance: unknown key 'tolerance'; did you mean 'solve.tolerance'?"});
  EXPECT_EQ(extremal({"solve", "scene.toml", "--set", "solve.tolerance=1e-6", "--quiet"}).exit, 0);
}

TEST_F(CommandLine, VersionAndHelp) {
  const Outcome version = extremal({"--version"});
  EXPECT_EQ(version.exit, 0);
  EXPECT_EQ(version.out, "extremal " EXTREMAL_VERSION "\n");
  const Outcome help = extremal({"help"});
  EXPECT_EQ(help.exit, 0);
  EXPECT_EQ(help.out, extremal({"--help"}).out);
  for (const char* command : {"solve", "continue", "compare", "check", "list", "view", "help"}) {
    EXPECT_NE(help.out.find(fmt::format("\n  {} ", command)), std::string::npos) << command;
    const Outcome page = extremal({"help", command});
    EXPECT_EQ(page.exit, 0);
    EXPECT_EQ(page.out, extremal({command, "--help"}).out);
    EXPECT_NE(page.out.find(fmt::format("Usage: extremal {} ", command)), std::string::npos) << page.out;
    EXPECT_NE(page.out.find(fmt::format("Example: extremal {} ", command)), std::string::npos) << page.out;
  }
  for (const char* hidden : {"completion", "man"})
    EXPECT_EQ(help.out.find(fmt::format("\n  {} ", hidden)), std::string::npos);
}

TEST_F(CommandLine, HelpNamesOptionsTypesAndDefaults) {
  const std::string help = extremal({"solve", "--help"}).out;
  for (const char* option :
       {"--output FILE.json ", "--csv FILE.csv ", "--plot FILE.svg|.png|.pdf|.html ", "--samples N ",
        "--at T1,T2,... ", "--set KEY=VALUE ", "--repeat N=1 ", "--quiet ", "SCENE (required) "})
    EXPECT_NE(help.find(option), std::string::npos) << option << "\n" << help;
}

TEST_F(CommandLine, StandardOutputHoldsTheResultAlone) {
  const Outcome json = extremal({"solve", "scene.toml", "--output", "-", "--samples", "3"});
  EXPECT_EQ(json.exit, 0) << json.error;
  EXPECT_EQ(Json::parse(json.out)["samples"]["t"], (std::vector<double>{0, 1, 2}));
  const Outcome csv = extremal({"solve", "scene.toml", "--csv", "-", "--samples", "3"});
  EXPECT_EQ(csv.exit, 0) << csv.error;
  EXPECT_EQ(csv.out.rfind("t,q,q',p_q\n0,0,", 0), 0u) << csv.out;
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 4);
  EXPECT_FALSE(fs::exists(folder / "-"));
  const Outcome comparison = extremal({"compare", "scene.toml", "--output", "-", "--quiet"});
  EXPECT_FALSE(Json::parse(comparison.out)["rows"].empty());
  expect({{"solve", "scene.toml", "--output", "-", "--csv", "-"},
          "--output - and --csv - exclude each other: there is one standard output"});
}

TEST_F(CommandLine, AFamilyOnStandardOutput) {
  write("family.toml", pendulum + "[continuation]\nparameter = \"duration\"\nto = 2.5\npoints = 3\n");
  const Outcome json = extremal({"continue", "family.toml", "--output", "-"});
  EXPECT_EQ(Json::parse(json.out)["status"], "converged");
  const Outcome csv = extremal({"continue", "family.toml", "--csv", "-"});
  EXPECT_EQ(csv.out.rfind("branch,parameter,", 0), 0u) << csv.out;
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 4);
}

TEST_F(CommandLine, AFailureOnStandardOutputIsJsonToo) {
  write("none.toml",
        "[system]\ncoordinates = [\"q\"]\nlagrangian = \"(q'^2 - q^2)/2\"\n"
        "[boundary]\nstart = { q = 0.0 }\nend = { q = 1.0 }\nduration = \"pi\"\n");
  const Outcome o = extremal({"solve", "none.toml", "--output", "-"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_EQ(Json::parse(o.out)["status"], "conjugate-ends");
}

TEST_F(CommandLine, FoldersOfOutputsAreMade) {
  const Outcome o = extremal(
      {"solve", "scene.toml", "--output", "new/folder/r.json", "--csv", "c/r.csv", "--plot", "p/q/r.svg"});
  ASSERT_EQ(o.exit, 0) << o.error;
  for (const char* file : {"new/folder/r.json", "c/r.csv", "p/q/r.svg"})
    EXPECT_TRUE(fs::exists(folder / file)) << file;
}

TEST_F(CommandLine, OutputsThatCannotBeWrittenAreRefusedBeforeSolving) {
  fs::create_directory(folder / "sub");
  const auto refused = [&](const char* option, const char* path, const std::string& why) {
    expect({{"solve", "scene.toml", "--output", "r.json", option, path},
            fmt::format("{}: {} (see extremal help solve)", option, why)});
    EXPECT_FALSE(fs::exists(folder / "r.json"));
  };
  refused("--csv", "sub", "'sub' is a folder; a file is needed");
  refused("--csv", "new/", "'new/' names a folder; a file is needed");
  refused("--csv", "scene.toml/r.csv", "'scene.toml' is not a folder");
  refused("--csv", "", "the name of the file is empty");
  refused("--plot", "scene.toml/p.svg", "'scene.toml' is not a folder");
  refused("--plot", "p.gif", "cannot plot into p.gif: the name must end in .svg, .png, .pdf or .html");
  refused("--plot", "-", "cannot plot into -: the name must end in .svg, .png, .pdf or .html");
  EXPECT_EQ(extremal({"solve", "scene.toml", "--output", "/dev/full"}).exit, 2);
}

TEST_F(CommandLine, WithoutGnuplotAPlotIsRefusedBeforeSolving) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder.c_str(), 1);
  const Refusal refusal{{"solve", "scene.toml", "--output", "r.json", "--plot", "p.svg"},
                        "--plot: gnuplot draws the plots and was not found: apt install gnuplot-nox (see "
                        "extremal help solve)"};
  expect(refusal);
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_FALSE(fs::exists(folder / "r.json"));
}

TEST_F(CommandLine, RefusedScenesLeaveNoFolders) {
  write("bad.toml", "[system]\n");
  EXPECT_EQ(extremal({"solve", "bad.toml", "--output", "new/r.json"}).exit, 2);
  EXPECT_FALSE(fs::exists(folder / "new"));
}
