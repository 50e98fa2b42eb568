#include "command.hpp"

using namespace extremal::test;

namespace {

class Pages : public Command {
 protected:
  /// What a shell prints, standard error included.
  std::string shell(const std::string& script, const std::string& interpreter = "bash") {
    write("script", script);
    const std::string command = fmt::format("cd '{}' && PATH=\"{}:$PATH\" {} script >printed 2>&1",
                                            folder.string(), EXTREMAL_BINARY_DIR, interpreter);
    EXPECT_EQ(std::system(command.c_str()), 0) << read_text(folder / "printed");
    return read_text(folder / "printed");
  }
  static bool available(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
  }
  /// What bash offers for the last word of a command line.
  std::string completed(const std::vector<std::string>& words) {
    std::string script = "source <(extremal completion bash)\nCOMP_WORDS=(extremal";
    for (const std::string& word : words) script += " '" + word + "'";
    script += fmt::format(")\nCOMP_CWORD={}\n_extremal extremal\necho \"${{COMPREPLY[*]}}\"\n", words.size());
    std::string printed = shell(script);
    printed.pop_back();
    return printed;
  }
};

}  // namespace

TEST_F(Pages, BashCompletesCommandsOptionsScenesAndSystems) {
  write("scene.toml", pendulum);
  write("result.json", "{}");
  fs::create_directory(folder / "sub");
  EXPECT_EQ(completed({"so"}), "solve");
  EXPECT_EQ(completed({""}), "solve continue compare spectrum check list init view help --help --version");
  EXPECT_EQ(completed({"solve", ""}), "scene.toml sub");
  EXPECT_EQ(completed({"solve", "--s"}), "--set --samples");
  EXPECT_EQ(completed({"compare", "--s"}), "--set");
  EXPECT_EQ(completed({"solve", "scene.toml", "--output", "res"}), "result.json");
  EXPECT_EQ(completed({"solve", "scene.toml", "--samples", ""}), "");
  EXPECT_EQ(completed({"list", "keple"}), "kepler kepler-space");
  EXPECT_EQ(completed({"help", "con"}), "continue");
}

TEST_F(Pages, ZshCompletesTheSameOptions) {
  const std::string page = extremal({"completion", "zsh"}).out;
  EXPECT_EQ(page.rfind("#compdef extremal\n", 0), 0u);
  for (const char* text : {"'solve:find the extremal of a scene, or several with [search]'", "'--quiet[",
                           "'*--set[", "'1:SCENE:_files -g \"*.toml\"'", ":FILE.json:_files'"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  if (available("zsh")) shell("zsh -n <(extremal completion zsh)");
}

TEST_F(Pages, TheManualHasEveryCommandOptionCodeAndVariable) {
  const std::string page = extremal({"man"}).out;
  for (const char* text :
       {".TH EXTREMAL 1", ".SS extremal solve SCENE", ".SS extremal continue", ".SS extremal compare",
        ".SS extremal check", ".SS extremal list [SYSTEM]", ".SS extremal help",
        "\\fB\\-\\-output\\fR \\fIFILE.json\\fR", "(default 1)", ".SH EXIT STATUS", ".SH ENVIRONMENT",
        "EXTREMAL_SIMD", "EXTREMAL_PROBLEMS", "EXTREMAL_THREADS", "problems/README.md"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

TEST_F(Pages, RoffAcceptsTheManual) {
  if (!available("groff")) GTEST_SKIP() << "groff is not installed";
  write("extremal.1", extremal({"man"}).out);
  EXPECT_EQ(shell("groff -man -Tutf8 -ww -z extremal.1"), "");
}

TEST_F(Pages, OtherShellsAreRefused) {
  const Outcome o = extremal({"completion", "fish"});
  EXPECT_EQ(o.exit, 2);
  EXPECT_EQ(o.error, "error: SHELL: fish not in {bash,zsh,systems} (see extremal help completion)\n");
}
