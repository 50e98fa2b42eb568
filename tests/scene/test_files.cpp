#include <unistd.h>

#include "files.hpp"

using namespace extremal;
using namespace extremal::test;

TEST_F(SceneFiles, MissingFile) {
  EXPECT_EQ(message_of((folder / "no.toml").string()), "no.toml: no such file");
}

TEST_F(SceneFiles, Folder) {
  fs::create_directory(folder / "sub");
  EXPECT_EQ(message_of((folder / "sub").string()), "sub: is a directory; a file is needed");
}

TEST_F(SceneFiles, Device) { EXPECT_EQ(message_of("/dev/zero"), "/dev/zero: is not a regular file"); }

TEST_F(SceneFiles, Empty) { EXPECT_EQ(message(""), "scene.toml: the file is empty"); }

TEST_F(SceneFiles, CommentsOnly) {
  EXPECT_EQ(message("# nothing\n"), "scene.toml: the table [system] is missing");
}

TEST_F(SceneFiles, Unreadable) {
  const std::string path = write("scene.toml", pendulum);
  fs::permissions(path, fs::perms::none);
  if (::access(path.c_str(), R_OK) == 0) GTEST_SKIP() << "this user may read everything";
  EXPECT_EQ(message_of(path), "scene.toml: cannot be opened: Permission denied");
}

TEST_F(SceneFiles, Binary) {
  EXPECT_EQ(message(std::string("ab\n\0x", 5)),
            "scene.toml:2:1: not a text file: byte 4 of 5 is 0x00, which is not UTF-8 text");
  EXPECT_EQ(message("title = \"\xc3\xa9\xff\"\n"),
            "scene.toml:1:11: not a text file: byte 12 of 14 is 0xff, which is not UTF-8 text");
  EXPECT_EQ(message("# \xed\xa0\x80\n"),  // half of a surrogate pair
            "scene.toml:1:3: not a text file: byte 3 of 6 is 0xed, which is not UTF-8 text");
}

TEST_F(SceneFiles, AboveTheLimitIsRefusedByItsSize) {
  const std::string path = write("scene.toml", "");
  fs::resize_file(path, 100'000'000);  // sparse
  EXPECT_EQ(message_of(path), "scene.toml: has 100000000 bytes; at most 16777216 (16 MiB) are read");
}

TEST_F(SceneFiles, SyntaxNamesThePlace) {
  EXPECT_EQ(message("[system]\nuse = \n").rfind("scene.toml:2:7: ", 0), 0u);
  EXPECT_EQ(message("x = 1\nx = 2\n"),
            "scene.toml:2:5: Error while parsing key-value pair: cannot redefine existing integer 'x'");
}

TEST_F(SceneFiles, UnclosedString) {
  EXPECT_EQ(message("title = \"abc\n"),
            "scene.toml:1:13: this string is not closed on its line, or contains a control character");
}

TEST_F(SceneFiles, DeepNestingIsRefused) {
  const std::size_t million = 1'000'000;
  EXPECT_NE(message("x = " + std::string(million, '['))
                .find("lists and tables stand more than 256 deep in each other"),
            std::string::npos);
  std::string braces = "x = ", dotted = "a", quoted = "\"=#\"";
  for (std::size_t k = 0; k < million; ++k) braces += "{a=";
  for (std::size_t k = 0; k < million; ++k) dotted += ".a";
  for (std::size_t k = 0; k < million; ++k) quoted += " . 'x'";
  EXPECT_NE(message(braces).find("lists and tables stand more than 256 deep in each other"),
            std::string::npos);
  EXPECT_EQ(message(dotted + " = 1"), "scene.toml:1:128: this key has more than 64 parts");
  EXPECT_EQ(message("[" + dotted + "]"), "scene.toml:1:129: this key has more than 64 parts");
  EXPECT_NE(message("t = \"\"\"a\"b\"\"\"\"\n" + quoted + " = 1").find("scene.toml:2:"), std::string::npos);
}

TEST_F(SceneFiles, DotsOutsideKeysAreNoKey) {
  std::string prose = "# ";
  for (int k = 0; k < 100; ++k) prose += "a.";
  const std::string lists = "parameters = { m = [" + std::string("0.5, 0.25, ").append(100, ' ') + "0.5] }\n";
  EXPECT_EQ(message("title = \"" + prose + "\"\n" + pendulum), "");
  EXPECT_EQ(message(prose + "\n" + pendulum), "");
  EXPECT_EQ(message("[system]\n" + lists + pendulum.substr(9)), "");
}

TEST_F(SceneFiles, PlacesInsideStrings) {
  const auto source = std::make_shared<Source>(
      Source{"s", "a = \"x\\ty\\u00e9z\"\nb = '''\nab\ncd'''\nc = \"\"\"\nab\\\n  cd\"\"\"\n"});
  const auto place = [](const Location& l) { return std::pair(l.line, l.column); };
  const Text basic{"x\ty\u00e9z", {source, 1, 5}};
  EXPECT_EQ(place(position(basic, 0)), std::pair(1, 6));
  EXPECT_EQ(place(position(basic, 1)), std::pair(1, 7));   // the tab, as written
  EXPECT_EQ(place(position(basic, 2)), std::pair(1, 9));   // y
  EXPECT_EQ(place(position(basic, 3)), std::pair(1, 10));  // two bytes, six characters
  EXPECT_EQ(place(position(basic, 5)), std::pair(1, 16));  // z
  const Text literal{"ab\ncd", {source, 2, 5}};
  EXPECT_EQ(place(position(literal, 0)), std::pair(3, 1));
  EXPECT_EQ(place(position(literal, 4)), std::pair(4, 2));
  const Text joined{"abcd", {source, 5, 5}};
  EXPECT_EQ(place(position(joined, 1)), std::pair(6, 2));
  EXPECT_EQ(place(position(joined, 2)), std::pair(7, 3));
}
