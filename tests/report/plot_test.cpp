#include "report/plot.hpp"
#include "machine/long_test.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "report/folders.hpp"
#include "report/sample_results.hpp"
#include "report/temporary_folder.hpp"
#include "report/well_formed.hpp"

namespace extremal {
namespace {

Picture arc(const std::string& title, const std::vector<std::string>& names) {
  Picture picture{.title = title, .names = names, .samples = {}};
  picture.samples.q.resize(names.size());
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.02 * k;
    picture.samples.t.push_back(t);
    for (std::size_t a = 0; a < names.size(); ++a) {
      picture.samples.q[a].push_back(std::sin(t + static_cast<double>(a)));
    }
  }
  picture.samples.v = picture.samples.p = picture.samples.q;
  return picture;
}

/// Sets a variable of the environment for as long as it lives.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* before = getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() {
    if (before_) {
      setenv(name_, before_->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(WellFormed, FindsFaults) {
  EXPECT_TRUE(well_formed("<a b=\"1\"><c/>x &amp; y</a>"));
  EXPECT_FALSE(well_formed("<a><c></a></c>"));
  EXPECT_FALSE(well_formed("<a>x & y</a>"));
  EXPECT_FALSE(well_formed("<a>x < y</a>"));
  EXPECT_FALSE(well_formed("<a>x ]]> y</a>"));
  EXPECT_FALSE(well_formed("<a>"));
}

std::vector<std::string> three(const std::string& name) { return {name + "[1]", name + "[2]", name + "[3]"}; }

std::vector<std::vector<std::string>> kinds() {
  std::vector<std::string> plane = three("x"), space, chain;
  for (const std::string& name : three("y")) plane.push_back(name);
  space = plane;
  for (const std::string& name : three("z")) space.push_back(name);
  for (int i = 1; i <= 64; ++i) chain.push_back("q[" + std::to_string(i) + "]");
  return {{"phi"}, {"x", "y"}, {"x", "y", "z"}, plane, space, chain, {"a", "b", "c", "d_e"}};
}

TEST(Plot, EveryKindAsSvgAndPng) {
  LONG_TEST();
  const TemporaryFolder folder;
  for (const std::vector<std::string>& names : kinds()) {
    const Picture picture = arc("Arc of " + std::to_string(names.size()), names);
    write_plot(folder / "p.svg", picture);
    const std::string svg = content(folder / "p.svg");
    EXPECT_TRUE(well_formed(svg)) << names.size();
    EXPECT_EQ(svg.substr(0, 5), "<?xml");
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    EXPECT_NE(svg.find(">" + picture.title + "<"), std::string::npos);
    EXPECT_GT(svg.size(), 5000u);

    write_plot(folder / "p.png", picture);
    const std::string png = content(folder / "p.png");
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_NE(png.find("IEND"), std::string::npos);
    EXPECT_GT(png.size(), 10000u);

    write_plot(folder / "p.pdf", picture);
    const std::string pdf = content(folder / "p.pdf");
    EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
    EXPECT_NE(pdf.find("%%EOF"), std::string::npos);
    EXPECT_NE(pdf.find("/CreationDate (D:20000101000000"), std::string::npos);
  }
}

TEST(Plot, IsTheSameTwice) {
  LONG_TEST();
  const TemporaryFolder folder;
  for (const std::vector<std::string>& names : kinds()) {
    for (const std::string suffix : {".svg", ".png", ".pdf"}) {
      write_plot(folder / ("a" + suffix), arc("Twice", names));
      write_plot(folder / ("b" + suffix), arc("Twice", names));
      EXPECT_TRUE(content(folder / ("a" + suffix)) == content(folder / ("b" + suffix))) << suffix;
    }
  }
}

TEST(Plot, TitlesAreTextAndNothingElse) {
  const TemporaryFolder folder;
  const std::string mark = folder / "mark";
  const std::vector<std::string> titles{
      "`touch " + mark + "`",
      "$(touch " + mark + ")",
      "'; system('touch " + mark + "'); '",
      "\"; system(\"touch " + mark + "\"); \"",
      "'\n!touch " + mark + "\n'",
      "\\\"; !touch " + mark + "\n\\",
      "\nEOD\nsystem('touch " + mark + "')\n",
      "%s %n %1$s {/:Bold x_2^3} @mark &{x} ~a{b}",
      "</text></svg><script>alert(1)</script>&amp;]]>",
      "τ → ∞ — “quoted” 𝛿",
      std::string("nul\0byte", 8),
      "\xff\xfe\xc3",
      "'",
      "\\",
      std::string(5000, 'x'),
  };
  for (const std::string& title : titles) {
    write_plot(folder / "p.svg", arc(title, {"x", "y"}));
    EXPECT_TRUE(well_formed(content(folder / "p.svg"))) << title;
    EXPECT_FALSE(std::filesystem::exists(mark)) << title;
  }
  for (const std::string& title : {titles[0], std::string("τ\xff\xfe\xc3")}) {
    write_plot(folder / "p.png", arc(title, {"x", "y"}));
    EXPECT_FALSE(std::filesystem::exists(mark)) << title;
  }
  write_plot(folder / "p.svg", arc("it's <x> & \"y\" `z` {a}_b^c %d", {"x", "y"}));
  EXPECT_NE(content(folder / "p.svg").find("it's &lt;x> &amp; \"y\" `z` {a}_b^c %d"), std::string::npos);
}

/// The texts of an SVG that hold no further tags, in the order in which they are drawn.
std::vector<std::string> texts(const std::string& svg) {
  std::vector<std::string> list;
  for (std::size_t k = svg.find("<text"); k != svg.npos; k = svg.find("<text", k + 1)) {
    const std::size_t start = svg.find('>', k) + 1;
    list.push_back(svg.substr(start, svg.find('<', start) - start));
  }
  return list;
}

TEST(Plot, WritesNumbersAndNamesAsTheyAre) {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"q_1[1]", "q_1[2]"};
  Picture picture{.title = "2.5e10's #1", .names = names, .samples = {}};
  picture.samples = {.t = {0, 2}, .q = {{0, 5e-7}, {1, 1e-6}}, .v = {}, .p = {}};
  picture.samples.q[1][0] = 0;
  write_plot(folder / "p.svg", picture);
  const std::vector<std::string> drawn = texts(content(folder / "p.svg"));
  const auto has = [&](const std::string& text) {
    return std::find(drawn.begin(), drawn.end(), text) != drawn.end();
  };
  for (const char* text :
       {"2.5e10's #1", "q_1[1]  (10⁻⁷)", "q_1[2]  (10⁻⁶)", "t", "0.0", "0.5", "1.0", "−2"}) {
    EXPECT_TRUE(has(text)) << text << " is not in " << testing::PrintToString(drawn);
  }
}

TEST(Plot, LeavesNothingBehindAndSaysNothing) {
  const TemporaryFolder scratch, folder;
  const Environment environment("TMPDIR", scratch.path());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  write_plot(folder / "it's a plot.svg", arc("Quiet", {"x", "y"}));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(entries(scratch.path()).empty());
  EXPECT_EQ(entries(folder.path()), (std::vector<std::string>{"it's a plot.svg"}));
}

TEST(Plot, AFolderForScratchMayHaveAnyName) {
  const TemporaryFolder folder;
  const std::string strange = folder / "a 'b' `c` $d";
  std::filesystem::create_directory(strange);
  const Environment environment("TMPDIR", strange);
  write_plot(folder / "p.svg", arc("Strange", {"x"}));
  EXPECT_TRUE(well_formed(content(folder / "p.svg")));
  EXPECT_TRUE(entries(strange).empty());
}

TEST(Plot, StartUpFilesAreNotRead) {
  const TemporaryFolder home, folder;
  std::ofstream(home / ".gnuplot") << "set title 'FROM THE START-UP FILE'\n";
  const Environment environment("HOME", home.path());
  write_plot(folder / "p.svg", arc("Plain", {"x"}));
  EXPECT_EQ(content(folder / "p.svg").find("START-UP"), std::string::npos);
}

TEST(Plot, SaysHowToGetGnuplot) {
  const TemporaryFolder empty, folder;
  const Environment environment("PATH", empty.path());
  try {
    write_plot(folder / "p.svg", arc("", {"x"}));
    ADD_FAILURE() << "drawn without gnuplot";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("apt install gnuplot-nox"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(entries(folder.path()).empty());
}

TEST(Plot, PassesOnWhatGnuplotSays) {
  const TemporaryFolder folder;
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\necho no terminal >&2\nexit 3\n";
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const Environment environment("PATH", folder.path());
  try {
    write_plot(folder / "p.svg", arc("", {"x"}));
    ADD_FAILURE() << "drawn without gnuplot";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "gnuplot failed: no terminal ");
  }
}

/// The text of the exception.
template <class Exception>
std::string refusal(const std::string& path, const Picture& picture) {
  try {
    write_plot(path, picture);
  } catch (const Exception& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Plot, RefusesOtherSuffixes) {
  for (const char* path : {"p.gif", "p", "svg", "p.SVG", ""}) {
    EXPECT_THROW(check_plot_path(path), std::invalid_argument) << path;
  }
  EXPECT_NO_THROW(check_plot_path("a/b.svg"));
  EXPECT_NO_THROW(check_plot_path("b.png"));
  EXPECT_NO_THROW(check_plot_path("b.pdf"));
  EXPECT_EQ(refusal<std::invalid_argument>("p.gif", arc("", {"x"})),
            "cannot plot into p.gif: the name must end in .svg, .png, .pdf or .html");
}

TEST(Plot, APathThatCannotBeWrittenIsNamed) {
  EXPECT_EQ(refusal<std::runtime_error>("/dev/null/p.svg", arc("", {"x"})),
            "cannot write /dev/null/p.svg: Not a directory");
}

TEST(Plot, RefusesSamplesThatCannotBeDrawn) {
  Picture picture = arc("", {"x", "y"});
  picture.samples.q[1][3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal<std::invalid_argument>("p.svg", picture), "cannot plot y: nan at sample 4");
  picture = arc("", {"x", "y"});
  picture.samples.q[1].pop_back();
  EXPECT_EQ(refusal<std::invalid_argument>("p.svg", picture),
            "samples have 200 values of \"y\" at 201 times");
  picture = arc("", {"x"});
  picture.samples.t[1] = 0;
  EXPECT_EQ(refusal<std::invalid_argument>("p.svg", picture), "cannot plot: times 0 and 0 do not increase");
  picture = {.title = "", .names = {"x"}, .samples = {.t = {0}, .q = {{1}}, .v = {}, .p = {}}};
  EXPECT_EQ(refusal<std::invalid_argument>("p.svg", picture), "cannot plot 1 samples; need at least 2");
  EXPECT_EQ(refusal<std::invalid_argument>("p.svg", Picture{}), "cannot plot 0 coordinates");
}

}  // namespace
}  // namespace extremal
