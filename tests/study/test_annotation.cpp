#include "study/annotation.hpp"

#include "scenes.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

const std::string two_centres =
    "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { mu = 0.25 }\n"
    "lagrangian = \"(x'^2 + y'^2)/2 + (1 - mu)/sqrt((x + mu)^2 + y^2 + 1) + mu/sqrt((x - 1 + mu)^2 + y^2 + "
    "1)\"\n";

const std::string path =
    "[system]\nuse = \"two\"\n[boundary]\nstart = { x = 0.5, y = 0 }\nend = { x = 0.5, y = 1 }\nduration = "
    "1\n";

}  // namespace

class Annotations : public Scenes {
 protected:
  Annotation of(const std::string& about, const std::string& scene = path) {
    write("two.toml", "[about]\nsummary = \"Two centres\"\n" + about + two_centres);
    return annotation(study(scene));
  }
  std::string refusal(const std::string& about) {
    try {
      of(about);
    } catch (const SceneError& e) {
      const std::string what = e.what();
      return what.substr(what.find("two.toml"));
    }
    return "accepted";
  }
};

TEST_F(Annotations, UnitsAndCentres) {
  const Annotation found =
      of("axes = [\"x, y: km\", \"t: s\", \"energy: km²/s²\"]\n"
         "centres = [\"Earth: -mu, 0\", \"max(1 - mu, 0), 0\"]\n");
  EXPECT_EQ(found.units,
            (std::map<std::string, std::string>{{"x", "km"}, {"y", "km"}, {"t", "s"}, {"energy", "km²/s²"}}));
  ASSERT_EQ(found.centres.size(), 2u);
  EXPECT_EQ(found.centres[0].name, "Earth");
  EXPECT_EQ(found.centres[0].at, (std::vector<double>{-0.25, 0}));
  EXPECT_EQ(found.centres[1].name, "");
  EXPECT_EQ(found.centres[1].at, (std::vector<double>{0.75, 0}));
  EXPECT_EQ(of("centres = \"0, 0\"\n").centres.size(), 1u);
  EXPECT_TRUE(of("").units.empty());
}

TEST_F(Annotations, CentresThatMoveWithAContinuedParameterAreLeftOut) {
  const Annotation found =
      of("centres = [\"-mu, 0\", \"0, 0\"]\n", path + "[continuation]\nparameter = \"mu\"\nto = 0.5\n");
  ASSERT_EQ(found.centres.size(), 1u);
  EXPECT_EQ(found.centres[0].at, (std::vector<double>{0, 0}));
}

TEST_F(Annotations, AreRefusedWithTheirPlace) {
  EXPECT_EQ(refusal("axes = [\"x\"]\n"),
            "two.toml:3:10: an entry of 'axes' names coordinates and their unit, as \"x, y: km\"");
  EXPECT_EQ(refusal("axes = [\"x, yy: m\"]\n"), "two.toml:3:13: there is no axis 'yy'; did you mean 'y'?");
  EXPECT_EQ(refusal("centres = [\"0, 0, 0\"]\n"),
            "two.toml:3:13: a centre has one formula for each coordinate: 2 are wanted, 3 given");
  EXPECT_EQ(refusal("centres = [\"0, nu\"]\n"), "two.toml:3:16: unknown name 'nu'; did you mean 'mu'?");
}
