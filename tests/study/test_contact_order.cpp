#include <fmt/format.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "problem/inequalities.hpp"
#include "scenes.hpp"
#include "solution/path_contacts.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// A chain above walls q[i] >= low under a load: the action is convex.
std::string chain(int n, const std::string& stiffness, const std::string& load, double low, double end,
                  double duration) {
  std::string walls;
  for (int i = 1; i <= n; ++i) walls += fmt::format("{}\"q[{}] >= {}\"", i > 1 ? ", " : "", i, low);
  return fmt::format(
      "[system]\ncoordinates = [\"q[{0}]\"]\n"
      "lagrangian = \"sum(i, 1, {0}, q[i]'^2)/2 + {1} + {2}\"\n[path]\nconstraints = [{3}]\n[boundary]\n"
      "start = {{ q = \"{4}\" }}\nend = {{ q = \"{4}\" }}\nduration = {5}\n",
      n, stiffness, load, walls, end, duration);
}

}  // namespace

class ContactOrder : public UnderInequalities {
 protected:
  /// The action of the minimiser, by a quadratic programme on equal elements: beyond it by their error.
  static void expect_minimum(const Solution& found, double programme, double error) {
    ASSERT_TRUE(found.converged()) << found.message;
    EXPECT_LT(found.action, programme);
    EXPECT_GT(found.action, programme - error);
  }
};

// The values of quadratic programmes are those of 600 elements with linear paths and the trapezoidal rule.
TEST_F(ContactOrder, ContactsThatBeginShortlyOneAfterTheOther) {
  const Study s = study(chain(3, "(q[2] - q[1])^2 + (q[3] - q[2])^2/2 + q[1]^2/2 + q[3]^2/2",
                              "q[1] + 1.5*q[2] + q[3]", 0.3, 0.5, 3));
  const Solution found = run(s);
  expect_minimum(found, 4.01993382, 1e-5);
  const std::vector<Contact>& contacts = found.contacts->contacts;
  ASSERT_EQ(contacts.size(), 3u);
  // In order of their beginnings: the middle, the left one and, six ten-thousandths later, the right one.
  EXPECT_EQ(contacts[0].constraint, 1);
  EXPECT_EQ(contacts[1].constraint, 0);
  EXPECT_EQ(contacts[2].constraint, 2);
  EXPECT_NEAR(contacts[2].from - contacts[1].from, 5.66e-4, 1e-6);
  // The momentum does not jump where they begin.
  const double h = 1e-9;
  std::vector<double> q(3), v(3), later(3);
  for (const Contact& contact : contacts) {
    found.trajectory.at(contact.from - h, q, v);
    found.trajectory.at(contact.from + h, q, later);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(v[a], later[a], 1e-7);
  }
}

TEST_F(ContactOrder, PairsOfContactsThatBeginAtOnce) {
  LONG_TEST();
  const Solution found = run(study(
      chain(5, "sum(i, 1, 4, (q[i+1] - q[i])^2)/2", "q[1] + q[2] + q[3] + 1.5*q[4] + q[5]", 0.3, 0.4, 2)));
  expect_minimum(found, 3.61158793, 1e-5);
  EXPECT_EQ(found.contacts->contacts.size(), 5u);
}

TEST_F(ContactOrder, AContactOnTopOfOthersIsNoCorner) {
  const Solution found =
      run(study(chain(4, "sum(i, 1, 3, (q[i+1] - q[i])^2)/2", "q[1] + q[2] + q[3] + q[4]", 0.1, 0.5, 2)));
  expect_minimum(found, 2.70811465, 1e-5);
  EXPECT_EQ(found.contacts->contacts.size(), 4u);
}

TEST_F(ContactOrder, AnArcThatRests) {
  std::string scene = chain(2, "(q[2] - q[1])^2/4 + q[1]^2/2 + q[2]^2/2", "q[1] + q[2]", 0.2, 0.4, 2);
  scene.insert(scene.find("\"q[1] >="), "\"q[1] + q[2] >= 0.45\", ");
  scene.replace(scene.rfind("\"0.4\""), 5, "\"0.45\"");
  const Solution found = run(study(scene));
  expect_minimum(found, 1.38604786, 1e-5);
}

/// Among five discs, those of least action of the 32 ways past them. Lengths are those of common tangents and
/// arcs between.
TEST_F(ContactOrder, WaysOfLeastActionAmongManyDiscs) {
  LONG_TEST();
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n[path]\nconstraints = [\n"
      "\"(x + 1.059)^2 + (y + 1.102)^2 >= 0.257^2\", \"(x - 1.441)^2 + (y - 0.991)^2 >= 0.523^2\",\n"
      "\"(x - 1.453)^2 + (y + 1.193)^2 >= 0.636^2\", \"(x + 2.146)^2 + (y - 0.551)^2 >= 0.329^2\",\n"
      "\"(x + 0.356)^2 + (y + 1.132)^2 >= 0.306^2\"]\n[boundary]\nstart = { x = -3, y = 0 }\n"
      "end = { x = 3, y = 0 }\nduration = 1\n[search]\nsolutions = 5\n");
  const std::vector<Solution> found = run_all(s);
  const double actions[] = {18, 20.992221219, 22.7952857431, 22.81652927, 22.8262693834};
  ASSERT_EQ(found.size(), std::size(actions)) << found.front().message;
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k].action, actions[k], 1e-7);
}

TEST_F(ContactOrder, EachDiscIsPassedOnBothSides) {
  LONG_TEST();
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nlagrangian = \"(x'^2 + y'^2)/2\"\n[path]\n"
      "constraints = [\"(x + 2.5)^2 + (y - 0.2)^2 >= 1\", \"x^2 + (y + 0.1)^2 >= 1\", "
      "\"(x - 2.5)^2 + y^2 >= 1\"]\n[boundary]\nstart = { x = -5.0, y = 0.0 }\nend = { x = 5.0, y = 0.0 }\n"
      "duration = 1.0\n[search]\nsolutions = 8\n");
  const std::vector<Solution> found = run_all(s);
  ASSERT_EQ(found.size(), 8u) << found.front().message;
  const double x[] = {-2.5, 0, 2.5}, y[] = {0.2, -0.1, 0};
  std::set<int> sides;
  for (const Solution& solution : found) {
    ASSERT_TRUE(solution.converged()) << solution.message;
    std::vector<double> q(2), v(2);
    int side = 0, disc = 0;
    for (int k = 0; k <= 1000 && disc < 3; ++k) {
      solution.trajectory.at(solution.duration() * k / 1000, q, v);
      if (q[0] < x[disc]) continue;
      side = 2 * side + (q[1] > y[disc] ? 1 : 0);
      ++disc;
    }
    sides.insert(side);
  }
  EXPECT_EQ(sides.size(), 8u);
}
