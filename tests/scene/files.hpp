#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "scene/scene.hpp"

/// \file A folder of its own for each test, and the message that a scene in it gets.

namespace extremal::test {
namespace fs = std::filesystem;

class SceneFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::path(EXTREMAL_BINARY_DIR) / "scratch" /
             (std::string(info->test_suite_name()) + "." + info->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  std::string write(const std::string& name, const std::string& content) {
    const fs::path file = folder / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file.string();
  }

  /// The message without the folder's name; "" if the scene is accepted.
  std::string message(const std::string& content, const std::vector<std::string>& sets = {}) {
    return message_of(write("scene.toml", content), sets);
  }
  std::string message_of(const std::string& path, const std::vector<std::string>& sets = {}) {
    try {
      read_scene(path, sets);
      return "";
    } catch (const SceneError& e) {
      std::string what = e.what();
      const std::string prefix = folder.string() + "/";
      for (std::size_t at; (at = what.find(prefix)) != std::string::npos;) what.erase(at, prefix.size());
      return what;
    }
  }

  fs::path folder;
};

/// A complete scene, each line known: 1 [system], 4 [boundary].
inline const std::string pendulum =
    "[system]\n"
    "coordinates = [\"q\"]\n"
    "lagrangian = \"q'^2/2 + cos(q)\"\n"
    "[boundary]\n"
    "start = { q = 0 }\n"
    "end = { q = 1 }\n"
    "duration = 2\n";

}  // namespace extremal::test
