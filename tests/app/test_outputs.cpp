#include <chrono>
#include <csignal>
#include <set>
#include <thread>

#include "command.hpp"
#include "machine/long_test.hpp"

using namespace extremal::test;

namespace {

using Clock = std::chrono::steady_clock;

class Outputs : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("scene.toml", pendulum + "[guess]\nfile = \"guess.csv\"\n");
    write("guess.csv", "t,q\n0,0\n2,1.5\n");
    write("used.toml", "[system]\ncoordinates = [\"q\"]\nlagrangian = \"q'^2/2 + cos(q)\"\n");
    write("uses.toml",
          "[system]\nuse = \"used\"\n[boundary]\nstart = { q = 0.0 }\nend = { q = 1.5 }\nduration = 2.0\n");
    fs::create_directory(folder / "sub");
    fs::create_symlink("scene.toml", folder / "link");
    fs::create_symlink("../guess.csv", folder / "sub" / "link");
    fs::create_hard_link(folder / "scene.toml", folder / "hard");
  }
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder)) found.insert(entry.path().filename().string());
    return found;
  }
};

TEST_F(Outputs, ArraysOfNumpyAreAGuess) {
  const Outcome o = extremal({"solve", "scene.toml", "--npz", "path.npz", "--samples", "9"});
  ASSERT_EQ(o.exit, 0) << o.error;
  EXPECT_EQ(read_text(folder / "path.npz").rfind("PK\3\4", 0), 0u);
  const Outcome again = extremal({"solve", "scene.toml", "--set", "guess.file=path.npz"});
  EXPECT_EQ(again.exit, 0) << again.error;
}

TEST_F(Outputs, NeverReplaceWhatTheSceneIsReadFrom) {
  const std::string scene = read_text(folder / "scene.toml");
  const std::vector<std::pair<std::string, std::string>> cases = {{"scene.toml", "scene.toml"},
                                                                  {"scene.toml", "./sub/../scene.toml"},
                                                                  {"scene.toml", "link"},
                                                                  {"scene.toml", "hard"},
                                                                  {"scene.toml", "new/../scene.toml"},
                                                                  {"scene.toml", "guess.csv"},
                                                                  {"scene.toml", "sub/link"},
                                                                  {"uses.toml", "used.toml"},
                                                                  {"uses.toml", "./used.toml"},
                                                                  {"link", "scene.toml"},
                                                                  {"link", "guess.csv"}};
  for (const auto& [name, path] : cases)
    for (const char* option : {"--output", "--csv"}) {
      const std::string before = read_text(folder / path);
      const Outcome o = extremal({"solve", name, option, path});
      EXPECT_EQ(o.exit, 2) << name << " " << path;
      EXPECT_NE(o.error.find("from which the scene is read"), std::string::npos) << o.error;
      EXPECT_EQ(read_text(folder / path), before);
    }
  EXPECT_EQ(read_text(folder / "scene.toml"), scene);
}

TEST_F(Outputs, AreFilesOfTheirOwn) {
  write("a.json", "old");
  fs::create_symlink("a.json", folder / "b");
  fs::create_symlink("missing", folder / "c");
  for (const auto& [first, second] : std::vector<std::pair<std::string, std::string>>{
           {"a.json", "./a.json"}, {"a.json", "b"}, {"c", "missing"}}) {
    const Outcome o = extremal({"solve", "scene.toml", "--output", first, "--csv", second});
    EXPECT_EQ(o.exit, 2);
    EXPECT_NE(o.error.find("name one file"), std::string::npos) << o.error;
  }
  EXPECT_EQ(read_text(folder / "a.json"), "old");
  EXPECT_EQ(extremal({"solve", "scene.toml", "--output", "/dev/null", "--csv", "/dev/null"}).exit, 0);
}

TEST_F(Outputs, AreAllWrittenOrNone) {
  write("old.json", "old");
  const std::set<std::string> before = names();
  for (const char* bad : {"/dev/full", "/proc/r.csv"}) {
    const Outcome o = extremal({"solve", "scene.toml", "--output", "old.json", "--csv", bad});
    EXPECT_EQ(o.exit, 2);
    EXPECT_NE(o.error.find("error: "), std::string::npos) << o.error;
    EXPECT_EQ(read_text(folder / "old.json"), "old");
    EXPECT_EQ(extremal({"solve", "scene.toml", "--output", "new.json", "--csv", bad}).exit, 2);
  }
  std::set<std::string> after = names();
  for (const char* streams : {"stdout", "stderr"}) after.erase(streams);
  EXPECT_EQ(after, before);
}

TEST_F(Outputs, FollowLinksAndKeepPermissions) {
  write("target.json", "old");
  fs::permissions(folder / "target.json", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("target.json", folder / "r.json");
  ASSERT_EQ(extremal({"solve", "scene.toml", "--output", "r.json", "--quiet"}).exit, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "r.json"));
  EXPECT_NE(read_text(folder / "target.json").find("converged"), std::string::npos);
  EXPECT_EQ(fs::status(folder / "target.json").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Outputs, AFileAtItsLimitOfSizeLeavesTheOldOne) {
  write("old.csv", "old");
  const std::set<std::string> before = names();
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{4096, limit.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const Outcome o = extremal({"solve", "scene.toml", "--csv", "old.csv", "--samples", "1000", "--quiet"});
  ::setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_EQ(o.exit, 2);
  EXPECT_NE(o.error.find("cannot write old.csv"), std::string::npos) << o.error;
  EXPECT_EQ(read_text(folder / "old.csv"), "old");
  std::set<std::string> after = names();
  for (const char* streams : {"stdout", "stderr"}) after.erase(streams);
  EXPECT_EQ(after, before);
}

/// A chain that no verb which solves is done with at once.
std::string chain(int masses) {
  return fmt::format(
      "[system]\ncoordinates = [\"x[{0}]\"]\n"
      "lagrangian = \"sum(i, 1, {0}, x[i]'^2/2 + cos(x[i])) - sum(i, 1, {0} - 1, (x[i+1] - x[i])^4/4)\"\n"
      "[boundary]\nstart = {{ x = \"0\" }}\nend = {{ x = \"i\" }}\nduration = 60.0\n"
      "[continuation]\nparameter = \"duration\"\nto = 600.0\npoints = 1000\n",
      masses);
}

TEST_F(Outputs, AnInterruptEndsEveryVerbAtOnceAndLeavesNothing) {
  using namespace std::chrono_literals;
  write("chain.toml", chain(150));
  fs::create_directory(folder / "temporary");
  ::setenv("TMPDIR", (folder / "temporary").c_str(), 1);
  for (const int signal : {SIGINT, SIGTERM})
    for (const char* verb : {"solve", "continue", "compare", "check"}) {
      const bool writes = std::string(verb) != "check";
      std::vector<std::string> arguments{verb, "chain.toml"};
      if (writes) arguments.insert(arguments.end(), {"--output", "r.json", "--plot", "r.svg"});
      const std::set<std::string> before = names();
      const pid_t child = start(arguments);
      std::this_thread::sleep_for(200ms);
      const auto sent = Clock::now();
      ::kill(child, signal);
      const Outcome o = finish(child);
      EXPECT_LT(Clock::now() - sent, 1s) << verb;  // a busy machine
      if (writes) {
        EXPECT_EQ(o.exit, 128 + signal) << verb << o.error;
      }
      EXPECT_TRUE(fs::is_empty(folder / "temporary"));
      EXPECT_FALSE(fs::exists(folder / "r.json")) << verb;
    }
  ::unsetenv("TMPDIR");
  for (const std::string& name : names()) EXPECT_NE(name.rfind(".extremal", 0), 0u) << name;
}

/// A step that is begun is ended; those of Ipopt and Ceres are long where coordinates are many.
TEST_F(Outputs, TheBudgetEndsEveryVerb) {
  LONG_TEST();
  using namespace std::chrono_literals;
  write("long.toml", chain(100));
  write("short.toml", chain(40));
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"solve", "long.toml"},
                                             {"solve", "short.toml", "--set", "solve.method=ipopt"},
                                             {"solve", "short.toml", "--set", "solve.method=ceres"},
                                             {"solve", "long.toml", "--set", "search.solutions=5"},
                                             {"continue", "long.toml"},
                                             {"compare", "long.toml"}}) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"--set", "solve.budget=0.02"});
    const auto begin = Clock::now();
    const Outcome o = extremal(all);
    if (o.error.find("is not part of this build") != std::string::npos) continue;
    EXPECT_LT(Clock::now() - begin, 20s) << all[0] << all.back();
    EXPECT_EQ(o.exit, 1) << o.error;
    EXPECT_NE(o.error.find("the budget of 0.02 s"), std::string::npos) << o.error;
  }
}

TEST_F(Outputs, ControlCharactersNeverReachTheTerminal) {
  const auto clean = [](const Outcome& o) {
    for (const std::string* text : {&o.out, &o.error})
      for (const char c : *text)
        if (static_cast<unsigned char>(c) < 0x20 && c != '\n') return false;
    return o.out.find("\nerror: forged") == std::string::npos &&
           o.error.find("\nerror: forged") == std::string::npos;
  };
  const std::string forged = "a\nerror: forged \x1b[31m";
  const std::vector<std::vector<std::string>> runs = {
      {"solve", forged},
      {"list", forged},
      {forged},
      {"solve", "scene.toml", "--" + forged},
      {"solve", "scene.toml", "--set", forged},
      {"solve", "scene.toml", "--at", forged},
      {"solve", "scene.toml", "--set", "guess.file=" + forged},
      {"solve", "uses.toml", "--set", "system.use=\"a\\nerror: forged \\u001b[31m\""},
      {"solve", "uses.toml", "--set", "title=\"a\\nerror: forged \\u001b[31m\""},
      {"check", "uses.toml", "--set", "title=\"a\\nerror: forged \\u001b[31m\""},
      {"solve", "uses.toml", "--set", "solve.scheme=\"a\\nerror: forged \\u009b31m\""},
      {"solve", "scene.toml", "--csv", forged + "/"}};
  for (const std::vector<std::string>& arguments : runs) {
    const Outcome o = extremal(arguments);
    EXPECT_TRUE(clean(o)) << ::testing::PrintToString(arguments) << o.out << o.error;
  }
  write("forged.csv", "t,q\n0,\x1b[31m\n1,1\n");
  EXPECT_TRUE(clean(extremal({"solve", "scene.toml", "--set", "guess.file=forged.csv"})));
}

TEST_F(Outputs, AStateOfTooManyOscillationsIsRefused) {
  using namespace std::chrono_literals;
  const std::string scene =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - 1e8*x^2/2\"\n"
      "[boundary]\nstart = { x = 1 }\nend = { x = 1 }\nduration = 1e4\n[guess]\nstate = { x = 1 }\n";
  write("fast.toml", scene);
  const auto begin = Clock::now();
  const Outcome o = extremal({"check", "fast.toml"});
  EXPECT_LT(Clock::now() - begin, 30s);
  EXPECT_EQ(o.exit, 2);
  EXPECT_NE(o.error.find("about 1.6e+07 oscillations"), std::string::npos) << o.error;
}

}  // namespace
