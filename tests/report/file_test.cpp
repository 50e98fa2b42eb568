#include "report/file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <thread>

#include "report/folders.hpp"
#include "report/temporary_folder.hpp"

namespace extremal {
namespace {
namespace fs = std::filesystem;

TEST(Files, AreWrittenAllOrNone) {
  const TemporaryFolder folder;
  write_files({{folder / "a", "one"}, {folder / "new/b", "two"}});
  EXPECT_EQ(content(folder / "a"), "one");
  EXPECT_EQ(content(folder / "new/b"), "two");
  EXPECT_THROW(write_files({{folder / "a", "other"}, {folder / "c", "more"}, {"/dev/full", "x"}}),
               std::runtime_error);
  EXPECT_THROW(write_files({{folder / "a", "other"}, {folder / "a/c", "below a file"}}), std::runtime_error);
  EXPECT_EQ(content(folder / "a"), "one");
  EXPECT_EQ(entries(folder.path()).size(), 2u);
}

TEST(Files, ANameMayBeAsLongAsNamesCanBe) {
  const TemporaryFolder folder;
  const std::string name(255, 'n');
  write_files({{folder / name, "text"}});
  EXPECT_EQ(content(folder / name), "text");
  try {
    write_files({{folder / (name + "n"), "text"}});
    ADD_FAILURE() << "written";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("name too long"), std::string::npos) << error.what();
  }
  EXPECT_EQ(entries(folder.path()).size(), 1u);
}

TEST(Files, APipeGetsMoreThanItHolds) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe", long_text(1 << 20, 'x');
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = content(pipe); });
  write_files({{pipe, long_text}});
  reader.join();
  EXPECT_EQ(read, long_text);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(Files, AreTheSameThroughLinks) {
  const TemporaryFolder folder;
  write_files({{folder / "a", "text"}});
  fs::create_symlink("a", folder / "soft");
  fs::create_symlink("missing", folder / "dangling");
  fs::create_hard_link(folder / "a", folder / "hard");
  for (const char* other : {"a", "./a", "soft", "hard", "new/../a"})
    EXPECT_TRUE(same_file(folder / "a", folder / other)) << other;
  EXPECT_TRUE(same_file(folder / "dangling", folder / "missing"));
  EXPECT_TRUE(same_file(folder / "missing", folder / "new/../missing"));
  EXPECT_FALSE(same_file(folder / "a", folder / "missing"));
  EXPECT_FALSE(same_file("/dev/null", "/dev/null"));
  EXPECT_FALSE(same_file("-", "-"));
}

}  // namespace
}  // namespace extremal
