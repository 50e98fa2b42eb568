#include "command.hpp"

using namespace extremal::test;

namespace {

const std::string arc =
    "title = 'Arc'\n[system]\nuse = 'kepler'\n[boundary]\nstart = { x = 1.0, y = 0.0 }\n"
    "end = { x = -0.6, y = 0.9 }\nduration = 2.5\n";
const std::string units =
    "[units]\nlength = 149597870.7\ntime = 5022642.9\nframe = 'ICRF'\ncentre = 'SUN'\nepoch = '2025-01-31'\n";

using Oem = Command;

TEST_F(Oem, IsWrittenInTheUnitsOfTheScene) {
  write("arc.toml", arc + units);
  const Outcome o = extremal({"solve", "arc.toml", "--oem", "arc.oem", "--samples", "3", "--quiet"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const std::string text = read_text(folder / "arc.oem");
  EXPECT_EQ(text.rfind("CCSDS_OEM_VERS = 2.0\n", 0), 0u);
  EXPECT_NE(text.find("OBJECT_NAME = Arc\n"), std::string::npos);
  EXPECT_NE(text.find("\n2025-01-31T00:00:00.000000000 1.495978707000000e+08 0.000000000000000e+00 "),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("STOP_TIME = 2025-06-25T07:56:47.250000000\n"), std::string::npos) << text;
}

TEST_F(Oem, WithoutUnitsOrPositionsIsRefused) {
  write("arc.toml", arc);
  const Outcome o = extremal({"solve", "arc.toml", "--oem", "arc.oem"});
  EXPECT_EQ(o.exit, 2);
  EXPECT_NE(o.error.find("[units]"), std::string::npos) << o.error;
  EXPECT_FALSE(fs::exists(folder / "arc.oem"));
  write("swing.toml", pendulum + units);
  EXPECT_EQ(extremal({"solve", "swing.toml", "--oem", "swing.oem"}).exit, 2);
}

TEST_F(Oem, UnitsAreChecked) {
  const auto refused = [&](const std::string& before, const std::string& after) {
    std::string scene = arc + units;
    scene.replace(scene.find(before), before.size(), after);
    write("arc.toml", scene);
    const Outcome o = extremal({"solve", "arc.toml"});
    EXPECT_EQ(o.exit, 2) << after;
    return o.error;
  };
  EXPECT_NE(refused("time = 5022642.9", "time = 0").find("arc.toml:10:8: time = 0"), std::string::npos);
  EXPECT_NE(refused("2025-01-31", "2025-02-30").find("write it as"), std::string::npos);
  EXPECT_NE(refused("2025-01-31", "2025-01-31T24:00:00").find("write it as"), std::string::npos);
  EXPECT_NE(refused("epoch = '2025-01-31'\n", "").find("no 'epoch'"), std::string::npos);
  EXPECT_NE(refused("'SUN'", "''").find("centre"), std::string::npos);
  EXPECT_NE(refused("frame", "frames").find("did you mean 'frame'"), std::string::npos);
}

}  // namespace
